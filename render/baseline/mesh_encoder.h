// Functions shared by the writers of the mesh formats. Private to render/baseline.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/baseline/mesh_writer.h"

namespace facetless {

// A colour as files store it: sRGB and opacity, eight bits each.
using Rgba = std::array<std::uint8_t, 4>;
Rgba ToRgba(const Color& color);
// "b2b2b8", or "b2b2b880" for a colour that is not opaque.
std::string HexRgba(const Rgba& color);

// The colours of the faces that `node` places, indexed by the face within its part.
std::vector<Rgba> PlacedFaceColors(const MeshNode& node, const Model& model);

// Appends the shortest decimal that reads back as the same number.
void AppendNumber(std::string& text, double number);
void AppendNumber(std::string& text, float number);

// The unit normal of the placed surface, on the same side as `normal` before the placement.
Vec3 PlacedNormal(const Placement& placement, Vec3 normal);

Result<std::string> EncodeGlb(const Mesh& mesh, const Model& model);
Result<std::string> EncodeStl(const Mesh& mesh, const Model& model);
std::vector<MeshOutput> EncodeObj(const Mesh& mesh, const Model& model, const std::string& stem);
Result<std::string> Encode3mf(const Mesh& mesh, const Model& model);

}  // namespace facetless
