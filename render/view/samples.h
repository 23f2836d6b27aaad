// The result of a tracer: one entry per pixel centre, in row-major order with row 0 at the top. All tracers
// fill the same buffers.
//
//     const std::size_t i = std::size_t(row) * samples.width + column;
//     if (samples.face[i] != kNoIndex) sum += samples.depth[i];
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/base/large_pages.h"
#include "render/base/vec.h"
#include "render/model/model.h"

namespace facetless {

// How certain the result of a sample is. Every sample, hit or miss, is in exactly one of these classes.
enum class Certificate : std::uint8_t {
  kCertified,   // the hit or the miss follows from proven bounds
  kConverged,   // there is a result, but no proof, for the reasons in render/view/doubt.h
  kUnresolved,  // the sample is neither a hit nor a miss
};

// One entry per sample.
template <typename T>
using PerSample = std::vector<T, LargePages<T>>;

struct SampleBuffer {
  int width = 0, height = 0;
  PerSample<double> depth;  // mm from the eye plane; +inf for a miss
  PerSample<std::array<float, 3>>
      normal;  // unit vector, outward by the orientation of the face (not flipped to the viewer); 0 for a miss
  PerSample<std::uint32_t> face;  // placed-face id; kNoIndex for a miss
  PerSample<std::array<double, 2>>
      uv;  // native surface parameters; empty if the tracer has none or they were not requested
  PerSample<Certificate> certificate;  // empty for the baseline
  PerSample<std::uint8_t> doubt;  // bits of Doubt: why the sample is not certified; empty for the baseline
  // Bound of the depth error against the exact surface, mm; 0 for a miss, +inf if there is no bound. It holds
  // for certified samples. Empty unless requested.
  PerSample<float> depth_error;

  void Resize(int w, int h);    // resizes depth, normal and face, and fills them with the values of a miss
  void Allocate(int w, int h);  // resizes them without filling
  std::size_t size() const { return depth.size(); }
};

}  // namespace facetless
