// Result<T>: either a value, or the error that explains why there is no value.
//
//     Result<Model> model = ReadModel(path);
//     if (!model) return model.error();
//     Use(model.value());
//
//  1. Every expected failure has an enumerator of ErrorCode. The message is written for users: it names the
//     file, the entity if there is one, and the remedy.
//  2. Libraries never print, never abort, and never let an exception of a third-party library escape.
//  3. Calling value() on a failed Result is a programming error and asserts.
#pragma once

#include <cassert>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace facetless {

enum class ErrorCode : std::uint8_t {
  kBadUsage,         // the caller's options contradict themselves or are out of range
  kFileUnreadable,   // absent, no permission, or not a regular file
  kFormatUnknown,    // the content is not a CAD file, mesh or image of a supported format
  kFormatBroken,     // the content claims a format but violates it
  kNothingUsable,    // well-formed, but nothing in it can be rendered
  kUnitMismatch,     // the sizes of mesh and model differ by a factor of about 1000, 25.4 or 10
  kLimitExceeded,    // a limit of memory, time, file size or number of entities
  kImporterCrashed,  // a signal killed the importer process
  kSizeMismatch,     // two images or sample buffers of different size
  kNotFinite,        // NaN or infinity where a number is needed
  kWriteFailed,      // the disk is full, the directory is absent, or no permission
  kCancelled,        // the caller asked to stop
  kInternal,         // a defect of Facetless
};

// The stable name of the enumerator in JSON and in problem types: "bad-usage", "file-unreadable", …
const char* ErrorCodeName(ErrorCode code);

struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
};

template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  bool ok() const { return std::holds_alternative<T>(state_); }
  explicit operator bool() const { return ok(); }
  const T& value() const& {
    assert(ok());
    return std::get<T>(state_);
  }
  T& value() & {
    assert(ok());
    return std::get<T>(state_);
  }
  T&& value() && {
    assert(ok());
    return std::get<T>(std::move(state_));
  }
  const Error& error() const {
    assert(!ok());
    return std::get<Error>(state_);
  }

 private:
  std::variant<T, Error> state_;
};

// The result of an operation that succeeds or fails but has no value.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), ok_(false) {}  // NOLINT(google-explicit-constructor)
  bool ok() const { return ok_; }
  explicit operator bool() const { return ok_; }
  const Error& error() const {
    assert(!ok_);
    return error_;
  }

 private:
  Error error_;
  bool ok_ = true;
};

}  // namespace facetless
