#include "render/compare/light_difference.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/base/parallel.h"

namespace facetless {
namespace {

// Colours from the palette of Okabe and Ito, which people with the common forms of colour blindness can tell apart.
constexpr std::array<double, 3> kOnlyReference = {213, 94, 0}, kOnlyCandidate = {0, 114, 178},
                                kSelfShadow = {204, 121, 167};
constexpr double kEnlarged = 4;    // factor by which differences of the ambient light are enlarged
constexpr double kPaleness = 0.7;  // share of white in the picture of the reference

enum Mark : std::uint8_t { kNone, kSame, kReferenceLit, kCandidateLit, kFalse };

// Whether a pixel shows a surface (1), the ground (2) or nothing (0).
int Shown(const LitView& view, std::size_t i) {
  if (view.samples.depth[i] != INFINITY) return 1;
  const auto& ground = view.light.centres.ground;
  return !ground.empty() && ground[i] != 0 ? 2 : 0;
}

// Marks the falsely self-shadowed pixels among those that are lit only on the reference, and returns their number.
std::uint64_t MarkFalseShadows(const LitView& candidate, const CameraFrame& frame, std::vector<Mark>* marks) {
  const Vec3 key = TowardKeyLight(frame);
  const auto width = static_cast<std::size_t>(candidate.samples.width);
  PerThread<std::uint64_t> counts;
  ParallelFor(std::size_t{0}, marks->size() / width, [&](std::size_t row) {
    std::vector<std::size_t> pixels;
    std::vector<RayStart> starts;
    std::vector<SecondaryRay> rays;
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      if ((*marks)[i] != kReferenceLit || Shown(candidate, i) != 1) continue;
      const auto start =
          StartOfSample(candidate.samples, frame, i, static_cast<double>(i - row * width) + 0.5,
                        static_cast<double>(row) + 0.5);
      if (!(Dot(start.normal, key) > 0)) continue;
      rays.push_back({static_cast<std::uint32_t>(starts.size()), key, INFINITY});
      starts.push_back(start);
      pixels.push_back(i);
    }
    std::vector<SecondaryHit> hits(rays.size());
    candidate.light.rays->FindNearest(starts, rays, hits);
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      if (hits[k].placed_face == kNoIndex || hits[k].placed_face != starts[k].placed_face) continue;
      (*marks)[pixels[k]] = kFalse;
      ++counts.local();
    }
  });
  std::uint64_t count = 0;
  for (const std::uint64_t one : counts) count += one;
  return count;
}

// Mixes a colour into a pixel of three bytes.
void Tint(const std::array<double, 3>& color, double share, std::uint8_t* pixel) {
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::lround((1 - share) * pixel[c] + share * color[c]));
}

// Returns the picture of the reference in pale grey, with three channels. Transparent pixels become white.
Image8 Paled(const Image8& base) {
  Image8 image{base.width, base.height, 3, {}};
  image.bytes.resize(static_cast<std::size_t>(base.width) * base.height * 3);
  for (std::size_t i = 0; i < image.bytes.size() / 3; ++i) {
    const std::uint8_t* from = &base.bytes[i * base.channels];
    const double alpha = base.channels == 4 ? from[3] / 255.0 : 1;
    const double grey = alpha * (0.299 * from[0] + 0.587 * from[1] + 0.114 * from[2]) + (1 - alpha) * 255;
    const auto pale = static_cast<std::uint8_t>(std::lround(kPaleness * 255 + (1 - kPaleness) * grey));
    std::fill_n(&image.bytes[3 * i], 3, pale);
  }
  return image;
}

}  // namespace

Result<LightComparison> CompareLight(const LitView& reference, const LitView& candidate,
                                     const CameraFrame& frame, bool faces_known, const Image8& base) {
  const SampleLight &a = reference.light.centres, &b = candidate.light.centres;
  const std::size_t size = reference.samples.size();
  if (candidate.samples.size() != size || a.key.size() != b.key.size() || a.open.size() != b.open.size() ||
      base.width != reference.samples.width || base.height != reference.samples.height)
    return Error{ErrorCode::kSizeMismatch,
                 "the two views differ in size, or only one of them has shadows or occlusion"};
  LightComparison comparison;
  LightDifference& difference = comparison.difference;
  difference.shadows = !a.key.empty();
  difference.occlusion = !a.open.empty();
  std::vector<Mark> marks(size, kNone);
  double sum = 0, sum_abs = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const int shown = Shown(reference, i);
    if (shown == 0 || shown != Shown(candidate, i)) continue;
    ++difference.pixels;
    marks[i] = kSame;
    if (difference.shadows && a.key[i] != b.key[i]) {
      marks[i] = a.key[i] > b.key[i] ? kReferenceLit : kCandidateLit;
      ++(a.key[i] > b.key[i] ? difference.lit_only_reference : difference.lit_only_candidate);
    }
    if (difference.occlusion) {
      const double darker = double{a.open[i]} - b.open[i];
      sum += darker;
      sum_abs += std::fabs(darker);
      difference.occlusion_max = std::max(difference.occlusion_max, std::fabs(darker));
    }
  }
  if (difference.pixels > 0) {
    difference.occlusion_mean = sum / static_cast<double>(difference.pixels);
    difference.occlusion_mean_abs = sum_abs / static_cast<double>(difference.pixels);
  }
  if (difference.shadows && faces_known)
    difference.false_self_shadow = MarkFalseShadows(candidate, frame, &marks);

  comparison.picture = Paled(base);
  for (std::size_t i = 0; i < size; ++i) {
    std::uint8_t* pixel = &comparison.picture.bytes[3 * i];
    if (marks[i] == kReferenceLit) Tint(kOnlyReference, 1, pixel);
    if (marks[i] == kCandidateLit) Tint(kOnlyCandidate, 1, pixel);
    if (marks[i] == kFalse) Tint(kSelfShadow, 1, pixel);
    if (marks[i] == kSame && difference.occlusion) {
      const double darker = double{a.open[i]} - b.open[i];
      Tint(darker > 0 ? kOnlyReference : kOnlyCandidate, std::min(1.0, kEnlarged * std::fabs(darker)), pixel);
    }
  }
  return comparison;
}

}  // namespace facetless
