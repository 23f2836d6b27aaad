// The topology of a mesh: whether it is closed, and whether its triangles are consistently oriented.
//
//     const MeshTopology topology = MeasureTopology(mesh, model);
//     if (!topology.IsWatertight()) Report(TopologySentence(topology));
//
//  1. Corners are merged if they have the same position (equal coordinates; −0 equals +0) and belong to the
//     same solid. Two solids that touch stay separate.
//  2. A triangle with two merged corners is collapsed. It is left out, and counted.
//  3. An edge is open if one triangle uses it, flipped if two triangles use it in the same direction, and
//     non-manifold if more than two triangles use it.
//  4. Every placement of a part is counted.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

// A part after merging its corners (laws 1 and 2).
struct WeldedPart {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>>
      triangles;                      // indices into `positions`; only triangles that are not collapsed
  std::vector<std::uint32_t> source;  // the index of each of these triangles in the part
};

struct MeshTopology {
  std::uint64_t triangles = 0, collapsed = 0;
  std::uint64_t open_edges = 0, flipped_edges = 0, non_manifold_edges = 0;

  bool IsWatertight() const { return open_edges == 0 && non_manifold_edges == 0; }
};

// Merges the corners of a part. `solid_of_face` is indexed by face of the part; if it is empty, all faces
// belong to one solid. Requires a valid part.
WeldedPart Weld(const MeshPart& part, const std::vector<std::uint32_t>& solid_of_face);

// The solids of the faces of the part that `node` places. Requires a mesh of `model` (Mesh::from_model).
std::vector<std::uint32_t> SolidsOfFaces(const MeshNode& node, const Model& model);

// Measures the topology. Requires a mesh of `model` (Mesh::from_model).
MeshTopology MeasureTopology(const Mesh& mesh, const Model& model);

// A sentence such as "12 triangles; watertight" or "10 triangles; not watertight: 4 open edges, 1 flipped
// edge".
std::string TopologySentence(const MeshTopology& topology);

}  // namespace facetless
