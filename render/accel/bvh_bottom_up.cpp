// The builder from the bottom up (law 3 of bvh.h).
#include <algorithm>
#include <limits>

#include "render/accel/bvh.h"
#include "render/accel/curve_order.h"

namespace facetless {
namespace {

constexpr std::size_t kRadius = 16;

struct Cluster {
  SlabBox box;
  std::uint32_t child;
};

// The neighbour with which cluster i has the smallest box. Of equal ones, the one is taken whose number
// differs from i in the lowest bits, which is mutual: among equal boxes, half of all clusters find their
// partners.
std::size_t Neighbour(const std::vector<Cluster>& clusters, std::size_t i) {
  const std::size_t first = i < kRadius ? 0 : i - kRadius, last = std::min(clusters.size() - 1, i + kRadius);
  std::size_t best = i;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t j = first; j <= last; ++j) {
    if (j == i) continue;
    const double surface = HalfSurface(UnionOf(clusters[i].box, clusters[j].box));
    if (best == i || surface < least || (surface == least && (i ^ j) < (i ^ best))) least = surface, best = j;
  }
  return best;
}

}  // namespace

BvhTree BuildBottomUp(const BoxSet& boxes) {
  BvhTree tree;
  std::vector<Cluster> clusters, next;
  for (const std::uint32_t id : CurveOrder(boxes.boxes()))
    clusters.push_back({boxes[id], BvhTree::kObject | id});
  std::vector<std::size_t> neighbours;
  while (clusters.size() > 1) {
    neighbours.resize(clusters.size());
    for (std::size_t i = 0; i < clusters.size(); ++i) neighbours[i] = Neighbour(clusters, i);
    next.clear();
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      const std::size_t partner = neighbours[i];
      if (neighbours[partner] != i) {
        next.push_back(clusters[i]);
      } else if (i < partner) {
        const auto node = static_cast<std::uint32_t>(tree.nodes.size());
        const SlabBox box = UnionOf(clusters[i].box, clusters[partner].box);
        tree.nodes.push_back({box, clusters[i].child, clusters[partner].child});
        next.push_back({box, node});
      }
    }
    clusters.swap(next);
  }
  tree.root = clusters.front().child;
  return tree;
}

}  // namespace facetless
