// Mesh files in: what `facetless mesh` wrote and what somebody else exported run through one path.
//
//  1. Read are glTF 2.0 binary (.glb) and STL, ASCII or binary; which one is told by the content, not by
//     the name.
//  2. The result is in millimetres with Z up. glTF says metres and Y up; STL says nothing and is taken as
//     millimetres, Z up. `unit` and `up` override both.
//  3. A file of our own comes back bit for bit: its root node and the conversion here are each other's
//     inverse, and their product is formed first, so positions and node translations are multiplied by
//     exactly 1.
//  4. Missing normals are made: the mean of the triangles around a position, weighted by angle, over the
//     triangles whose normals lie within `crease_deg` of the corner's own.
//  5. A mesh of our own names the model's faces (Mesh::from_model) only if its nodes are the instances of
//     the model that it is compared with; another model's mesh counts as a foreign one.
//  6. Nodes that squash their mesh to nothing (a determinant of zero) are left out.
//  7. Whatever bytes come in, the answer is a mesh with indices in range and finite numbers, or an Error.
//     External files, images, cameras, animation, skins and morph targets are not read; sparse accessors
//     and compressed primitives (Draco, meshopt) are refused by name.
#pragma once

#include <cstdint>
#include <string>

#include "render/base/result.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

struct MeshLoadOptions {
  std::string unit =
      {};  // "" (the format's own), "mm", "cm", "m", "in", "ft": one unit of the file (--mesh-unit)
  std::string up = {};     // "" (the format's own), "y", "z": the file's up axis (--mesh-up)
  double crease_deg = 40;  // law 4; 0 … 180
  std::uint64_t max_file_bytes = std::uint64_t{4} << 30;
  std::uint64_t max_memory_bytes = std::uint64_t{4} << 30;  // vertices and triangles, unpacked
  std::uint64_t max_nodes = 4'000'000;
};

// Reads the mesh at `path`. If `model` is given, the bounds of both are compared (CheckMeshSize). Errors:
// kBadUsage (options), kFileUnreadable, kFormatUnknown, kFormatBroken, kNotFinite, kNothingUsable (no
// triangle), kLimitExceeded, kUnitMismatch.
Result<Mesh> LoadMesh(const std::string& path, const MeshLoadOptions& options, const Model* model);

// kUnitMismatch if the ratio of the diagonals, or its inverse, is within 5 % of 10, 12, 25.4, 39.4, 100,
// 304.8 or 1000, or if the extents fit only with Y and Z exchanged; the message names the option that would
// repair it. `unit_mm` is what one unit of the mesh's file was taken for. Nothing to say where either box
// is empty or a point.
Result<void> CheckMeshSize(const Box3& mesh, double unit_mm, const Box3& model);

// Whether a mesh that names faces (Mesh::from_model) names those of `model`: each node is an instance of it,
// and no face is beyond its part. Instances may be missing.
bool NamesFacesOf(const Mesh& mesh, const Model& model);

// How many triangles run against the normals at their corners, if nine tenths of those that have a direction
// do; else 0.
std::size_t TrianglesAgainstNormals(const Mesh& mesh);

// Of all placed triangles' corners, mm.
Box3 MeshBounds(const Mesh& mesh);

// Triangles with every placement counted.
std::uint64_t PlacedTriangleCount(const Mesh& mesh);

// The largest distance between a position and the number that was rounded to float32 to store it, mm: √3 ×
// half a unit in the last place of the largest coordinate, scaled by its placement. No difference below
// this says anything.
double PositionNoise(const Mesh& mesh);

}  // namespace facetless
