// Result<T>: a value, or the one reason why there is none.
//
//  1. Every expected failure has an enumerator of ErrorCode; the sentence is for the person who reads it and
//     names the file, the entity where there is one, and the remedy.
//  2. Libraries never print, never abort and never let an exception of a third party through.
//  3. value() of a failed Result is a programming error and asserts.
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
  kFormatUnknown,    // the content is no CAD file, mesh or image that we read
  kFormatBroken,     // the content claims a format and then violates it
  kNothingUsable,    // well-formed, but nothing in it can be rendered
  kUnitMismatch,     // a mesh whose size contradicts the model's by about 1000, 25.4 or 10
  kLimitExceeded,    // memory, time, file size, or a number of entities
  kImporterCrashed,  // the importer process died of a signal
  kSizeMismatch,     // two images or sample buffers of different size
  kNotFinite,        // NaN or infinity where a number is needed
  kWriteFailed,      // the disk is full, the directory is absent, or no permission
  kCancelled,        // the caller asked to stop
  kInternal,         // a defect of Facetless
};

// The enumerator's stable name in JSON and in problem types: "bad-usage", "file-unreadable", …
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

// A Result without a value.
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
