// The stages of `render` and `compare` from the start of the program to its end, measured on processes of this
// program.
//
//  1. Each command runs once as a warm-up and then `repeats` times, in turns with the other and with a process that
//     does nothing. The run with the median time counts.
#pragma once

#include <string>
#include <vector>

#include "bench/stages.h"
#include "render/base/execution.h"
#include "server/options/options.h"

namespace facetless {

// Measures both commands on the CAD file at `path`. Of `options`, cameras, the size, the unit and the import's
// limits are used. Errors: kCancelled, kWriteFailed (a folder for the results), kInternal (a command that wrote no
// report; the message has its last line).
Result<std::vector<ProgramStages>> MeasureStages(const std::string& path, const RunOptions& options,
                                                 int repeats, const Execution& execution);

}  // namespace facetless
