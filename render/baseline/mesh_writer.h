// Writing mesh files: glTF binary, STL, OBJ and 3MF, with the colours of the model if the format supports
// them.
//
//     Result<MeshFormat> format = MeshFormatFromPath(path);
//     if (!format) return format.error();
//     auto files = EncodeMesh(mesh, model, format.value(), "part");
//
//  1. The suffix of the file name, in any case, selects the format (MeshFormatFromPath). Any other suffix is an
//     error that lists the valid ones.
//  2. The placed triangles of `mesh` are written. The faces of the mesh must be those of `model`
//     (Mesh::from_model). A placed face has the colour Model::PlacedFaceColor.
//  3. glTF binary files are in metres with Y up, as the specification requires. LoadMesh restores the same
//     positions, placements and faces bit for bit. Parts stay parts, and each face is a primitive with its
//     own material.
//  4. STL files are binary, in millimetres with Z up, in single precision relative to the origin of the
//     model. They have no colours and no parts.
//  5. OBJ files are in millimetres with Z up, with exact normals and a group for each face. A second file
//     next to the OBJ file has a material for each colour.
//  6. 3MF files are in millimetres with Z up. Parts are objects, placements are build items, and each
//     triangle has its colour.
//  7. STL, OBJ and 3MF files leave out collapsed triangles (mesh_topology.h, law 2). Triangles of mirroring
//     placements are reversed, so that the outside stays outside.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

enum class MeshFormat : std::uint8_t { kGlb, kStl, kObj, k3mf };

// One file of the result. Its name is the stem of the name that the user gave, followed by `suffix`.
struct MeshOutput {
  std::string suffix;  // ".glb"; "" for the file that the user named
  std::string bytes;
};

// The format that the suffix of the path selects (law 1). Error: kBadUsage.
Result<MeshFormat> MeshFormatFromPath(const std::string& path);

// Encodes the mesh. The file that the user named is the last of the result. `stem` is its name without suffix
// and folder; an OBJ file refers to its material file by it. Errors: kInternal (the mesh does not belong to
// the model), kLimitExceeded (the mesh is too large for the format).
Result<std::vector<MeshOutput>> EncodeMesh(const Mesh& mesh, const Model& model, MeshFormat format,
                                           const std::string& stem);

}  // namespace facetless
