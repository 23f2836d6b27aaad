// SHA-256 of bytes, streams and files, as 64 lower-case hexadecimal digits.
//
// The implementation is libcrypto. It uses the SHA instructions of the processor (GB/s instead of about 200
// MB/s), and the HTTP library needs it anyway, so it is no additional dependency.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "render/base/result.h"

namespace facetless {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void Add(const void* data, std::size_t size);
  // Finishes the computation and returns the digest. Call it only once.
  std::string Hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string Sha256Hex(std::string_view bytes);

// The digest of a file. Error: kFileUnreadable.
Result<std::string> Sha256OfFile(const std::string& path);

// Returns whether the text consists of 64 lower-case hexadecimal digits.
bool IsSha256Hex(std::string_view text);

}  // namespace facetless
