#include "render/compare/difference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "render/base/parallel.h"
#include "render/compare/distance_transform.h"
#include "render/model/walk.h"
#include "render/shade/features.h"

namespace facetless {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
// Borders are found by jumps alone: with this value no angle counts as a crease.
constexpr double kNoCrease = -2;

bool Hit(const SampleBuffer& samples, std::size_t i) {
  return samples.depth[i] != INFINITY;
}

Result<void> CheckBuffer(const SampleBuffer& samples, const char* name) {
  const std::size_t count =
      static_cast<std::size_t>(samples.width) * static_cast<std::size_t>(samples.height);
  if (samples.width < 1 || samples.height < 1 || samples.depth.size() != count ||
      samples.normal.size() != count || samples.face.size() != count)
    return Error{ErrorCode::kSizeMismatch,
                 std::string("the ") + name + " samples' buffers have different sizes"};
  for (std::size_t i = 0; i < count; ++i) {
    const auto& n = samples.normal[i];
    const bool sound =
        samples.depth[i] == INFINITY || (std::isfinite(samples.depth[i]) && std::isfinite(n[0]) &&
                                         std::isfinite(n[1]) && std::isfinite(n[2]));
    if (!sound)
      return Error{ErrorCode::kNotFinite, std::string("the ") + name + " sample at pixel (" +
                                              std::to_string(i % samples.width) + ", " +
                                              std::to_string(i / samples.width) + ") is not a number"};
  }
  return {};
}

Result<void> CheckSameSize(const SampleBuffer& direct, const SampleBuffer& baseline) {
  if (direct.width != baseline.width || direct.height != baseline.height)
    return Error{ErrorCode::kSizeMismatch, "the views have different sizes: " + std::to_string(direct.width) +
                                               "×" + std::to_string(direct.height) + " and " +
                                               std::to_string(baseline.width) + "×" +
                                               std::to_string(baseline.height)};
  return {};
}

// Collects the values of one quantity and computes their statistics.
class Collector {
 public:
  void Add(double value, std::size_t pixel) {
    const double size = std::fabs(value);
    sum_ += value;
    sum_abs_ += size;
    sum_squares_ += value * value;
    if (sizes_.empty() || size > largest_) {
      largest_ = size;
      largest_at_ = pixel;
    }
    sizes_.push_back(size);
  }

  Spread Finish(int width) {
    Spread spread;
    spread.count = sizes_.size();
    if (sizes_.empty()) return spread;
    const double count = static_cast<double>(sizes_.size());
    spread.mean = sum_ / count;
    spread.mean_abs = sum_abs_ / count;
    spread.rms = std::sqrt(sum_squares_ / count);
    spread.max = largest_;
    spread.max_x = static_cast<int>(largest_at_ % width);
    spread.max_y = static_cast<int>(largest_at_ / width);
    spread.p50 = Percentile(0.50);
    spread.p95 = Percentile(0.95);
    spread.p99 = Percentile(0.99);
    return spread;
  }

 private:
  double Percentile(double share) {
    const double rank = std::ceil(share * static_cast<double>(sizes_.size()));
    const auto place = sizes_.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
    std::nth_element(sizes_.begin(), place, sizes_.end());
    return *place;
  }

  std::vector<double> sizes_;
  double sum_ = 0, sum_abs_ = 0, sum_squares_ = 0, largest_ = 0;
  std::size_t largest_at_ = 0;
};

Silhouette CompareSilhouettes(const SampleBuffer& direct, const SampleBuffer& baseline) {
  std::vector<std::uint8_t> direct_mask(direct.size()), baseline_mask(direct.size());
  Silhouette silhouette;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    direct_mask[i] = Hit(direct, i);
    baseline_mask[i] = Hit(baseline, i);
    silhouette.only_direct += direct_mask[i] && !baseline_mask[i];
    silhouette.only_baseline += !direct_mask[i] && baseline_mask[i];
  }
  silhouette.pixels = silhouette.only_direct + silhouette.only_baseline;
  if (silhouette.pixels == 0) return silhouette;

