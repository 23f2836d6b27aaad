// A comparison with our own tessellation, from the CAD file to the report. The exact half comes first and
// stays.
//
//  1. The model is used as soon as the importer has written it. If the mesher is not done soon after, the
//     exact pictures are made while it works, and a report that says "no_baseline": {"reason": "pending"}.
//     When the mesh is there, the comparison takes over at once and replaces them: the early pictures cost no
//     time of it, and its times are measured after the mesher has ended.
//  2. If there will be no mesh, the exact half is the answer, and its report says why (run.h,
//     RunWithoutBaseline).
//  3. What is wrong with the file or with the exact half is an Error, as of any run.
#pragma once

#include <string>
#include <vector>

#include "server/importer/import_process.h"
#include "server/run/run.h"

namespace facetless {

struct OwnMeshComparison {
  RunResult run;
  std::vector<std::string> faces_unmeshed;  // names of faces of which the mesher made no triangle
};

// `request` names the file and the limits; its meshes are those of `options`. Errors: those of Import and
// RunCompare.
Result<OwnMeshComparison> CompareWithOwnMesh(const ImportRequest& request, const RunOptions& options,
                                             const std::string& directory, const RunContext& context);

}  // namespace facetless
