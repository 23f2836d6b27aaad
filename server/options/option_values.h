// Values of options, read from JSON: one way to check a range and to say what is allowed.
//
//  1. `name` is the option's; every message names it and shows the value as it was given.
//  2. Every error is kBadUsage.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

Error BadUsage(std::string message);

// A value as the caller wrote it; bytes that are no UTF-8 are replaced.
std::string Quoted(const nlohmann::json& json);
// With commas.
std::string Joined(const std::vector<std::string>& names);

// " (did you mean size?)" if one of `names` is spelled much like `word`; else "".
std::string Suggestion(const std::string& word, const std::vector<std::string>& names);
// A word of the caller's in quotes, cut where it is too long to be one.
std::string Shortened(const std::string& word);

// A number of [low, high]; high may be infinite.
Result<double> ParseNumber(const nlohmann::json& json, const std::string& name, double low, double high);
Result<int> ParseInteger(const nlohmann::json& json, const std::string& name, int low, int high);
Result<bool> ParseBool(const nlohmann::json& json, const std::string& name);
Result<std::string> ParseText(const nlohmann::json& json, const std::string& name);
// The index of the given word in `words`.
Result<int> ParseWord(const nlohmann::json& json, const std::string& name,
                      const std::vector<std::string>& words);
// A list of strings, or one string with commas.
Result<std::vector<std::string>> ParseWords(const nlohmann::json& json, const std::string& name);
// A list of numbers, or one string with commas; not empty.
Result<std::vector<double>> ParseNumbers(const nlohmann::json& json, const std::string& name, double low,
                                         double high);

// Puts what was read into `target`, or passes its error on.
template <typename Parsed, typename Target>
Result<void> StoreInto(Parsed parsed, Target& target) {
  if (!parsed) return parsed.error();
  target = std::move(parsed).value();
  return {};
}

}  // namespace facetless
