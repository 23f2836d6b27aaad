// Which triangles of a mesh share an edge: whether it is closed, and whether its triangles agree about the
// outside.
//
//  1. Corners are one where they lie at the same position (equal coordinates; −0 equals +0) and belong to the
//     same solid: two solids that touch stay two.
//  2. A triangle of which two corners are one has collapsed: it is left out, and counted.
//  3. An edge is open where one triangle has it, flipped where two have it that run through it in the same
//     direction, and non-manifold where more than two have it.
//  4. Each placement counts.
//
// Example: MeasureTopology(mesh, model).IsWatertight().
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

// A part by laws 1 and 2.
struct WeldedPart {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>>
      triangles;                      // indices of `positions`; those that have not collapsed
  std::vector<std::uint32_t> source;  // the index of each of them in the part
};

struct MeshTopology {
  std::uint64_t triangles = 0, collapsed = 0;
  std::uint64_t open_edges = 0, flipped_edges = 0, non_manifold_edges = 0;

  bool IsWatertight() const { return open_edges == 0 && non_manifold_edges == 0; }
};

// `solid_of_face` by face of the part; empty: all faces belong together. Requires a sound part.
WeldedPart Weld(const MeshPart& part, const std::vector<std::uint32_t>& solid_of_face);

// The solids of the faces of the part that `node` places. Requires that the mesh is `model`'s
// (Mesh::from_model).
std::vector<std::uint32_t> SolidsOfFaces(const MeshNode& node, const Model& model);

// Requires that the mesh is `model`'s.
MeshTopology MeasureTopology(const Mesh& mesh, const Model& model);

// "12 triangles; watertight", "10 triangles; not watertight: 4 open edges, 1 flipped edge".
std::string TopologySentence(const MeshTopology& topology);

}  // namespace facetless
