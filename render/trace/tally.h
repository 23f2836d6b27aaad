// What tracing counts, and what a doubt makes of a sample. Private to trace/.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "render/trace/direct.h"
#include "render/view/doubt.h"
#include "render/view/samples.h"

namespace facetless {

inline Certificate CertificateOf(std::uint8_t doubt) {
  if (doubt & kUnresolvedDoubts) return Certificate::kUnresolved;
  return doubt ? Certificate::kConverged : Certificate::kCertified;
}

// Counts of one thread; its own cache lines.
struct alignas(64) Tally {
  std::uint64_t hits = 0, certified = 0, converged = 0, unresolved = 0, certified_hits = 0;
  std::uint64_t caps = 0;
  CheckStats check;
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};
  double depth_error_max = 0;

  void AddDoubts(std::uint8_t doubt) {
    const Certificate certificate = CertificateOf(doubt);
    for (std::size_t bit = 0; doubt >> bit; ++bit) doubts[bit] += doubt >> bit & 1;
    converged += certificate == Certificate::kConverged;
    unresolved += certificate == Certificate::kUnresolved;
  }
};

// A bound as a float.
inline float RoundedUp(double x) {
  const float f = static_cast<float>(x);
  return f >= x ? f : std::nextafter(f, INFINITY);
}

}  // namespace facetless
