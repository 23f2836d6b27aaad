#include "render/voxel_walks/octree_view.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// Rays and projections round each coordinate by a few units of 2⁻⁵³ of the largest one. This is far more.
constexpr double kRounding = 0x1p-36;

// A cube in the coordinates of a ray that descends along other axes: `turned` has the axes along which the two rays differ.
OctreeCube Turned(OctreeCube cube, unsigned turned) {
  for (int axis = 0; axis < 3; ++axis)
    if (turned >> axis & 1) cube.low[axis] = -cube.low[axis] - (1 << cube.level);
  return cube;
}

// Whether an ascending ray passes cube a before cube b: the order of the tree's nodes.
bool Precedes(const OctreeCube& a, const OctreeCube& b) {
  // Coordinates are moved above 0 by a multiple of the root's edge.
  constexpr int kAbove = 1 << (kMostOctreeLevels + 1);
  const auto digits = [](const OctreeCube& cube, int axis) {
    return static_cast<unsigned>(static_cast<int>(cube.low[axis]) + kAbove);
  };
  // The axis with the highest differing digit decides; of equal ones z, as it has the highest digit of a child's number.
  int axis = 2;
  unsigned highest = digits(a, 2) ^ digits(b, 2);
  for (int other = 1; other >= 0; --other) {
    const unsigned differing = digits(a, other) ^ digits(b, other);
    if (highest < differing && highest < (highest ^ differing)) {
      axis = other;
      highest = differing;
    }
  }
  return digits(a, axis) < digits(b, axis);
}

}  // namespace

OctreeView::OctreeView(const OctreeModel& model, const VoxelCamera& camera)
    : model_(model),
      camera_(camera),
      columns_((camera.width_px + kTile - 1) / kTile),
      rows_((camera.height_px + kTile - 1) / kTile) {
  const Box3 bounds = camera.grid.bounds();
  const double depth = Dot(bounds.center() - camera.frame.eye, camera.frame.forward),
               farthest = depth + 0.5 * bounds.diagonal();
  // No node above the cut may be a level of detail. A cube that is as wide as a tile is a good compromise.
  const WalkOptions footprint = camera.Footprint();
  const double largest = footprint.footprint_0 + footprint.footprint * std::max(farthest, 0.0),
               usual = footprint.footprint_0 + footprint.footprint * std::max(depth, 0.0);
  int cut = kLevel;
  while (cut < model.level() && ((2 << cut) <= 1.001 * largest || 1.4 * (1 << cut) < kTile * usual)) ++cut;
  const Vec3 forward = PixelRay(camera.frame, 0.5 * camera.width_px, 0.5 * camera.height_px).direction;
  descends_ = unsigned{forward.x < 0} | unsigned{forward.y < 0} << 1 | unsigned{forward.z < 0} << 2;
  const Vec3 from_eye = camera.grid.origin - camera.frame.eye;
  const double pitch = camera.grid.pitch;
  const auto along = [&](const Vec3& d) {
    return Direction{Dot(from_eye, d), pitch * d, pitch * (std::abs(d.x) + std::abs(d.y) + std::abs(d.z))};
  };
  right_ = along(camera.frame.right);
  down_ = along(camera.frame.down);
  forward_ = along(camera.frame.forward);
  margin_ = kRounding * (Length(camera.frame.eye) + Length(camera.grid.origin) + bounds.diagonal());
  std::vector<TileRange> ranges;
  Collect(model.root(), {0, 0, 0}, model.level(), std::min(cut, model.level()), &ranges);
  FillLists(ranges);
  OrderLists();
}

void OctreeView::Collect(const OctreeNode& node, VoxelPoint low, int level, int cut,
                         std::vector<TileRange>* ranges) {
  if (!node.voxel.filled()) return;
  const TileRange range = Project(low, level);
  if (range.empty()) return;
  if (node.leaf() || level == cut) {
    const OctreeCube cube{
        node, {static_cast<double>(low.x), static_cast<double>(low.y), static_cast<double>(low.z)}, level};
    cubes_.push_back(Turned(cube, descends_));
    ranges->push_back(range);
    return;
  }
  const OctreeNode* const children = model_.Children(node);
  const int half = 1 << (level - 1);
  for (unsigned i = 0; i < 8; ++i) {
    const unsigned child = i ^ descends_;
    Collect(children[child],
            {low.x + (child & 1 ? half : 0), low.y + (child & 2 ? half : 0), low.z + (child & 4 ? half : 0)},
            level - 1, cut, ranges);
  }
}

