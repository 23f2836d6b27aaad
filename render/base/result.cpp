#include "render/base/result.h"

namespace facetless {

const char* ErrorCodeName(ErrorCode code) {
  switch (code) {
    case ErrorCode::kBadUsage:
      return "bad-usage";
    case ErrorCode::kFileUnreadable:
      return "file-unreadable";
    case ErrorCode::kFormatUnknown:
      return "format-unknown";
    case ErrorCode::kFormatBroken:
      return "format-broken";
    case ErrorCode::kNothingUsable:
      return "nothing-usable";
    case ErrorCode::kUnitMismatch:
      return "unit-mismatch";
    case ErrorCode::kLimitExceeded:
      return "limit-exceeded";
    case ErrorCode::kImporterCrashed:
      return "importer-crashed";
    case ErrorCode::kSizeMismatch:
      return "size-mismatch";
    case ErrorCode::kNotFinite:
      return "not-finite";
    case ErrorCode::kWriteFailed:
      return "write-failed";
    case ErrorCode::kCancelled:
      return "cancelled";
    case ErrorCode::kInternal:
      return "internal";
  }
  return "internal";
}

}  // namespace facetless
