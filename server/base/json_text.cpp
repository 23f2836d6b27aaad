#include "server/base/json_text.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>
#include <vector>

#include "render/base/utf8.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The largest number of bytes of a parser message or a name that is shown. A name may have megabytes.
constexpr std::size_t kMostShown = 160;

std::string Shown(const std::string& text) {
  return text.size() <= kMostShown ? Printable(text) : Printable(text.substr(0, kMostShown)) + "…";
}

// The place of the byte before `end` as "line 2, column 5". `end` is counted from 1.
std::string LineAndColumn(std::string_view text, std::size_t end) {
  const std::string_view before = text.substr(0, std::min(text.size(), end == 0 ? 0 : end - 1));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return "line " + std::to_string(line) + ", column " + std::to_string(before.size() - line_start + 1);
}

// The reason in a message of nlohmann-json, which follows "[json.exception.parse_error.101] parse error at
// line 1, column 2: syntax error ".
std::string ReasonOf(const std::string& message) {
  const std::size_t place = message.find(": ");
  std::string reason = place == std::string::npos ? message : message.substr(place + 2);
  constexpr std::string_view kUsual = "syntax error ";
  if (reason.starts_with(kUsual)) reason.erase(0, kUsual.size());
  return Shown(reason);
}

}  // namespace

Result<Json> ParseJsonText(const std::string& text, const std::string& what, bool ignore_comments) {
  // Collect the names of each open object, and the first name that an object has twice.
  std::vector<std::set<std::string>> names;
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    if (event == Json::parse_event_t::key && !names.back().insert(value.get<std::string>()).second &&
        twice.empty())
      twice = "\"" + Shown(value.get<std::string>()) + "\"";
    return true;
  };
  Json json;
  try {
    json = Json::parse(text, watch, /*allow_exceptions=*/true, ignore_comments);
  } catch (const Json::parse_error& error) {
    return Error{ErrorCode::kBadUsage, what + " is not valid JSON: " + LineAndColumn(text, error.byte) +
                                           ": " + ReasonOf(error.what())};
  } catch (const Json::exception& error) {
    return Error{ErrorCode::kBadUsage, what + " is not valid JSON: " + ReasonOf(error.what())};
  }
  if (!twice.empty()) return Error{ErrorCode::kBadUsage, what + " has the name " + twice + " twice"};
  return json;
}

}  // namespace facetless
