// What a tracer answers, one entry per pixel centre, row-major, row 0 on top. Both tracers fill the same
// buffers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/base/large_pages.h"
#include "render/base/vec.h"
#include "render/model/model.h"

namespace facetless {

// How a sample's answer was reached. certified + converged + unresolved = samples, misses included.
enum class Certificate : std::uint8_t {
  kCertified,   // root or miss follows from proven bounds
  kConverged,   // an answer, but for the doubts of render/view/doubt.h no proof
  kUnresolved,  // neither
};

// One entry per sample.
template <typename T>
using PerSample = std::vector<T, LargePages<T>>;

struct SampleBuffer {
  int width = 0, height = 0;
  PerSample<double> depth;  // mm from the eye plane; +inf: nothing hit
  PerSample<std::array<float, 3>>
      normal;  // unit, outward by the face's orientation (not flipped to the viewer); 0 where nothing is hit
  PerSample<std::uint32_t> face;  // placed-face id; kNoIndex where nothing is hit
  PerSample<std::array<double, 2>>
      uv;  // native surface parameters; empty if the tracer has none or nobody asked
  PerSample<Certificate> certificate;  // empty for the baseline
  PerSample<std::uint8_t> doubt;       // bits of Doubt, why a sample is not certified; empty for the baseline
  // Bound of the depth's error, mm, against the exact surface; 0 where nothing is hit, +inf where there is no
  // bound. Holds for certified samples. Empty unless asked for.
  PerSample<float> depth_error;

  void Resize(int w, int h);    // depth, normal and face; filled with the values of a miss
  void Allocate(int w, int h);  // the same, not filled
  std::size_t size() const { return depth.size(); }
};

}  // namespace facetless
