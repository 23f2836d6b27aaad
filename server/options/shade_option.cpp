#include "server/options/shade_option.h"

#include <string>

namespace facetless {
namespace {

using Json = nlohmann::json;

Error NotUnderstood(const Json& json) {
  return {
      ErrorCode::kBadUsage,
      "shade is " + json.dump(-1, ' ', false, Json::error_handler_t::replace) +
          ", but must be a string such as \"zebra:stripes=24\" or an object with a name and its settings"};
}

}  // namespace

Result<Inspection> ParseShade(const Json& json) {
  if (json.is_string()) return ParseInspection(json.get<std::string>());
  if (!json.is_object() || !json.contains("name") || !json["name"].is_string()) return NotUnderstood(json);
  // Convert the object to text, so that names and ranges are checked in one place.
  std::string text = json["name"].get<std::string>();
  if (text.find(':') != std::string::npos) return NotUnderstood(json);
  const char* separator = ":";
  for (const auto& [key, value] : json.items()) {
    if (key == "name") continue;
    std::string written = value.is_string() ? value.get<std::string>() : value.dump();
    if (value.is_array()) {
      written.clear();
      for (const Json& entry : value) {
        if (!entry.is_number()) return NotUnderstood(json);
        written += (written.empty() ? "" : key == "range" ? ".." : ",") + entry.dump();
      }
    } else if (!value.is_string() && !value.is_number()) {
      return NotUnderstood(json);
    }
    if (key.find_first_of(",=") != std::string::npos || written.find('=') != std::string::npos)
      return NotUnderstood(json);
    text += separator + key + "=" + written;
    separator = ",";
  }
  return ParseInspection(text);
}

bool ShowsSmoothness(InspectionKind kind) {
  return kind == InspectionKind::kZebra || kind == InspectionKind::kIsophotes ||
         kind == InspectionKind::kReflection || kind == InspectionKind::kCurvature;
}

}  // namespace facetless
