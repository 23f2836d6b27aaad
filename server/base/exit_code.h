// Exit codes, in the manner of OpenImageIO's idiff.
#pragma once

#include "render/base/result.h"

namespace facetless {

inline constexpr int kExitDone = 0;  // a report is written, nothing lost, no threshold broken
inline constexpr int kExitLost = 1;  // done, but something was lost, or the mesher made no triangle of a face
inline constexpr int kExitFailed =
    2;                               // a loss under --strict, a threshold broken, or a problem of the verdict
inline constexpr int kExitSize = 3;  // images of different sizes
inline constexpr int kExitUnusable = 4;  // nothing usable in the input, or nothing within the limits
inline constexpr int kExitNoBaseline =
    5;  // the exact half of a comparison is done; there is no mesh to compare with
inline constexpr int kExitUsage = 64;        // options that are wrong
inline constexpr int kExitInternal = 70;     // a defect of Facetless
inline constexpr int kExitCannotWrite = 74;  // disk full, no permission
inline constexpr int kExitSignal = 128;      // plus the signal's number: 130 after Ctrl-C

int ExitCodeOf(const Error& error);

// Prints the error's sentence to standard error and returns its exit code.
int PrintError(const Error& error);

}  // namespace facetless
