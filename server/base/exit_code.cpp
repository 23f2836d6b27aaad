#include "server/base/exit_code.h"

#include <csignal>
#include <cstdio>

#include "render/base/utf8.h"
#include "server/base/interrupt.h"

namespace facetless {

int ExitCodeForError(const Error& error) {
  switch (error.code) {
    case ErrorCode::kBadUsage:
      return kExitUsage;
    case ErrorCode::kSizeMismatch:
      return kExitSize;
    case ErrorCode::kWriteFailed:
      return kExitCannotWrite;
    case ErrorCode::kCancelled:
      return kExitSignal + (InterruptSignal() != 0 ? InterruptSignal() : SIGINT);
    case ErrorCode::kInternal:
      return kExitInternal;
    case ErrorCode::kFileUnreadable:
    case ErrorCode::kFormatUnknown:
    case ErrorCode::kFormatBroken:
    case ErrorCode::kNothingUsable:
    case ErrorCode::kUnitMismatch:
    case ErrorCode::kLimitExceeded:
    case ErrorCode::kImporterCrashed:
    case ErrorCode::kNotFinite:
      return kExitUnusable;
  }
  return kExitInternal;
}

int PrintError(const Error& error) {
  std::fprintf(stderr, "facetless: %s\n", Printable(error.message).c_str());
  return ExitCodeForError(error);
}

}  // namespace facetless
