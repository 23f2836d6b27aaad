// The command line: `facetless COMMAND …`.
//
//  1. Standard output gets the result (JSON or a path). Standard error gets the progress and one sentence per
//     error.
//  2. The return value is one of the exit codes of exit_code.h.
#pragma once

namespace facetless {

int RunCommandLine(int argc, char** argv);

}  // namespace facetless
