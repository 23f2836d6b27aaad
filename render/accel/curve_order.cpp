#include "render/accel/curve_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace facetless {
namespace {

constexpr int kBits = 21;  // of each coordinate; three of them fill 63 bits

// Spreads 21 bits, with two zeros between neighbours.
std::uint64_t Spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x001f00000000ffff;
  bits = (bits | bits << 16) & 0x001f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

double Centre(const SlabBox& box, int axis) {
  return 0.5 * box.side[0][axis] + 0.5 * box.side[1][axis];
}

}  // namespace

std::vector<std::uint32_t> CurveOrder(std::span<const SlabBox> boxes) {
  double low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = std::numeric_limits<double>::infinity();
    high[axis] = -low[axis];
    for (const SlabBox& box : boxes) {
      low[axis] = std::min(low[axis], Centre(box, axis));
      high[axis] = std::max(high[axis], Centre(box, axis));
    }
  }
  std::vector<std::uint64_t> codes(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double width = high[axis] - low[axis];
      const double share = width > 0 ? (Centre(boxes[i], axis) - low[axis]) / width : 0;
      const auto step = static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * ((1 << kBits) - 1));
      codes[i] |= Spread(step) << axis;
    }
  }
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
  return order;
}

}  // namespace facetless
