// SHA-256 of bytes, streams and files, as 64 lower-case hexadecimal digits.
//
// libcrypto does the work: it uses the processor's SHA instructions (GB/s instead of some 200 MB/s), and the
// HTTP library loads it anyway, so it costs no new dependency.
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
  // Ends the computation: call it once.
  std::string Hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string Sha256Hex(std::string_view bytes);

// Error: kFileUnreadable.
Result<std::string> Sha256OfFile(const std::string& path);

// True for 64 lower-case hexadecimal digits.
bool IsSha256Hex(std::string_view text);

}  // namespace facetless
