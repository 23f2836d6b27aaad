// Row 10 of the bench: the processor time of the importer against that of OpenCASCADE's own reader.
//
//  1. All sides are processes of their own that read the same file once, under the same restrictions. Each pays
//     for its start and for OpenCASCADE's tables. The importer writes a model and no mesh.
//  2. No other child of this process may end meanwhile, because processor times are those of all children.
//  3. The sides take turns after a warm-up of each, and the ratio is the median of the ratios of the turns.
#pragma once

#include <string>
#include <vector>

#include "bench/aims.h"
#include "server/importer/import_process.h"

namespace facetless {

// Returns the values of both rows. A row that OpenCASCADE's reader cannot be measured for says why. Errors: the
// errors of RunImporter, kCancelled.
Result<std::vector<BenchValue>> MeasureImport(const std::string& name, const ImportRequest& request,
                                              int repeats);

}  // namespace facetless
