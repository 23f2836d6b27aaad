// The builder from the top down (law 2 of bvh.h).
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "render/accel/bvh.h"

namespace facetless {
namespace {

constexpr int kBins = 16;
// Below this depth, objects are halved by number, so that the tree ends.
constexpr int kDeepest = 40;

struct Bin {
  SlabBox box{{{1, 1, 1}, {0, 0, 0}}};
  std::uint32_t count = 0;

  void Add(const SlabBox& other, std::uint32_t objects) {
    if (objects == 0) return;
    box = count == 0 ? other : UnionOf(box, other);
    count += objects;
  }
  double Cost() const { return count == 0 ? 0 : HalfSurface(box) * count; }
};

double Centre(const SlabBox& box, int axis) {
  return 0.5 * box.side[0][axis] + 0.5 * box.side[1][axis];
}

// The bins of an axis: equal intervals of the centres.
struct Binning {
  double low = 0, scale = 0;
  int Of(double centre) const { return std::clamp(static_cast<int>((centre - low) * scale), 0, kBins - 1); }
};

class Builder {
 public:
  explicit Builder(const BoxSet& boxes) : boxes_(boxes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
  }

  BvhTree Build() {
    tree_.nodes.reserve(boxes_.size());
    tree_.root = Divide(0, boxes_.size(), 0);
    return std::move(tree_);
  }

 private:
  // Makes the subtree of some objects, and returns it as a child.
  std::uint32_t Divide(std::uint32_t first, std::uint32_t last, int depth) {
    if (last - first == 1) return BvhTree::kObject | order_[first];
    const auto at = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.emplace_back();
    SlabBox box = boxes_[order_[first]];
    for (std::uint32_t i = first + 1; i < last; ++i) box = UnionOf(box, boxes_[order_[i]]);
    const std::uint32_t middle = depth < kDeepest ? Place(first, last) : first + (last - first) / 2;
    const std::uint32_t left = Divide(first, middle, depth + 1), right = Divide(middle, last, depth + 1);
    tree_.nodes[at] = {box, left, right};
    return at;
  }

  // Orders the objects so that the cheapest division is at the returned place, between first and last.
  std::uint32_t Place(std::uint32_t first, std::uint32_t last) {
    double best_cost = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_bin = 0;
    Binning best;
    for (int axis = 0; axis < 3; ++axis) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::uint32_t i = first; i < last; ++i) {
        low = std::min(low, Centre(boxes_[order_[i]], axis));
        high = std::max(high, Centre(boxes_[order_[i]], axis));
      }
      const Binning binning{low, kBins / (high - low)};
      if (!(high > low) || !(binning.scale < std::numeric_limits<double>::infinity())) continue;
      std::array<Bin, kBins> bins{};
      for (std::uint32_t i = first; i < last; ++i) {
        const SlabBox& box = boxes_[order_[i]];
        bins[binning.Of(Centre(box, axis))].Add(box, 1);
      }
      // The costs of what lies behind each plane, and then those of what lies before it.
      std::array<double, kBins> behind{};
      Bin sum;
      for (int b = kBins - 1; b > 0; --b) {
        sum.Add(bins[b].box, bins[b].count);
        behind[b] = sum.Cost();
      }
      sum = {};
      for (int b = 0; b + 1 < kBins; ++b) {
        sum.Add(bins[b].box, bins[b].count);
        if (sum.count == 0 || sum.count == last - first) continue;
        if (const double cost = sum.Cost() + behind[b + 1]; cost < best_cost)
          best_cost = cost, best_axis = axis, best_bin = b, best = binning;
      }
    }
    if (best_axis < 0) return first + (last - first) / 2;  // all centres are the same
    const auto middle = std::partition(order_.begin() + first, order_.begin() + last, [&](std::uint32_t id) {
      return best.Of(Centre(boxes_[id], best_axis)) <= best_bin;
    });
    return static_cast<std::uint32_t>(middle - order_.begin());
  }

  const BoxSet& boxes_;
  std::vector<std::uint32_t> order_;
  BvhTree tree_;
};

}  // namespace

BvhTree BuildTopDown(const BoxSet& boxes) {
  return Builder(boxes).Build();
}

}  // namespace facetless
