// The samples that the project ships, and what is expected of them.
#pragma once

#include <cctype>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/files.h"

namespace facetless {

// The names in expected.json: "bracket.step", "broken/empty.step". Empty without it: it is asked when a
// program is loaded, where nothing may be thrown, and a test says that it is missing.
inline std::vector<std::string> SampleNames() {
  std::vector<std::string> names;
  std::ifstream file(Sample("expected.json"));
  const nlohmann::json expected = nlohmann::json::parse(file, nullptr, false);
  for (const auto& [name, value] : expected.items()) names.push_back(name);
  return names;
}

// As a test may be called.
inline std::string TestName(std::string name) {
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

}  // namespace facetless
