#include "render/accel/direction_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace facetless {
namespace {

// A start that is computed from t has an error of a few roundings of its distance from the origin, which is
// at most 2^11 sizes of the scene (BoxSet::TooFar): 8 · 2^-53 · 2^11 sizes. The sum is rounded at the size of
// its coordinates.
constexpr double kStartMargin = 0x1p-38, kCoordinateMargin = 0x1p-51;

double LargestCoordinate(const SlabBox& box) {
  double largest = 0;
  for (const auto& side : box.side)
    for (const double at : side) largest = std::max(largest, std::fabs(at));
  return largest;
}

}  // namespace

double DirectionTreeEstimate(int levels, double copies_per_level) {
  return std::pow(copies_per_level / 32, levels);
}

DirectionTree::Node::~Node() {
  if (children == nullptr) return;
  for (int child = 0; child < kChildren; ++child) delete children[child].load(std::memory_order_relaxed);
}

DirectionTree::DirectionTree(std::span<const Box3> boxes, DirectionTreeSettings settings)
    : boxes_(boxes),
      settings_(settings),
      margin_(kStartMargin * boxes_.scale() + kCoordinateMargin * LargestCoordinate(boxes_.bounds())) {
  std::vector<std::uint32_t> order(boxes_.size());
  for (int face = 0; face < 6; ++face) {
    Beam beam;
    beam.axis = face / 2;
    beam.positive = face % 2 == 0;
    for (int axis = 0; axis < 3; ++axis) {
      beam.low[axis] = boxes_.bounds().side[0][axis];
      beam.high[axis] = boxes_.bounds().side[1][axis];
    }
    for (int k = 0; k < 2; ++k) beam.slope_low[k] = -1, beam.slope_high[k] = 1;
    // Children keep the order of the root.
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return beam.positive ? boxes_[a].side[0][beam.axis] < boxes_[b].side[0][beam.axis]
                           : boxes_[a].side[1][beam.axis] > boxes_[b].side[1][beam.axis];
    });
    roots_[face] = MakeNode(beam, 0, order);
    bytes_ += BytesOf(*roots_[face]);
  }
}

DirectionTree::~DirectionTree() = default;

std::size_t DirectionTree::BytesOf(const Node& node) {
  return sizeof(Node) + node.ids.capacity() * sizeof(std::uint32_t) +
         (node.children != nullptr ? kChildren * sizeof(std::atomic<Node*>) : 0);
}

bool DirectionTree::BeamMeets(const Beam& beam, const SlabBox& box) const {
  // The depths, from the start along the axis, at which a ray of the beam may be within the box.
  const int axis = beam.axis;
  const double low = beam.low[axis] - margin_, high = beam.high[axis] + margin_;
  const double from = std::max(0.0, beam.positive ? box.side[0][axis] - high : low - box.side[1][axis]);
  const double to = beam.positive ? box.side[1][axis] - low : high - box.side[0][axis];
  if (!(to >= from)) return false;
  // Where the beam is on the other axes, at these depths.
  for (int k = 0; k < 2; ++k) {
    const int across = (axis + 1 + k) % 3;
    const double least =
        beam.low[across] - margin_ + std::min(beam.slope_low[k] * from, beam.slope_low[k] * to);
    const double most =
        beam.high[across] + margin_ + std::max(beam.slope_high[k] * from, beam.slope_high[k] * to);
    if (box.side[1][across] < least || box.side[0][across] > most) return false;
  }
  return true;
}

std::unique_ptr<DirectionTree::Node> DirectionTree::MakeNode(
    const Beam& beam, int depth, std::span<const std::uint32_t> candidates) const {
  auto node = std::make_unique<Node>();
  node->beam = beam;
  node->depth = depth;
  for (const std::uint32_t id : candidates)
    if (BeamMeets(beam, boxes_[id])) node->ids.push_back(id);
  node->ids.shrink_to_fit();
  if (node->ids.size() > kFew && depth < kDeepest) {
    node->children = std::make_unique<std::atomic<Node*>[]>(kChildren);
    for (int child = 0; child < kChildren; ++child)
      node->children[child].store(nullptr, std::memory_order_relaxed);
  }
  return node;
}

const DirectionTree::Node* DirectionTree::Child(const Node& node, int child) const {
  std::atomic<Node*>& place = node.children[child];
  if (const Node* made = place.load(std::memory_order_acquire)) return made;
  if (bytes_.load(std::memory_order_relaxed) >= settings_.most_bytes) return nullptr;

  // Halve the five intervals: bits 0 to 2 of the child's number for x, y and z, and bits 3 and 4 for u and v.
  Beam beam = node.beam;
  for (int axis = 0; axis < 3; ++axis)
    (child >> axis & 1 ? beam.low : beam.high)[axis] = 0.5 * beam.low[axis] + 0.5 * beam.high[axis];
  for (int k = 0; k < 2; ++k)
    (child >> (3 + k) & 1 ? beam.slope_low : beam.slope_high)[k] =
        0.5 * (beam.slope_low[k] + beam.slope_high[k]);
  std::unique_ptr<Node> mine = MakeNode(beam, node.depth + 1, node.ids);
  const std::size_t bytes = BytesOf(*mine);
  Node* theirs = nullptr;
  if (!place.compare_exchange_strong(theirs, mine.get(), std::memory_order_acq_rel,
                                     std::memory_order_acquire))
    return theirs;
  bytes_.fetch_add(bytes, std::memory_order_relaxed);
  return mine.release();
}

const DirectionTree::Node& DirectionTree::Find(const SlabRay& ray, int& levels) const {
  // The start, the face of the cube, and the two slopes.
  double start[3];
  for (int axis = 0; axis < 3; ++axis)
    start[axis] = std::clamp(ray.origin[axis] + ray.t_first * ray.direction[axis],
                             boxes_.bounds().side[0][axis], boxes_.bounds().side[1][axis]);
  const double size[3] = {std::fabs(ray.direction[0]), std::fabs(ray.direction[1]),
                          std::fabs(ray.direction[2])};
  const int axis = size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : (size[1] >= size[2] ? 1 : 2);
  double slope[2];
  for (int k = 0; k < 2; ++k) slope[k] = ray.direction[(axis + 1 + k) % 3] / size[axis];

  const Node* node = roots_[2 * axis + ray.near_side[axis]].get();
  levels = 1;
  while (node->children != nullptr) {
    const Beam& beam = node->beam;
    int child = 0;
    for (int a = 0; a < 3; ++a) child |= (start[a] >= 0.5 * beam.low[a] + 0.5 * beam.high[a]) << a;
    for (int k = 0; k < 2; ++k)
      child |= (slope[k] >= 0.5 * (beam.slope_low[k] + beam.slope_high[k])) << (3 + k);
    const Node* next = Child(*node, child);
    if (next == nullptr) break;
    node = next;
    ++levels;
  }
  return *node;
}

void DirectionTree::AddFigures(const Node& node, StructureFigures& figures) {
  // A node with a child that is missing answers the rays that would need it.
  figures.depth = std::max(figures.depth, node.depth);
  bool complete = node.children != nullptr;
  for (int child = 0; node.children != nullptr && child < kChildren; ++child) {
    if (const Node* below = node.children[child].load(std::memory_order_acquire))
      AddFigures(*below, figures);
    else
      complete = false;
  }
  if (complete) return;
  figures.regions += 1;
  figures.references += static_cast<double>(node.ids.size());
}

StructureFigures DirectionTree::figures() const {
  StructureFigures figures{0, 0, 0};
  for (const std::unique_ptr<Node>& root : roots_) AddFigures(*root, figures);
  return figures;
}

}  // namespace facetless
