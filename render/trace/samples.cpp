#include "render/trace/samples.h"

#include <cmath>

namespace facetless {

void SampleBuffer::Resize(int w, int h) {
  width = w;
  height = h;
  const std::size_t count = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  depth.assign(count, INFINITY);
  normal.assign(count, {0.0f, 0.0f, 0.0f});
  face.assign(count, kNoIndex);
}

}  // namespace facetless
