// Parsing the values of options from JSON. Every range is checked, and every error sentence written, in one
// way.
//
//     Result<double> margin = ParseNumber(json, "margin", 0, 0.45);
//     if (!margin) return margin.error();  // "margin is 2, but must be a number from 0 to 0.45"
//
//  1. `name` is the name of the option. Every message contains it and the value as it was given.
//  2. Every error is kBadUsage.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

Error BadUsage(std::string message);

// A value as the caller wrote it. Bytes that are not valid UTF-8 are replaced.
std::string Quoted(const nlohmann::json& json);
// The names, separated by commas.
std::string Joined(const std::vector<std::string>& names);

// " (did you mean size?)" if one of `names` is similar to `word`; otherwise "".
std::string Suggestion(const std::string& word, const std::vector<std::string>& names);
// A word of the caller in quotation marks, shortened if it is very long.
std::string Shortened(const std::string& word);

// A number in [low, high]; high may be infinite.
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

// Stores a parsed value in `target`, or returns its error.
template <typename Parsed, typename Target>
Result<void> StoreInto(Parsed parsed, Target& target) {
  if (!parsed) return parsed.error();
  target = std::move(parsed).value();
  return {};
}

}  // namespace facetless
