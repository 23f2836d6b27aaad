// Materials: how a face reflects and refracts the rays that meet it. A face without a material is matte, which is the
// studio's usual look.
//
//     Result<MaterialRule> rule = ParseMaterial("vase/body=glass:1.45");
//     Result<std::vector<Material>> materials = MaterialsOfFaces(model, {&rule.value(), 1});
//
//  1. A rule applies to all faces of the occurrences whose name matches its pattern, and to the faces whose own name
//     matches it (view/arrangement.h, law 2). Where several rules apply to a face, the last one counts.
//  2. A matte face is lit by the studio. A metal reflects its surroundings in its own colour (Schlick's approximation).
//     A mirror reflects 94 % of the light, without a colour of its own. A glass reflects and refracts by Fresnel's
//     equations. Light passes from one side of a face of glass to the other, so these faces must bound a closed solid.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/model/model.h"

namespace facetless {

enum class MaterialKind : std::uint8_t { kMatte, kMetal, kMirror, kGlass };

struct Material {
  MaterialKind kind = MaterialKind::kMatte;
  double ior = 1.5;  // of glass: index of refraction, kLeastIor … kMostIor
};

inline constexpr double kLeastIor = 1, kMostIor = 4;

struct MaterialRule {
  std::string pattern;
  Material material;
};

// Parses "PATTERN=KIND", where KIND is matte, metal, mirror, glass or glass:IOR. PATTERN ends at the last "=". Error:
// kBadUsage.
Result<MaterialRule> ParseMaterial(const std::string& text);
// The inverse of ParseMaterial.
std::string FormatMaterial(const MaterialRule& rule);

// Returns the material of each placed face. Errors: kBadUsage (a pattern matches no part and no face, in which case the
// message lists names of parts; a face of glass belongs to no closed solid).
Result<std::vector<Material>> MaterialsOfFaces(const Model& model, std::span<const MaterialRule> rules);

}  // namespace facetless
