#include "render/shade/material.h"

#include <array>
#include <charconv>
#include <utility>

#include "render/view/arrangement.h"
#include "render/view/section.h"

namespace facetless {
namespace {

constexpr std::array<const char*, 4> kNames = {"matte", "metal", "mirror", "glass"};
constexpr std::size_t kListedNames = 12;

Error NotUnderstood(const std::string& text) {
  return {
      ErrorCode::kBadUsage,
      "material is \"" + text +
          "\", but must be NAME=KIND: NAME is a part of the name of a part or a face, or a pattern; KIND is "
          "matte, metal, mirror, glass, or glass:IOR with an index of refraction from 1 to 4"};
}

Error NothingMatches(const Model& model, const std::string& pattern) {
  std::string message = "material: no name of a part or a face matches \"" + pattern + "\"; the parts are";
  for (std::uint32_t i = 0; i < model.instances.size() && i < kListedNames; ++i)
    message += (i > 0 ? ", \"" : " \"") + OccurrenceName(model, i) + "\"";
  if (model.instances.size() > kListedNames)
    message += " and " + std::to_string(model.instances.size() - kListedNames) + " more";
  return {ErrorCode::kBadUsage, message};
}

}  // namespace

Result<MaterialRule> ParseMaterial(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) return NotUnderstood(text);
  MaterialRule rule{text.substr(0, equals), {}};
  std::string kind = text.substr(equals + 1);
  if (const std::size_t colon = kind.find(':'); colon != std::string::npos) {
    const char* const end = kind.data() + kind.size();
    const auto parsed = std::from_chars(kind.data() + colon + 1, end, rule.material.ior);
    if (parsed.ec != std::errc{} || parsed.ptr != end ||
        !(rule.material.ior >= kLeastIor && rule.material.ior <= kMostIor))
      return NotUnderstood(text);
    kind.resize(colon);
    if (kind != "glass") return NotUnderstood(text);
  }
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kind != kNames[i]) continue;
    rule.material.kind = static_cast<MaterialKind>(i);
    return rule;
  }
  return NotUnderstood(text);
}

std::string FormatMaterial(const MaterialRule& rule) {
  std::string text = rule.pattern + "=" + kNames[static_cast<std::size_t>(rule.material.kind)];
  if (rule.material.kind != MaterialKind::kGlass) return text;
  std::array<char, 32> number;
  const auto written = std::to_chars(number.data(), number.data() + number.size(), rule.material.ior);
  return text + ":" + std::string(number.data(), written.ptr);
}

Result<std::vector<Material>> MaterialsOfFaces(const Model& model, std::span<const MaterialRule> rules) {
  std::vector<Material> materials(model.PlacedFaceCount());
  const SectionSolids solids(model);
  for (const MaterialRule& rule : rules) {
    bool matches = false;
    for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
      const Instance& instance = model.instances[i];
      const bool whole = NameMatches(rule.pattern, OccurrenceName(model, i));
      const Range faces = model.parts[instance.part].faces;
      for (std::uint32_t f = 0; f < faces.count; ++f) {
        const std::uint32_t placed = instance.first_placed_face + f;
        const std::string& name = model.faces[faces.first + f].name;
        if (!whole && (name.empty() || !NameMatches(rule.pattern, name))) continue;
        matches = true;
        materials[placed] = rule.material;
        if (rule.material.kind == MaterialKind::kGlass && solids.ClosedSolidOfFace(placed) == kNoIndex)
          return Error{ErrorCode::kBadUsage,
                       "material: " + model.PlacedFaceName(placed) +
                           " belongs to no closed solid, but glass must enclose a solid; use mirror, metal "
                           "or matte"};
      }
    }
    if (!matches) return NothingMatches(model, rule.pattern);
  }
  return materials;
}

}  // namespace facetless
