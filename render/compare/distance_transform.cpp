#include "render/compare/distance_transform.h"

#include <algorithm>
#include <cstddef>

namespace facetless {
namespace {

// Larger than any distance in the largest picture, and small enough to square.
constexpr std::int64_t kFar = std::int64_t{1} << 20;

// Computes, along one column, the distance to the nearest set pixel of that column.
void ColumnDistances(const std::vector<std::uint8_t>& mask, int width, int height, int x,
                     std::vector<std::int64_t>& out) {
  std::int64_t distance = kFar;
  for (int y = 0; y < height; ++y) {
    const std::size_t i = static_cast<std::size_t>(y) * width + x;
    distance = mask[i] ? 0 : std::min(distance + 1, kFar);
    out[i] = distance;
  }
  distance = kFar;
  for (int y = height; y-- > 0;) {
    const std::size_t i = static_cast<std::size_t>(y) * width + x;
    distance = mask[i] ? 0 : std::min(distance + 1, kFar);
    out[i] = std::min(out[i], distance);
  }
}

// Computes the lower envelope of the parabolas (x − i)² + height[i] over one row.
class Envelope {
 public:
  explicit Envelope(int width) : apex_(width), begin_(width) {}

  void Lower(const std::int64_t* height, int width, std::int64_t* out) {
    int last = -1;
    for (int i = 0; i < width; ++i) {
      // Drop the parabolas that the new one undercuts where they begin.
      std::int64_t begin = 0;
      while (last >= 0) {
        begin = TakesOver(height, apex_[last], i);
        if (begin > begin_[last]) break;
        --last;
        begin = 0;
      }
      if (begin >= width) continue;
      ++last;
      apex_[last] = i;
      begin_[last] = begin;
    }
    for (int x = 0, k = 0; x < width; ++x) {
      while (k < last && begin_[k + 1] <= x) ++k;
      const std::int64_t offset = x - apex_[k];
      out[x] = offset * offset + height[apex_[k]];
    }
  }

 private:
  // Returns the first integer at which the parabola of `later` is lower than that of `earlier`.
  static std::int64_t TakesOver(const std::int64_t* height, int earlier, int later) {
    const std::int64_t numerator =
        (height[later] + std::int64_t{later} * later) - (height[earlier] + std::int64_t{earlier} * earlier);
    const std::int64_t denominator = 2 * (std::int64_t{later} - earlier);
    // floor(numerator / denominator) + 1; the denominator is positive.
    std::int64_t quotient = numerator / denominator;
    if (numerator % denominator < 0) --quotient;
    return std::max<std::int64_t>(quotient + 1, 0);
  }

  std::vector<int> apex_;
  std::vector<std::int64_t> begin_;
};

}  // namespace

std::vector<std::int64_t> SquaredDistances(const std::vector<std::uint8_t>& mask, int width, int height) {
  std::vector<std::int64_t> distances(mask.size(), -1);
  if (std::none_of(mask.begin(), mask.end(), [](std::uint8_t set) { return set != 0; })) return distances;
  for (int x = 0; x < width; ++x) ColumnDistances(mask, width, height, x, distances);
  Envelope envelope(width);
  std::vector<std::int64_t> row(width);
  for (int y = 0; y < height; ++y) {
    std::int64_t* distance = &distances[static_cast<std::size_t>(y) * width];
    for (int x = 0; x < width; ++x) row[x] = distance[x] * distance[x];
    envelope.Lower(row.data(), width, distance);
  }
  return distances;
}

}  // namespace facetless
