// Meshes and glTF files made by hand.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/shapes.h"

namespace facetless::testing {

// An axis-parallel box with outward normals and one face per side, from the origin to `size`.
MeshPart BoxMesh(Vec3 size);

Mesh OneNode(MeshPart part, const Placement& placement = {});
Placement Translation(Vec3 by);

// A .glb file in memory: JSON chunk and, unless empty, BIN chunk.
std::string Glb(const nlohmann::json& json, const std::string& bin);

// One triangle (0,0,0) (1,0,0) (0,1,0) in a buffer: indices at 0 (3 uint16, padded to 8), positions at 8.
// Change it, then break it.
struct TriangleFile {
  nlohmann::json json;
  std::string bin;

  TriangleFile();
  std::string Bytes() const { return Glb(json, bin); }
};

}  // namespace facetless::testing
