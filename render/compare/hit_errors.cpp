#include "render/compare/hit_errors.h"

#include <algorithm>
#include <cmath>

#include "render/image/paint.h"

namespace facetless {
namespace {

class Judge {
 public:
  Judge(const HitReference& reference, const SampleBuffer& samples, double tolerance_px)
      : reference_(reference), samples_(samples), tolerance_px_(kToleranceSlack * tolerance_px) {}

  HitError Of(std::size_t i, double* distance_px) const {
    const SampleBuffer& exact = reference_.samples;
    if (exact.certificate[i] != Certificate::kCertified) return HitError::kNotJudged;
    if (!samples_.certificate.empty() && samples_.certificate[i] == Certificate::kUnresolved)
      return HitError::kUnresolved;
    const bool there = exact.face[i] != kNoIndex, shown = samples_.face[i] != kNoIndex;
    if (!there) return shown ? HitError::kInvented : HitError::kNone;
    if (!shown) return HitError::kLost;
    const std::size_t width = static_cast<std::size_t>(exact.width);
    const Ray ray = PixelRay(reference_.frame, static_cast<double>(i % width) + 0.5,
                             static_cast<double>(i / width) + 0.5);
    const std::array<float, 3>& n = exact.normal[i];
    const double along = std::fabs(Dot(Vec3{n[0], n[1], n[2]}, ray.direction));
    const bool perspective = reference_.frame.projection == Projection::kPerspective;
    const double pixel =
        std::max(reference_.frame.pixel_x, reference_.frame.pixel_y) * (perspective ? exact.depth[i] : 1);
    const double farther = (samples_.depth[i] - exact.depth[i]) * along / pixel;
    // Two sheets that the ray grazes may be far apart along the ray, and near along the normal.
    const double apart = std::max(
        std::fabs(farther),
        exact.face[i] == samples_.face[i] ? 0.0 : std::fabs(samples_.depth[i] - exact.depth[i]) / pixel);
    const double bound = exact.depth_error.empty() ? 0 : exact.depth_error[i] * along / pixel;
    if (!(std::fabs(farther) <= tolerance_px_ + bound)) {
      if (!(apart < kOtherRootPx)) return farther > 0 ? HitError::kLost : HitError::kInvented;
      return HitError::kImprecise;
    }
    *distance_px = std::fabs(farther);
    return HitError::kNone;
  }

 private:
  const HitReference& reference_;
  const SampleBuffer& samples_;
  const double tolerance_px_;
};

}  // namespace

HitErrors JudgeHits(const HitReference& reference, const SampleBuffer& samples, double tolerance_px) {
  const Judge judge(reference, samples, tolerance_px);
  HitErrors errors;
  errors.width = samples.width;
  errors.height = samples.height;
  errors.of.resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double distance_px = 0;
    errors.of[i] = judge.Of(i, &distance_px);
    ++errors.counts[static_cast<std::size_t>(errors.of[i])];
    errors.largest_px = std::max(errors.largest_px, distance_px);
  }
  return errors;
}

void MarkHitErrors(const HitErrors& errors, Image8* picture) {
  constexpr Rgb8 kColors[] = {{0, 0, 0},      {213, 94, 0},    {0, 114, 178},
                              {240, 228, 66}, {204, 121, 167}, {0, 0, 0}};
  const int channels = picture->channels;
  for (std::size_t p = 0; p + static_cast<std::size_t>(channels) <= picture->bytes.size();
       p += static_cast<std::size_t>(channels)) {
    // The weights of the luma of ITU-R BT.709; light, so that the marks stand out.
    std::uint8_t* pixel = picture->bytes.data() + p;
    const double luma = 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
    std::fill_n(pixel, 3, static_cast<std::uint8_t>(128 + luma / 2));
  }
  for (int row = 0; row < errors.height; ++row)
    for (int column = 0; column < errors.width; ++column) {
      const HitError error =
          errors.of[static_cast<std::size_t>(row) * static_cast<std::size_t>(errors.width) +
                    static_cast<std::size_t>(column)];
      if (error == HitError::kNone || error == HitError::kNotJudged) continue;
      FillRectangle(*picture, {column - 1.0, row - 1.0}, {column + 2.0, row + 2.0},
                    kColors[static_cast<std::size_t>(error)]);
    }
}

}  // namespace facetless
