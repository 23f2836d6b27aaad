#include "render/view/samples.h"

#include <algorithm>
#include <cmath>

namespace facetless {

void SampleBuffer::Allocate(int w, int h) {
  width = w;
  height = h;
  const std::size_t count = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  depth.resize(count);
  normal.resize(count);
  face.resize(count);
}

void SampleBuffer::Resize(int w, int h) {
  Allocate(w, h);
  std::fill(depth.begin(), depth.end(), INFINITY);
  std::fill(normal.begin(), normal.end(), std::array<float, 3>{0, 0, 0});
  std::fill(face.begin(), face.end(), kNoIndex);
}

}  // namespace facetless
