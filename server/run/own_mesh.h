// A comparison with Facetless's own tessellation, from the CAD file to the report. The exact half is made
// first, and is kept if the mesh fails.
//
//  1. The model is used as soon as the importer has written it. If the mesher is not done soon after, the
//     exact pictures are made while it works, with a report that has "no_baseline": {"reason": "pending"}.
//     When the mesh is done, the comparison starts at once and replaces them. The early pictures do not delay
//     it, and its times are measured after the mesher has ended.
//  2. If there will be no mesh, the exact half is the result, and its report has the reason (run.h,
//     RunWithoutBaseline).
//  3. A failure of the import or of the exact half is an Error, as in any run.
#pragma once

#include <string>
#include <vector>

#include "server/importer/import_process.h"
#include "server/run/run.h"

namespace facetless {

struct OwnMeshComparison {
  RunResult run;
  std::vector<std::string> faces_unmeshed;  // names of faces without a triangle
};

// Runs the comparison. `request` has the file and the limits; `options` determine its meshes. Errors: the
// errors of Import and RunCompare.
Result<OwnMeshComparison> CompareWithOwnMesh(const ImportRequest& request, const RunOptions& options,
                                             const std::string& directory, const RunContext& context);

}  // namespace facetless
