// What `facetless mesh` writes of an import.
//
//  1. Placements that the file hides are left out, unless `show_hidden`.
//  2. All files of the format appear in full or not at all, the one that the user named last.
#pragma once

#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/baseline/mesh_writer.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

// `mesh` without the placements that `model`'s file hides, and how many those are. Requires that the mesh is
// the model's.
std::size_t LeaveOutHidden(const Model& model, Mesh& mesh);

// Writes `mesh` to `path`, and says on return, in sentences for a person, what a reader of the files has to
// know: triangles, whether they are watertight, what was left out, and what the format cannot hold. Errors:
// kBadUsage (everything is hidden), those of EncodeMesh, kWriteFailed.
Result<std::vector<std::string>> WriteMeshFiles(const Model& model, Mesh mesh, MeshFormat format,
                                                bool show_hidden, const std::string& path);

}  // namespace facetless