  const auto farthest = [&](const std::vector<std::uint8_t>& from, const std::vector<std::uint8_t>& to) {
    const std::vector<std::int64_t> distances = SquaredDistances(to, direct.width, direct.height);
    double largest = 0;
    for (std::size_t i = 0; i < from.size(); ++i)
      if (from[i] && !to[i])
        largest =
            std::max(largest, distances[i] < 0 ? INFINITY : std::sqrt(static_cast<double>(distances[i])));
    return largest;
  };
  silhouette.max_distance_px =
      std::max(farthest(direct_mask, baseline_mask), farthest(baseline_mask, direct_mask));
  return silhouette;
}

// Calls `visit` with the indices of the up to eight neighbours of `i`.
template <typename Visit>
void ForNeighbours(int width, int height, std::size_t i, const Visit& visit) {
  const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
  for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, height - 1); ++ny)
    for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, width - 1); ++nx)
      if (nx != x || ny != y) visit(static_cast<std::size_t>(ny) * width + nx);
}

bool ShowsNearby(const SampleBuffer& samples, std::size_t i, std::uint32_t face) {
  bool shows = false;
  ForNeighbours(samples.width, samples.height, i, [&](std::size_t other) {
    shows = shows || (Hit(samples, other) && samples.face[other] == face);
  });
  return shows;
}

// Returns true if pixel i has a neighbour across a jump of depth in `samples` whose depth is nearer to
// `depth` than that of pixel i.
bool LiesAcrossJump(const SampleBuffer& samples, const CameraFrame& frame, std::size_t i, double depth) {
  bool across = false;
  ForNeighbours(samples.width, samples.height, i, [&](std::size_t other) {
    across = across || (Hit(samples, other) &&
                        std::fabs(depth - samples.depth[other]) < std::fabs(depth - samples.depth[i]) &&
                        StepBetween(samples, frame, i, other, kNoCrease) == Step::kJump);
  });
  return across;
}

bool IsBorder(const SampleBuffer& direct, const SampleBuffer& baseline, const CameraFrame& frame,
              bool faces_known, std::size_t i) {
  if (!Hit(direct, i) || !Hit(baseline, i)) return false;
  if (faces_known && direct.face[i] != baseline.face[i] &&
      (ShowsNearby(direct, i, baseline.face[i]) || ShowsNearby(baseline, i, direct.face[i])))
    return true;
  // A jump is a change of depth by more than two pixels' width. A depth that lies nearer to its far side
  // differs from the near side by more than half of that.
  const double change = std::fabs(direct.depth[i] - baseline.depth[i]);
  const double pixel =
      std::max(frame.pixel_x, frame.pixel_y) *
      (frame.projection == Projection::kPerspective ? std::min(direct.depth[i], baseline.depth[i]) : 1.0);
  return change > pixel && (LiesAcrossJump(direct, frame, i, baseline.depth[i]) ||
                            LiesAcrossJump(baseline, frame, i, direct.depth[i]));
}

double NormalAngle(const std::array<float, 3>& a, const std::array<float, 3>& b, bool oriented) {
  const Vec3 u{a[0], a[1], a[2]}, v{b[0], b[1], b[2]};
  const double angle = std::atan2(Length(Cross(u, v)), Dot(u, v)) * kDegrees;
  return oriented ? angle : std::min(angle, 180 - angle);
}

// The values of one face while they are collected.
struct FaceSums {
  FaceDifference face;
  double deviation_sum = 0;
  std::uint64_t deviation_count = 0;
};

std::vector<FaceDifference> Ranked(std::map<std::uint32_t, FaceSums>& sums, const Model& model) {
  std::vector<FaceDifference> faces;
  for (auto& [id, sum] : sums) {
    sum.face.id = id;
    if (id < model.PlacedFaceCount()) sum.face.name = model.PlacedFaceName(id);
    if (sum.deviation_count > 0)
      sum.face.deviation_mm_mean = sum.deviation_sum / static_cast<double>(sum.deviation_count);
    faces.push_back(std::move(sum.face));
  }
  std::stable_sort(faces.begin(), faces.end(), [](const FaceDifference& a, const FaceDifference& b) {
    if (a.deviation_mm_max != b.deviation_mm_max) return a.deviation_mm_max > b.deviation_mm_max;
    if (a.depth_mm_max != b.depth_mm_max) return a.depth_mm_max > b.depth_mm_max;
    return a.missed_pixels > b.missed_pixels;
  });
  return faces;
}

}  // namespace

