#include "render/accel/voxels.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// Boundaries that are examined on each side of the even place of a plane, as a share of an interval.
constexpr double kSearch = 0.25;
// The shortest axis counts as at least this share of the longest, or a flat scene would have needles.
constexpr double kFlattest = 1e-3;

std::vector<double> EvenPlanesOf(double low, double high, std::uint32_t count) {
  std::vector<double> planes(count + 1);
  const double width = (high - low) / count;
  for (std::uint32_t i = 0; i < count; ++i) planes[i] = std::min(low + width * i, high);
  planes[count] = high;
  return planes;
}

// Planes across one axis: `lows` and `highs` are the boxes' sides, ascending.
std::vector<double> BoundaryPlanesOf(const std::vector<double>& lows, const std::vector<double>& highs,
                                     std::uint32_t count) {
  std::vector<double> sides;
  std::merge(lows.begin(), lows.end(), highs.begin(), highs.end(), std::back_inserter(sides));
  const auto cuts = [&](double at) {  // boxes with low < at < high
    return (std::lower_bound(lows.begin(), lows.end(), at) - lows.begin()) -
           (std::upper_bound(highs.begin(), highs.end(), at) - highs.begin());
  };
  std::vector<double> planes{lows.front()};
  const double step = static_cast<double>(sides.size()) / count;
  for (std::uint32_t i = 1; i < count; ++i) {
    const auto first = static_cast<std::size_t>(std::max(0.0, (i - kSearch) * step));
    const auto last = std::min(sides.size() - 1, static_cast<std::size_t>((i + kSearch) * step));
    double best = sides[static_cast<std::size_t>(i * step)];
    auto fewest = cuts(best);
    constexpr std::size_t kMostExamined = 64;
    const std::size_t stride = std::max<std::size_t>(1, (last - first) / kMostExamined);
    for (std::size_t k = first; k <= last; k += stride)
      if (const auto cut = cuts(sides[k]); cut < fewest) best = sides[k], fewest = cut;
    if (best > planes.back() && best < highs.back()) planes.push_back(best);
  }
  planes.push_back(highs.back());
  return planes;
}

}  // namespace

VoxelPlanes::Range VoxelPlanes::Reach(const SlabBox& box, int axis) const {
  const std::vector<double>& at = at_[axis];
  // The last plane at or before the low side, and the first one at or behind the high side.
  const auto low = std::upper_bound(at.begin(), at.end(), box.side[0][axis]) - at.begin() - 1;
  const auto high = std::lower_bound(at.begin(), at.end(), box.side[1][axis]) - at.begin() - 1;
  const auto last = static_cast<std::ptrdiff_t>(count(axis)) - 1;
  const auto first = std::clamp<std::ptrdiff_t>(low, 0, last);
  return {static_cast<std::uint32_t>(first),
          static_cast<std::uint32_t>(std::clamp<std::ptrdiff_t>(high, first, last))};
}

VoxelPlanes EvenPlanes(const SlabBox& bounds, const std::array<std::uint32_t, 3>& counts) {
  std::array<std::vector<double>, 3> at;
  for (int axis = 0; axis < 3; ++axis)
    at[axis] = EvenPlanesOf(bounds.side[0][axis], bounds.side[1][axis], counts[axis]);
  return VoxelPlanes(std::move(at));
}

VoxelPlanes BoundaryPlanes(const BoxSet& boxes, const std::array<std::uint32_t, 3>& counts) {
  if (boxes.size() == 0) return EvenPlanes(boxes.bounds(), {1, 1, 1});
  std::array<std::vector<double>, 3> at;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> lows, highs;
    for (const SlabBox& box : boxes.boxes()) {
      lows.push_back(box.side[0][axis]);
      highs.push_back(box.side[1][axis]);
    }
    std::sort(lows.begin(), lows.end());
    std::sort(highs.begin(), highs.end());
    at[axis] = BoundaryPlanesOf(lows, highs, counts[axis]);
  }
  return VoxelPlanes(std::move(at));
}

std::array<std::uint32_t, 3> CubicCounts(const BoxSet& boxes, double per_object, std::uint32_t most) {
  const SlabBox& bounds = boxes.bounds();
  double size[3], largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = (bounds.side[1][axis] - bounds.side[0][axis]) / boxes.scale();
    largest = std::max(largest, size[axis]);
  }
  if (!(largest > 0)) return {1, 1, 1};
  double volume = 1;
  for (double& side : size) volume *= side = std::max(side / largest, kFlattest);
  const double edge = std::cbrt(volume / std::max(1.0, per_object * boxes.size()));
  std::array<std::uint32_t, 3> counts{};
  for (int axis = 0; axis < 3; ++axis)
    counts[axis] = static_cast<std::uint32_t>(std::clamp(std::round(size[axis] / edge), 1.0, double(most)));
  return counts;
}

std::uint64_t CountReferences(const BoxSet& boxes, const VoxelPlanes& planes) {
  std::uint64_t references = 0;
  for (const SlabBox& box : boxes.boxes()) {
    std::uint64_t voxels = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const VoxelPlanes::Range range = planes.Reach(box, axis);
      voxels *= range.last - range.first + 1;
    }
    references += voxels;
  }
  return references;
}

VoxelLists::VoxelLists(const BoxSet& boxes, const VoxelPlanes& planes) {
  const auto for_each = [&](const auto& body) {
    for (std::uint32_t id = 0; id < boxes.size(); ++id) {
      const auto x = planes.Reach(boxes[id], 0), y = planes.Reach(boxes[id], 1),
                 z = planes.Reach(boxes[id], 2);
      for (std::size_t k = z.first; k <= z.last; ++k)
        for (std::size_t j = y.first; j <= y.last; ++j)
          for (std::size_t i = x.first; i <= x.last; ++i)
            body(i + planes.count(0) * (j + planes.count(1) * k), id);
    }
  };
  // Count, sum up, and fill from the back of each list.
  begin_.assign(planes.voxels() + 1, 0);
  for_each([&](std::size_t voxel, std::uint32_t) { ++begin_[voxel]; });
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : begin_) begin = sum += begin;
  ids_.resize(sum);
  for_each([&](std::size_t voxel, std::uint32_t id) { ids_[--begin_[voxel]] = id; });
}

}  // namespace facetless
