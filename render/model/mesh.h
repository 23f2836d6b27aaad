// A triangle mesh in memory: what baseline/ traces and what comes from, and goes into, glTF binary.
//
//  1. Millimetres, Z up. Positions are float32 relative to their node's translation, which is double: a mesh
//     far from the origin keeps its digits.
//  2. One MeshPart per prototype, one MeshNode per placement of it. Triangles of a part are grouped by face;
//     face_of_triangle is the index of the face within the part (0 for a foreign mesh that names none).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/base/vec.h"

namespace facetless {

struct MeshPart {
  std::string name;
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 3>> normals;  // unit, one per position
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> face_of_triangle;
};

struct MeshNode {
  std::uint32_t part = 0;
  Placement placement;
  std::uint32_t first_placed_face =
      0;  // as Instance::first_placed_face of the model that the mesh belongs to
};

struct Mesh {
  std::vector<MeshPart> parts;
  std::vector<MeshNode> nodes;
  std::vector<std::string> faces_unmeshed;  // names of faces that gave no triangle
  double deflection_mm = 0;                 // 0: unknown (a foreign mesh)
  double angular_deg = 0;
  double mesh_ms = 0;       // time the tessellator took
  bool from_model = false;  // the faces are those of the model that it is compared with
};

}  // namespace facetless
