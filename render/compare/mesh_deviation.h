// The deviation of each triangle of Facetless's own tessellation from the surface of its face, which the
// three-dimensional view shows.
//
//  1. A triangle is measured at its centroid and at the middles of its edges (its corners lie on the
//     surface). Its deviation is that of the four which is largest in size, in mm; positive: the mesh lies
//     outside, by the face's orientation.
//  2. The distance is to the nearest point of the face's surface within its patches, trimmed or not: Newton's
//     method starts from the pieces of the surface that may lie nearer than the best point so far, eight at
//     most, and on each border of the patches. Every foot point lies on the surface, so no magnitude is below
//     the true distance. The largest deviations are computed again from every such piece, and
//     largest_at_least_mm is a proven lower bound of the largest. If it agrees with largest_mm to 0.1 %,
//     largest_mm is correct.
//  3. There is one list per prototype, which its placements share, as they share the triangles.
//  4. A foreign mesh has no face ids and cannot be measured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

struct MeshDeviation {
  std::vector<std::vector<float>> parts;   // as Mesh::parts: one entry per triangle
  std::uint64_t triangles = 0;             // of all prototypes
  std::vector<std::string> faces_missing;  // faces without a triangle, and therefore without a deviation
  double largest_mm = 0;                   // largest magnitude
  double largest_at_least_mm = 0;          // proven
  double p99_mm = 0;                       // nearest rank, of sizes over the triangles of all prototypes
};

// Meshes with more triangles are not measured, because a browser could not show them.
constexpr std::uint64_t kMostMeasuredTriangles = 500'000;

// Measures all triangles. Errors: kBadUsage (a foreign mesh), kLimitExceeded (too many triangles),
// kCancelled.
Result<MeshDeviation> MeasureMeshDeviation(const Model& model, const Mesh& mesh, const Execution& execution);

// Encodes the deviations for a browser, little-endian: the length of a JSON header in four bytes; the header,
// padded with spaces to a multiple of four; then arrays, at the offsets from the end of the header that it
// states:
//   {"parts": [{"triangles": n, "positions": offset, "deviations": offset, "faces": offset}],
//    "nodes": [{"part": i, "matrix": [12 numbers, row by row], "first_placed_face": id}]}
// positions are 9n float32 (mm, in the part's own coordinates), deviations n float32 (mm), faces n uint32
// (within the part).
std::string EncodeMeshDeviation(const Mesh& mesh, const MeshDeviation& deviation);

}  // namespace facetless
