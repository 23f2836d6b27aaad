#include "render/shade/features.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

constexpr double kSlackPixels = 2, kSteepest = 30;  // law 1, in pixels' widths of depth

struct Sample {
  Ray ray;
  double depth = 0;
  Vec3 normal;  // flipped to the viewer
};

Sample LoadSample(const SampleBuffer& samples, const CameraFrame& frame, std::size_t pixel) {
  Sample sample;
  sample.ray = PixelRay(frame, static_cast<double>(pixel % samples.width) + 0.5,
                        static_cast<double>(pixel / samples.width) + 0.5);
  sample.depth = samples.depth[pixel];
  const auto& n = samples.normal[pixel];
  sample.normal = {n[0], n[1], n[2]};
  if (Dot(sample.normal, sample.ray.direction) > 0) sample.normal = -sample.normal;
  return sample;
}

// The change of depth from `from` to the other ray along the tangent plane of `from`; infinite if the plane
// is seen edge-on.
double PredictedChange(const Sample& from, const Ray& other) {
  const double facing = Dot(from.normal, other.direction);
  if (!(facing < 0)) return INFINITY;
  // Compute relative to the hit to avoid cancellation: start at the other ray's point at the same depth, and
  // continue along its direction.
  const Vec3 beside = (other.origin - from.ray.origin) + from.depth * (other.direction - from.ray.direction);
  return -Dot(from.normal, beside) / facing;
}

}  // namespace

Step StepBetween(const SampleBuffer& samples, const CameraFrame& frame, std::size_t a, std::size_t b,
                 double cos_crease) {
  const bool hit_a = std::isfinite(samples.depth[a]), hit_b = std::isfinite(samples.depth[b]);
  if (!hit_a && !hit_b) return Step::kNone;
  if (hit_a != hit_b) return Step::kJump;

  // Compare the change of depth with the predictions of both tangent planes.
  const Sample from = LoadSample(samples, frame, a), to = LoadSample(samples, frame, b);
  const double change = to.depth - from.depth;
  const double pixel = std::max(frame.pixel_x, frame.pixel_y) *
                       (frame.projection == Projection::kPerspective ? std::min(from.depth, to.depth) : 1.0);
  const double slack = kSlackPixels * pixel;
  const double by_a = PredictedChange(from, to.ray), by_b = -PredictedChange(to, from.ray);
  const double flatter = std::min(std::fabs(by_a), std::fabs(by_b));
  const double steeper = std::max(std::fabs(by_a), std::fabs(by_b));
  const bool bends = std::fabs(change) <= 2 * flatter + slack;
  const bool between = change >= std::min(by_a, by_b) - slack && change <= std::max(by_a, by_b) + slack &&
                       steeper <= kSteepest * pixel;
  if (!bends && !between) return Step::kJump;

  return samples.face[a] != samples.face[b] && Dot(from.normal, to.normal) < cos_crease ? Step::kCrease
                                                                                        : Step::kNone;
}

}  // namespace facetless
