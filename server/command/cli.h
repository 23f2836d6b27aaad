// The command line: `facetless COMMAND …`.
//
//  1. Standard output gets the answer (JSON or a path), standard error progress and one sentence per error.
//  2. The exit code is one of exit_code.h.
#pragma once

namespace facetless {

int RunCommandLine(int argc, char** argv);

}  // namespace facetless
