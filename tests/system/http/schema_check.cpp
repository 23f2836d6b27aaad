#include "tests/system/http/schema_check.h"

#include <algorithm>
#include <set>

namespace facetless {
namespace {

using Json = nlohmann::json;
using Faults = std::vector<std::string>;

bool IsOfType(const Json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  if (type == "boolean") return value.is_boolean();
  return type == "null" && value.is_null();
}

bool IsOfOneType(const Json& value, const Json& types) {
  if (types.is_string()) return IsOfType(value, types.get<std::string>());
  return std::any_of(types.begin(), types.end(),
                     [&](const Json& type) { return IsOfType(value, type.get<std::string>()); });
}

void Append(Faults& faults, const Faults& more) {
  faults.insert(faults.end(), more.begin(), more.end());
}

}  // namespace

Json Resolved(const Json& document, Json json) {
  while (json.is_object() && json.contains("$ref")) {
    const std::string reference = json["$ref"].get<std::string>();
    const Json::json_pointer place(reference.substr(1));
    json = document.contains(place) ? document.at(place) : Json();
  }
  return json;
}

Faults SchemaFaults(const Json& document, const Json& schema, const Json& value, const std::string& place) {
  static const std::set<std::string> kKnown = {
      "$ref",  "type",  "required",   "enum",        "items",
      "anyOf", "allOf", "properties", "description", "contentMediaType"};
  Faults faults;
  for (const auto& [keyword, ignored] : schema.items()) {
    if (!kKnown.contains(keyword)) faults.push_back(place + ": the checker does not know " + keyword);
  }
  if (schema.contains("$ref")) {
    const Json target = Resolved(document, schema);
    if (target.is_null()) return {place + ": " + schema["$ref"].get<std::string>() + " leads nowhere"};
    return SchemaFaults(document, target, value, place);
  }
  if (schema.contains("type") && !IsOfOneType(value, schema["type"]))
    faults.push_back(place + " is " + value.type_name() + ", not " + schema["type"].dump());
  if (schema.contains("enum") &&
      std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end())
    faults.push_back(place + " is " + value.dump() + ", not one of " + schema["enum"].dump());
  if (value.is_object()) {
    for (const Json& name : schema.value("required", Json::array())) {
      if (!value.contains(name.get<std::string>()))
        faults.push_back(place + " has no " + name.get<std::string>());
    }
    const Json properties = schema.value("properties", Json::object());
    for (const auto& [name, property] : properties.items()) {
      if (value.contains(name))
        Append(faults, SchemaFaults(document, property, value[name], place + "." + name));
    }
  }
  if (value.is_array() && schema.contains("items")) {
    for (std::size_t i = 0; i < value.size(); ++i)
      Append(faults,
             SchemaFaults(document, schema["items"], value[i], place + "[" + std::to_string(i) + "]"));
  }
  for (const Json& part : schema.value("allOf", Json::array()))
    Append(faults, SchemaFaults(document, part, value, place));
  if (schema.contains("anyOf")) {
    Faults all;
    bool fits = false;
    for (const Json& part : schema["anyOf"]) {
      const Faults of_part = SchemaFaults(document, part, value, place);
      fits = fits || of_part.empty();
      Append(all, of_part);
    }
    if (!fits) Append(faults, all);
  }
  return faults;
}

}  // namespace facetless
