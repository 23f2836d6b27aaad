// Materials: how a face treats the rays that meet it. Only faces that are given one differ from the studio's usual
// matte look.
//
//     Result<MaterialRule> rule = ParseMaterial("vase/body=glass:1.45");
//     Result<std::vector<Material>> materials = MaterialsOfFaces(model, {&rule.value(), 1});
//
//  1. A rule applies to the faces of all occurrences whose name matches its pattern, and to faces whose own name does
//     (view/arrangement.h, law 2). Where several rules apply, the last one counts.
//  2. A matte face is lit by the studio. A metal reflects its surroundings in its own colour (Schlick's approximation),
//     a mirror in full. A glass reflects and refracts by Fresnel's equations, and its light passes from one side of the
//     face to the other, so that its faces must bound a closed solid.
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

// Parses "PATTERN=KIND", where KIND is matte, metal, mirror, glass or glass:IOR. Error: kBadUsage.
Result<MaterialRule> ParseMaterial(const std::string& text);
// The inverse of ParseMaterial.
std::string FormatMaterial(const MaterialRule& rule);

// The material of each placed face. Errors: kBadUsage (a pattern matches nothing, and the message lists names; a glass
// face belongs to no closed solid).
Result<std::vector<Material>> MaterialsOfFaces(const Model& model, std::span<const MaterialRule> rules);

}  // namespace facetless
