// Mesh files out: glTF binary, STL, OBJ and 3MF, with the model's colours where the format has them.
//
//  1. The name's suffix, in capitals or not, says the format: MeshFormatOf. Any other suffix is refused with
//     the list of those that there are.
//  2. What is written is the placed triangles of `mesh`, whose faces are `model`'s (Mesh::from_model). A
//     placed face has the colour that Model::PlacedFaceColor says.
//  3. glTF binary is in metres, Y up, as its specification demands: LoadMesh gives back the same positions,
//     placements and faces bit for bit. Parts stay parts, each face is a primitive with its material.
//  4. STL is binary, in millimetres, Z up, in single precision about the model's own origin. It has no
//     colours and no parts.
//  5. OBJ is in millimetres, Z up, with exact normals, a group for each face and, in a second file beside it,
//     a material for each colour.
//  6. 3MF is in millimetres, Z up. Parts are objects, placements are items of the build. Each triangle has
//     its colour.
//  7. STL, OBJ and 3MF leave out triangles that have collapsed (mesh_topology.h, law 2). Mirroring placements
//     turn their triangles, so that the outside stays outside.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

enum class MeshFormat : std::uint8_t { kGlb, kStl, kObj, k3mf };

// A file of the result: `suffix` is put behind the stem of the name that the user gave.
struct MeshOutput {
  std::string suffix;  // ".glb"; "" for the file that the user named
  std::string bytes;
};

// Law 1. Error: kBadUsage.
Result<MeshFormat> MeshFormatOf(const std::string& path);

// The files, the named one last. `stem` is the name without its suffix and folder: an OBJ file names its
// materials' file by it. Errors: kInternal (a mesh that is not the model's), kLimitExceeded (more than the
// format can hold).
Result<std::vector<MeshOutput>> EncodeMesh(const Mesh& mesh, const Model& model, MeshFormat format,
                                           const std::string& stem);

}  // namespace facetless
