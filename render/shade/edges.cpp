#include "render/shade/edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/base/parallel.h"
#include "render/base/trigonometry.h"
#include "render/shade/features.h"

namespace facetless {
namespace {

// The linear light of a line, and its coverage.
constexpr float kInk[3] = {0.016f, 0.017f, 0.020f};
constexpr float kSilhouetteCover = 0.92f, kCreaseCover = 0.72f;

// The border between a pixel and its right or lower neighbour.
struct Border {
  Step step = Step::kNone;
  bool first_nearer = true;  // the left or upper pixel owns the line's wider half
};

struct Borders {
  std::vector<Border> right, below;
};

Border Find(const SampleBuffer& samples, const CameraFrame& frame, std::size_t first, std::size_t second,
            double cos_crease) {
  Border border;
  border.step = StepBetween(samples, frame, first, second, cos_crease);
  border.first_nearer = samples.depth[first] <= samples.depth[second];
  return border;
}

Borders FindAll(const SampleBuffer& samples, const CameraFrame& frame, double cos_crease) {
  Borders borders;
  borders.right.resize(samples.size());
  borders.below.resize(samples.size());
  ParallelFor(0, samples.height, [&](int y) {
    for (int x = 0; x < samples.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * samples.width + x;
      if (x + 1 < samples.width) borders.right[pixel] = Find(samples, frame, pixel, pixel + 1, cos_crease);
      if (y + 1 < samples.height)
        borders.below[pixel] = Find(samples, frame, pixel, pixel + samples.width, cos_crease);
    }
  });
  return borders;
}

// The cosine of an angle of 0 … 180 degrees, computed from the tangent of half the angle without libm.
double Cosine(double degrees) {
  if (!(degrees < 180)) return -1;
  const double t = PolyTan(degrees * (std::numbers::pi / 360));
  return (1 - t * t) / (1 + t * t);
}

float Cover(Step step) {
  if (step == Step::kJump) return kSilhouetteCover;
  return step == Step::kCrease ? kCreaseCover : 0.0f;
}

// The coverage of the pixel at `position` of `length` by the borders along one axis. border(i) lies between i
// and i + 1. A line that is `width` samples wide has its wider half on the nearer side.
template <typename BorderAt>
float CoverAlong(int position, int length, int width, const BorderAt& border) {
  const int wide = (width + 1) / 2, narrow = width / 2;
  float cover = 0;
  for (int distance = 0; distance < wide; ++distance) {
    if (position + distance + 1 < length) {
      const Border& after = border(position + distance);
      if (distance < (after.first_nearer ? wide : narrow)) cover = std::max(cover, Cover(after.step));
    }
    if (position - distance - 1 >= 0) {
      const Border& before = border(position - distance - 1);
      if (distance < (before.first_nearer ? narrow : wide)) cover = std::max(cover, Cover(before.step));
    }
  }
  return cover;
}

}  // namespace

void DrawEdges(const SampleBuffer& samples, const CameraFrame& frame, const ShadeOptions& options,
               Film& film) {
  const Borders borders = FindAll(samples, frame, Cosine(options.edge_angle_deg));
  ParallelFor(0, samples.height, [&](int y) {
    for (int x = 0; x < samples.width; ++x) {
      const std::size_t row = static_cast<std::size_t>(y) * samples.width;
      const float across = CoverAlong(x, samples.width, options.samples_x,
                                      [&](int i) -> const Border& { return borders.right[row + i]; });
      const float down = CoverAlong(y, samples.height, options.samples_y, [&](int i) -> const Border& {
        return borders.below[static_cast<std::size_t>(i) * samples.width + x];
      });
      const float cover = std::max(across, down);
      auto& pixel = film.pixels[row + x];
      for (int c = 0; c < 3; ++c) pixel[c] = pixel[c] * (1 - cover) + kInk[c] * cover;
      pixel[3] = pixel[3] * (1 - cover) + cover;
    }
  });
}

}  // namespace facetless
