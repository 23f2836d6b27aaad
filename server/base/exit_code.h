// The exit codes of the commands, similar to those of OpenImageIO's idiff.
#pragma once

#include "render/base/result.h"

namespace facetless {

inline constexpr int kExitDone = 0;  // the report is written; nothing was lost, and no threshold was exceeded
inline constexpr int kExitLost = 1;  // done, but something was lost, or a face has no triangle
inline constexpr int kExitFailed =
    2;  // a loss under --strict, an exceeded threshold, or another problem of the verdict
inline constexpr int kExitSize = 3;      // images of different sizes
inline constexpr int kExitUnusable = 4;  // the input holds nothing usable, or a limit was exceeded
inline constexpr int kExitNoBaseline =
    5;  // only the exact half of a comparison is done, because there is no mesh
inline constexpr int kExitUsage = 64;        // the options are wrong
inline constexpr int kExitInternal = 70;     // a defect of Facetless
inline constexpr int kExitCannotWrite = 74;  // disk full, no permission
inline constexpr int kExitSignal = 128;      // plus the signal's number: 130 after Ctrl-C

int ExitCodeForError(const Error& error);

// Prints the message of the error to standard error and returns its exit code.
int PrintError(const Error& error);

}  // namespace facetless
