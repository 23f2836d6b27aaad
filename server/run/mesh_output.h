// The output of `facetless mesh`.
//
//  1. Placements that the file hides are left out, unless `show_hidden` is set.
//  2. Each file is written completely or not at all; the file that the user named is written last.
#pragma once

#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/baseline/mesh_writer.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

// Removes the placements that the file of `model` hides, and returns their number. Requires a mesh of the
// model.
std::size_t LeaveOutHidden(const Model& model, Mesh& mesh);

// Writes `mesh` to `path`. Returns sentences for the user: the number of triangles, whether they are
// watertight, what was left out, and what the format cannot represent. Errors: kBadUsage (everything is
// hidden), the errors of EncodeMesh, kWriteFailed.
Result<std::vector<std::string>> WriteMeshFiles(const Model& model, Mesh mesh, MeshFormat format,
                                                bool show_hidden, const std::string& path);

}  // namespace facetless
