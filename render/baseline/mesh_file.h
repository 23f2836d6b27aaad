// Reading mesh files. Files that `facetless mesh` wrote and files from other programs are read in the same
// way.
//
//     Result<Mesh> mesh = LoadMesh("part.stl", {.unit = "in"}, &model);
//     if (!mesh) return mesh.error();
//
//  1. The supported formats are glTF 2.0 binary (.glb) and STL, ASCII or binary. The content of the file, not
//     its name, determines the format.
//  2. The result is in millimetres with Z up. glTF files are in metres with Y up. STL does not state a unit
//     or an axis and is read as millimetres with Z up. `unit` and `up` override both.
//  3. A file written by Facetless is read back bit for bit: its root node and the conversion here are inverse
//     to each other, and their product is formed first, so positions and node translations are multiplied by
//     exactly 1.
//  4. Missing normals are computed as the angle-weighted mean of the normals of the triangles around a
//     position, over those triangles whose normals are within `crease_deg` of the normal of the corner's own
//     triangle.
//  5. A mesh written by Facetless refers to the faces of the model (Mesh::from_model) only if its nodes are
//     the instances of the model with which it is compared. The mesh of another model counts as a foreign
//     mesh.
//  6. Nodes whose placement has a determinant of zero are left out.
//  7. For any bytes, the result is a mesh with indices in range and finite numbers, or an Error. External
//     files, images, cameras, animation, skins and morph targets are not read. Sparse accessors and
//     compressed primitives (Draco, meshopt) are refused with an error that names them.
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
  std::uint64_t max_memory_bytes = std::uint64_t{4} << 30;  // memory for the unpacked vertices and triangles
  std::uint64_t max_nodes = 4'000'000;
};

// Reads the mesh at `path`. If `model` is given, the bounds of mesh and model are compared (CheckMeshSize).
// Errors: kBadUsage (options), kFileUnreadable, kFormatUnknown, kFormatBroken, kNotFinite, kNothingUsable (no
// triangle), kLimitExceeded, kUnitMismatch.
Result<Mesh> LoadMesh(const std::string& path, const MeshLoadOptions& options, const Model* model);

// Compares the sizes of mesh and model. Error: kUnitMismatch if the ratio of the diagonals, or its inverse,
// is within 5 % of 10, 12, 25.4, 39.4, 100, 304.8 or 1000, or if the extents match only with Y and Z
// exchanged. The message names the option that would correct it. `unit_mm` is the length that was assumed for
// one unit of the mesh file. The check succeeds if either box is empty or a single point.
Result<void> CheckMeshSize(const Box3& mesh, double unit_mm, const Box3& model);

// Returns whether a mesh that refers to faces (Mesh::from_model) refers to those of `model`: each node is an
// instance of the model, and each face exists in its part. The mesh may lack instances.
bool RefersToFacesOfModel(const Mesh& mesh, const Model& model);

// The number of triangles whose orientation contradicts the normals at their corners, if that is true of at
// least nine tenths of the triangles that have an orientation; otherwise 0.
std::size_t TrianglesAgainstNormals(const Mesh& mesh);

// The bounds of the corners of all placed triangles, mm.
Box3 MeshBounds(const Mesh& mesh);

// The number of triangles, with every placement counted.
std::uint64_t PlacedTriangleCount(const Mesh& mesh);

// A bound of the distance by which rounding to float32 moved a position, mm: √3 × half a unit in the last
// place of the largest coordinate, scaled by its placement. Differences below this bound are not significant.
double PositionNoise(const Mesh& mesh);

}  // namespace facetless
