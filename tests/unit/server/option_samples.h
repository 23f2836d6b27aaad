// A value for each option that is not its default.
#pragma once

#include <nlohmann/json.hpp>

#include "server/options/option_table.h"

namespace facetless {

// Returns null for an unknown option.
inline nlohmann::json AnotherValueOf(const OptionRow& row) {
  using Json = nlohmann::json;
  for (const auto& [name, value] : {std::pair<const char*, Json>{"view", "top"},
                                    {"camera", {{"eye", {1, 2, 3}}}},
                                    {"size", "80x60"},
                                    {"section", "x=1"},
                                    {"shade", "zebra"},
                                    {"ambient_occlusion", "64,2.5"},
                                    {"material", "a=mirror"},
                                    {"environment", "a.hdr"},
                                    {"aov", "uv"},
                                    {"color", "part"},
                                    {"parts", "a"},
                                    {"hide", "a"},
                                    {"with", "fast"},
                                    {"voxels", "12"},
                                    {"methods", "fast"},
                                    {"walk", "grid"},
                                    {"point_light", "1,2,3"},
                                    {"unit", "cm"},
                                    {"mesh", "a.stl"}})
    if (row.name == name) return value;
  switch (row.kind) {
    case OptionKind::kFlag:
      return true;
    case OptionKind::kChoice:
      return row.choices[row.choices.front() == row.usual ? 1 : 0];
    case OptionKind::kInteger:
    case OptionKind::kNumber:
      return std::isinf(row.high) ? 12345.0 : row.high;
    case OptionKind::kNumbers:
      return Json::array({row.high});
    default:
      return nullptr;
  }
}

}  // namespace facetless