std::vector<std::uint8_t> BorderPixels(const SampleBuffer& direct, const SampleBuffer& baseline,
                                       const CameraFrame& frame, bool faces_known) {
  std::vector<std::uint8_t> border(direct.size(), 0);
  ParallelFor(0, direct.height, [&](int y) {
    const std::size_t first = static_cast<std::size_t>(y) * direct.width;
    for (std::size_t i = first; i < first + direct.width; ++i)
      border[i] = IsBorder(direct, baseline, frame, faces_known, i);
  });
  return border;
}

Result<Difference> ComputeDifference(const DifferenceInput& input) {
  const SampleBuffer &direct = input.direct, &baseline = input.baseline;
  if (Result<void> same = CheckSameSize(direct, baseline); !same.ok()) return same.error();
  if (Result<void> sound = CheckBuffer(direct, "direct"); !sound.ok()) return sound.error();
  if (Result<void> sound = CheckBuffer(baseline, "baseline"); !sound.ok()) return sound.error();

  Difference difference;
  const Result<ColorMetrics> color = CompareColors(input.direct_image, input.baseline_image, input.color);
  if (!color.ok()) return color.error();
  difference.color = color.value();
  difference.silhouette = CompareSilhouettes(direct, baseline);
  difference.noise_mm = input.noise_mm;
  difference.faces_known = input.faces_known;

  // Depth, deviation and normals, over the view and per face.
  const std::vector<std::uint8_t> border = BorderPixels(direct, baseline, input.frame, input.faces_known);
  Collector depth, deviation, normal;
  std::map<std::uint32_t, FaceSums> faces;
  // Only a closed solid defines which side is outside.
  std::vector<bool> closed(input.model.PlacedFaceCount(), false);
  for (const Instance& instance : input.model.instances) {
    for (const PlacedFace placed : WalkPlacedFaces(input.model, instance)) {
      const std::uint32_t solid = input.model.faces[placed.face].solid;
      closed[placed.id] = solid != kNoIndex && input.model.solids[solid].closed;
    }
  }
  for (std::size_t i = 0; i < direct.size(); ++i) {
    difference.baseline_hits += Hit(baseline, i);
    if (!Hit(direct, i)) continue;
    ++difference.direct_hits;
    FaceSums& sums = faces[direct.face[i]];
    FaceDifference& face = sums.face;
    ++face.pixels;
    if (!Hit(baseline, i)) {
      ++face.missed_pixels;
      continue;
    }
    ++difference.both_hit;
    const double change = baseline.depth[i] - direct.depth[i];
    depth.Add(change, i);
    face.depth_mm_max = std::max(face.depth_mm_max, std::fabs(change));
    const bool other_face = input.faces_known && direct.face[i] != baseline.face[i];
    difference.other_face_pixels += other_face;
    face.other_face_pixels += other_face;
    if (border[i]) {
      ++difference.border_pixels;
      ++face.border_pixels;
      continue;
    }
    const Ray ray = PixelRay(input.frame, static_cast<double>(i % direct.width) + 0.5,
                             static_cast<double>(i / direct.width) + 0.5);
    const Vec3 n{direct.normal[i][0], direct.normal[i][1], direct.normal[i][2]};
    const double apart = std::fabs(change) * std::fabs(Dot(n, ray.direction));
    const double turned = NormalAngle(direct.normal[i], baseline.normal[i], input.faces_known);
    if (direct.face[i] < closed.size() && closed[direct.face[i]]) {
      ++difference.oriented_pixels;
      difference.opposite_pixels += NormalAngle(direct.normal[i], baseline.normal[i], true) > 90;
    }
    deviation.Add(apart, i);
    normal.Add(turned, i);
    face.deviation_mm_max = std::max(face.deviation_mm_max, apart);
    face.normal_deg_max = std::max(face.normal_deg_max, turned);
    sums.deviation_sum += apart;
    ++sums.deviation_count;
  }
  difference.depth_mm = depth.Finish(direct.width);
  difference.deviation_mm = deviation.Finish(direct.width);
  difference.normal_deg = normal.Finish(direct.width);
  if (difference.both_hit > 0) {
    const double both = static_cast<double>(difference.both_hit);
    difference.border_share = static_cast<double>(difference.border_pixels) / both;
    difference.other_face_share = static_cast<double>(difference.other_face_pixels) / both;
  }
  difference.faces = Ranked(faces, input.model);
  return difference;
}

}  // namespace facetless
