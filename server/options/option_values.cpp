#include "server/options/option_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace facetless {
namespace {

using Json = nlohmann::json;

// The shortest text that reads back as the same number.
std::string Plain(double number) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, number).ptr;
  return {text, end};
}

// The number of insertions, deletions, substitutions and transpositions of adjacent letters that turn `a`
// into `b`.
std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last, next(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) next[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(last, next);
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      next[j] = std::min({last[j] + 1, next[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        next[j] = std::min(next[j], before[j - 2] + 1);
    }
  }
  return next[b.size()];
}

}  // namespace

std::string Suggestion(const std::string& word, const std::vector<std::string>& names) {
  // Names of options are shorter than this, and the time of the comparison is the product of the lengths.
  constexpr std::size_t kLongest = 64;
  std::string best;
  std::size_t least = 1 + std::max<std::size_t>(1, word.size() / 3);
  for (const std::string& name : names) {
    if (word.size() > kLongest) break;
    const std::size_t distance = EditDistance(word, name);
    if (distance >= least) continue;
    least = distance;
    best = name;
  }
  return best.empty() ? "" : " (did you mean " + best + "?)";
}

std::string Shortened(const std::string& word) {
  constexpr std::size_t kMostShown = 64;
  return word.size() <= kMostShown
             ? "\"" + word + "\""
             : "\"" + word.substr(0, kMostShown) + "…\" (" + std::to_string(word.size()) + " bytes)";
}

Error BadUsage(std::string message) {
  return {ErrorCode::kBadUsage, std::move(message)};
}

std::string Quoted(const Json& json) {
  // The command line passes whole numbers as floating-point numbers, too.
  if (json.is_number_float()) return Plain(json.get<double>());
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

Result<double> ParseNumber(const Json& json, const std::string& name, double low, double high) {
  const double value = json.is_number() ? json.get<double>() : NAN;
  if (value >= low && value <= high) return value;
  const bool above_zero = low == std::numeric_limits<double>::min();
  const std::string least = above_zero ? "above 0" : "of at least " + Plain(low);
  const std::string range = !std::isfinite(high) ? "a number " + least
                            : above_zero         ? "a number above 0, at most " + Plain(high)
                                                 : "a number from " + Plain(low) + " to " + Plain(high);
  return BadUsage(name + " is " + Quoted(json) + ", but must be " + range);
}

Result<int> ParseInteger(const Json& json, const std::string& name, int low, int high) {
  auto number = ParseNumber(json, name, low, high);
  if (!number) return number.error();
  if (number.value() != std::floor(number.value()))
    return BadUsage(name + " is " + Quoted(json) + ", but must be a whole number");
  return static_cast<int>(number.value());
}

Result<bool> ParseBool(const Json& json, const std::string& name) {
  if (!json.is_boolean()) return BadUsage(name + " is " + Quoted(json) + ", but must be true or false");
  return json.get<bool>();
}

Result<std::string> ParseText(const Json& json, const std::string& name) {
  if (!json.is_string()) return BadUsage(name + " is " + Quoted(json) + ", but must be a string");
  return json.get<std::string>();
}

Result<int> ParseWord(const Json& json, const std::string& name, const std::vector<std::string>& words) {
  if (json.is_string()) {
    const auto found = std::find(words.begin(), words.end(), json.get<std::string>());
    if (found != words.end()) return static_cast<int>(found - words.begin());
  }
  return BadUsage(name + " is " + Quoted(json) + ", but must be one of " + Joined(words));
}

Result<std::vector<std::string>> ParseWords(const Json& json, const std::string& name) {
  std::vector<std::string> words;
  if (json.is_string()) {
    const std::string text = json.get<std::string>();
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      words.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    return words;
  }
  if (!json.is_array())
    return BadUsage(name + " is " + Quoted(json) + ", but must be a name or a list of names");
  for (const Json& word : json) {
    if (!word.is_string()) return BadUsage(name + " lists " + Quoted(word) + ", which is not a name");
    words.push_back(word.get<std::string>());
  }
  return words;
}

Result<std::vector<double>> ParseNumbers(const Json& json, const std::string& name, double low, double high) {
  std::vector<double> numbers;
  const auto add = [&](const Json& entry) -> Result<void> {
    auto number = ParseNumber(entry, name, low, high);
    if (!number) return number.error();
    numbers.push_back(number.value());
    return {};
  };
  if (json.is_string()) {
    auto words = ParseWords(json, name);
    if (!words) return words.error();
    for (const std::string& word : words.value()) {
      // A word that is not a number is shown as it was written.
      double number = 0;
      const auto parsed = std::from_chars(word.data(), word.data() + word.size(), number);
      const bool whole = parsed.ec == std::errc{} && parsed.ptr == word.data() + word.size();
      if (auto added = add(whole ? Json(number) : Json(word)); !added) return added.error();
    }
  } else if (json.is_array()) {
    for (const Json& entry : json)
      if (auto added = add(entry); !added) return added.error();
  } else if (auto added = add(json); !added) {
    return added.error();
  }
  if (numbers.empty()) return BadUsage(name + " is an empty list");
  return numbers;
}

}  // namespace facetless
