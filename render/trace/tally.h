// The counters of tracing, and the certificate that follows from a doubt. Private to render/trace.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "render/trace/direct.h"
#include "render/view/doubt.h"
#include "render/view/samples.h"

namespace facetless {

inline Certificate CertificateForDoubt(std::uint8_t doubt) {
  if (doubt & kUnresolvedDoubts) return Certificate::kUnresolved;
  return doubt ? Certificate::kConverged : Certificate::kCertified;
}

// The counters of one thread, on cache lines of their own.
struct alignas(64) Tally {
  std::uint64_t hits = 0, certified = 0, converged = 0, unresolved = 0, certified_hits = 0;
  std::uint64_t caps = 0;
  CheckStats check;
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};
  double depth_error_max = 0;

  void AddDoubts(std::uint8_t doubt) {
    const Certificate certificate = CertificateForDoubt(doubt);
    for (std::size_t bit = 0; doubt >> bit; ++bit) doubts[bit] += doubt >> bit & 1;
    converged += certificate == Certificate::kConverged;
    unresolved += certificate == Certificate::kUnresolved;
  }
};

// The smallest float that is not less than x, for bounds.
inline float RoundedUp(double x) {
  const float f = static_cast<float>(x);
  return f >= x ? f : std::nextafter(f, INFINITY);
}

}  // namespace facetless
