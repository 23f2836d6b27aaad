// Shared by the tests of options: parses the text of a request.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "server/options/options.h"

namespace facetless {

inline RunOptions ParsedOptions(const std::string& json) {
  auto options = ParseOptions(nlohmann::json::parse(json));
  EXPECT_TRUE(options.ok()) << options.error().message;
  return options.ok() ? options.value() : RunOptions{};
}

// Returns the error message; "" if there is none.
inline std::string OptionsMessage(const std::string& json) {
  auto options = ParseOptions(nlohmann::json::parse(json));
  if (options.ok()) return "";
  EXPECT_EQ(options.error().code, ErrorCode::kBadUsage);
  return options.error().message;
}

}  // namespace facetless