OctreeView::TileRange OctreeView::Project(VoxelPoint low, int level) const {
  const CameraFrame& frame = camera_.frame;
  const double half = 0.5 * (1 << level);
  const Vec3 center{low.x + half, low.y + half, low.z + half};
  // The interval of the cube along a direction of the camera.
  struct Interval {
    double low, high;
  };
  const auto along = [&](const Direction& d) {
    const double at = d.at + Dot(center, d.step), reach = half * d.reach + margin_;
    return Interval{at - reach, at + reach};
  };
  Interval x = along(right_), y = along(down_);
  if (frame.projection == Projection::kPerspective) {
    const Interval depth = along(forward_);
    if (depth.high < frame.near_mm) return {0, -1, 0, -1};
    if (depth.low <= margin_) return {0, columns_ - 1, 0, rows_ - 1};
    const auto divide = [&](Interval i) {
      return Interval{i.low / (i.low < 0 ? depth.low : depth.high),
                      i.high / (i.high < 0 ? depth.high : depth.low)};
    };
    x = divide(x);
    y = divide(y);
  }
  const auto tiles = [](double begin, double end, int pixels, int* first, int* last) {
    // A millionth of a pixel covers the rounding of pixel coordinates.
    begin = std::max(begin - 1e-6, 0.0);
    end = std::min(end + 1e-6, static_cast<double>(pixels - 1));
    *first = begin < pixels ? static_cast<int>(begin) / kTile : pixels;
    *last = end >= 0 ? static_cast<int>(end) / kTile : -1;
  };
  TileRange range;
  tiles(x.low / frame.pixel_x + frame.center_x, x.high / frame.pixel_x + frame.center_x, camera_.width_px,
        &range.first_column, &range.last_column);
  tiles(y.low / frame.pixel_y + frame.center_y, y.high / frame.pixel_y + frame.center_y, camera_.height_px,
        &range.first_row, &range.last_row);
  return range;
}

void OctreeView::FillLists(const std::vector<TileRange>& ranges) {
  const std::size_t tiles = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  const auto visit = [&](const auto& with) {
    for (std::size_t cube = 0; cube < ranges.size(); ++cube)
      for (int row = ranges[cube].first_row; row <= ranges[cube].last_row; ++row)
        for (int column = ranges[cube].first_column; column <= ranges[cube].last_column; ++column)
          with(cube, static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                         static_cast<std::size_t>(column));
  };
  first_.assign(tiles + 1, 0);
  visit([&](std::size_t, std::size_t tile) { ++first_[tile + 1]; });
  for (std::size_t tile = 0; tile < tiles; ++tile) first_[tile + 1] += first_[tile];
  lists_.resize(first_[tiles]);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  visit([&](std::size_t cube, std::size_t tile) { lists_[next[tile]++] = static_cast<std::uint32_t>(cube); });
}

void OctreeView::OrderLists() {
  octants_.assign(first_.size() - 1, static_cast<std::uint8_t>(descends_));
  if (camera_.frame.projection == Projection::kOrthographic) return;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const std::size_t tile = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                               static_cast<std::size_t>(column);
      const Vec3 d = PixelRay(camera_.frame, (column + 0.5) * kTile, (row + 0.5) * kTile).direction;
      const unsigned descends = unsigned{d.x < 0} | unsigned{d.y < 0} << 1 | unsigned{d.z < 0} << 2;
      if (descends == descends_) continue;
      octants_[tile] = static_cast<std::uint8_t>(descends);
      const unsigned turned = descends ^ descends_;
      std::sort(lists_.begin() + first_[tile], lists_.begin() + first_[tile + 1],
                [&](std::uint32_t a, std::uint32_t b) {
                  return Precedes(Turned(cubes_[a], turned), Turned(cubes_[b], turned));
                });
    }
}

VoxelHit OctreeView::Walk(int column, int row, const VoxelRay& ray, const WalkOptions& options,
                          WalkCounters* counters) const {
  ++counters->rays;
  const AscendingRay up = ray.Ascending();
  const std::size_t tile = TileOf(column, row);
  // An axis without a component may count as descending or not (law 3).
  const unsigned still =
      unsigned{ray.sign(0) == 0} | unsigned{ray.sign(1) == 0} << 1 | unsigned{ray.sign(2) == 0} << 2;
  if (((up.descends ^ octants_[tile]) & ~still) != 0)
    return Descend(model_, RootCube(model_, up), ray, up, ray.t_first(), ray.t_last(), options, counters);
  const unsigned turned = up.descends ^ descends_;
  for (std::uint32_t i = first_[tile]; i < first_[tile + 1]; ++i) {
    const OctreeCube& stored = cubes_[lists_[i]];
    const OctreeCube other = turned == 0 ? OctreeCube{} : Turned(stored, turned);
    const OctreeCube& cube = turned == 0 ? stored : other;
    const double edge = 1 << cube.level;
    double t = ray.t_first(), t_out = ray.t_last();
    for (int axis = 0; axis < 3; ++axis) {
      t = std::max(t, up.Pass(axis, cube.low[axis]));
      t_out = std::min(t_out, up.Pass(axis, cube.low[axis] + edge));
    }
    ++counters->nodes;
    if (!(t < t_out)) continue;
    const VoxelHit hit = Descend(model_, cube, ray, up, t, t_out, options, counters);
    if (hit.hit()) return hit;
  }
  return {};
}

std::uint64_t OctreeView::bytes() const {
  return cubes_.capacity() * sizeof(OctreeCube) + octants_.capacity() +
         (first_.capacity() + lists_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace facetless
