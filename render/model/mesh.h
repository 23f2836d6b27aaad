// A triangle mesh in memory. render/baseline traces it, and reads it from and writes it to glTF binary files.
//
//  1. Lengths are in millimetres, and Z is up. Positions are float32, relative to the double-precision
//     translation of their node, so a mesh far from the origin loses no precision.
//  2. There is one MeshPart per prototype and one MeshNode per placement of it. The triangles of a part are
//     grouped by face; face_of_triangle is the index of the face within the part (0 for a foreign mesh, which
//     does not identify faces).
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
      0;  // equal to Instance::first_placed_face of the model that the mesh belongs to
};

struct Mesh {
  std::vector<MeshPart> parts;
  std::vector<MeshNode> nodes;
  std::vector<std::string> faces_unmeshed;  // names of the faces without triangles
  double deflection_mm = 0;                 // 0: unknown (a foreign mesh)
  double angular_deg = 0;
  double mesh_ms = 0;  // time that the tessellator took
  bool from_model =
      false;  // the mesh was made from the model that it is compared with, so its faces are the model's
};

}  // namespace facetless
