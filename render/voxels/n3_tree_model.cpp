#include "render/voxels/n3_tree_model.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace facetless {
namespace {

int Logarithm(int power_of_two) {
  return std::countr_zero(static_cast<unsigned>(power_of_two));
}

}  // namespace

N3TreeModel::N3TreeModel(VoxelPoint size, int n, int m)
    : RebuiltModel(size), n_level_(Logarithm(n)), m_level_(Logarithm(m)), level_(m_level_) {
  while (level_ < LevelOf(size)) level_ += n_level_;
  brick_size_ = MipBegin(m_level_ + 1);
}

N3TreeModel::N3TreeModel(const RunModel& runs, int n, int m) : N3TreeModel(runs.size(), n, m) {
  Compile(runs);
}

std::size_t N3TreeModel::MipBegin(int level) const {
  std::size_t begin = 0;
  for (int l = 0; l < level; ++l) begin += std::size_t{1} << (3 * (m_level_ - l));
  return begin;
}

void N3TreeModel::Compile(const RunModel& runs) {
  nodes_.clear();
  voxels_.clear();
  root_ = Compile(runs, {{0, 0, 0}, level_}).node;
}

N3TreeModel::Subtree N3TreeModel::Compile(const RunModel& runs, const VoxelCube& cube) {
  if (const std::optional<Voxel> uniform = runs.Uniform(cube.box()))
    return {{*uniform, 0}, uniform->filled() ? cube.volume() : 0};
  if (cube.level == m_level_) return CompileBrick(runs, cube);
  const int n = 1 << n_level_, edge = cube.edge() / n;
  const std::size_t first = nodes_.size();
  nodes_.resize(first + static_cast<std::size_t>(n * n * n));
  std::vector<std::uint64_t> filled(static_cast<std::size_t>(n * n * n));
  for (int child = 0; child < n * n * n; ++child) {
    const VoxelPoint low{cube.low.x + child % n * edge, cube.low.y + child / n % n * edge,
                         cube.low.z + child / (n * n) * edge};
    const Subtree below = Compile(runs, {low, cube.level - n_level_});
    nodes_[first + static_cast<std::size_t>(child)] = below.node;
    filled[static_cast<std::size_t>(child)] = below.filled;
  }
  // A mean is that of the means of the next lower level (voxel_model.h, law 3), so the children are joined in cubes of
  // 2×2×2 until one is left.
  std::vector<std::pair<Voxel, std::uint64_t>> cubes;
  for (std::size_t child = 0; child < filled.size(); ++child)
    cubes.emplace_back(nodes_[first + child].voxel, filled[child]);
  for (int side = n; side > 1; side /= 2) {
    const int half = side / 2;
    std::vector<std::pair<Voxel, std::uint64_t>> joined;
    for (int z = 0; z < half; ++z)
      for (int y = 0; y < half; ++y)
        for (int x = 0; x < half; ++x) {
          MeanOfVoxels mean;
          for (int k = 0; k < 8; ++k) {
            const auto& [voxel, count] = cubes[static_cast<std::size_t>(
                ((2 * z + (k >> 2 & 1)) * side + 2 * y + (k >> 1 & 1)) * side + 2 * x + (k & 1))];
            mean.Add(voxel, count);
          }
          joined.emplace_back(mean.Get(), mean.filled());
        }
    cubes = std::move(joined);
  }
  return {{cubes[0].first, static_cast<std::uint32_t>(first) + 1}, cubes[0].second};
}

N3TreeModel::Subtree N3TreeModel::CompileBrick(const RunModel& runs, const VoxelCube& cube) {
  const std::size_t first = voxels_.size(), index = first / BrickSize();
  voxels_.resize(first + BrickSize());
  const VoxelBox inside = Intersection(cube.box(), runs.box());
  const int m = cube.edge();
  std::vector<std::uint64_t> filled(static_cast<std::size_t>(m * m * m));
  const auto place = [](int x, int y, int z, int side) {
    return static_cast<std::size_t>((z * side + y) * side + x);
  };
  for (int x = inside.low.x; x < inside.high.x; ++x)
    for (int y = inside.low.y; y < inside.high.y; ++y)
      for (const VoxelRun& run : runs.Column(x, y))
        for (int z = std::max(run.z_begin, inside.low.z); z < std::min(run.z_end, inside.high.z); ++z) {
          const std::size_t at = place(x - cube.low.x, y - cube.low.y, z - cube.low.z, m);
          voxels_[first + at] = run.voxel;
          filled[at] = 1;
        }
  // Each mip map is made of the one before.
  for (int level = 1; level <= m_level_; ++level) {
    const int side = m >> level, finer = 2 * side;
    const std::size_t from = first + MipBegin(level - 1), to = first + MipBegin(level);
    std::vector<std::uint64_t> counts(static_cast<std::size_t>(side * side * side));
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          MeanOfVoxels mean;
          for (int k = 0; k < 8; ++k) {
            const std::size_t at = place(2 * x + (k & 1), 2 * y + (k >> 1 & 1), 2 * z + (k >> 2 & 1), finer);
            mean.Add(voxels_[from + at], filled[at]);
          }
          voxels_[to + place(x, y, z, side)] = mean.Get();
          counts[place(x, y, z, side)] = mean.filled();
        }
    filled = std::move(counts);
  }
  return {{voxels_[first + BrickSize() - 1], static_cast<std::uint32_t>(index) + 1}, filled[0]};
}

N3TreeModel::Found N3TreeModel::Find(VoxelPoint p, int level) const {
  Found found{root_, level_};
  const int n = 1 << n_level_;
  while (!found.node.leaf() && found.level > std::max(level, m_level_)) {
    found.level -= n_level_;
    const auto digit = [&](int at) { return (at >> found.level) & (n - 1); };
    found.node = nodes_[found.node.content - 1 +
                        static_cast<std::size_t>((digit(p.z) * n + digit(p.y)) * n + digit(p.x))];
  }
  return found;
}

Voxel N3TreeModel::InBrick(const N3Node& node, VoxelPoint p, int level) const {
  const int side = 1 << (m_level_ - level), mask = (1 << m_level_) - 1;
  const int x = (p.x & mask) >> level, y = (p.y & mask) >> level, z = (p.z & mask) >> level;
  return voxels_[static_cast<std::size_t>(node.content - 1) * BrickSize() + MipBegin(level) +
                 static_cast<std::size_t>((z * side + y) * side + x)];
}

Voxel N3TreeModel::Get(int x, int y, int z) const {
  if (!box().Holds({x, y, z})) return {};
  const Found found = Find({x, y, z}, 0);
  return found.node.leaf() ? found.node.voxel : InBrick(found.node, {x, y, z}, 0);
}

VoxelMean N3TreeModel::GetMean(int x, int y, int z, int level) const {
  VoxelMean mean = VoxelModel::GetMean(x, y, z, level);
  // The colour is stored; the share is counted.
  if (!box().Holds({x, y, z}) || level > level_) return mean;
  const Found found = Find({x, y, z}, level);
  if ((found.node.leaf() && found.level >= level) || found.level == level) {
    mean.voxel = found.node.voxel;
  } else if (found.level == m_level_ && level <= m_level_) {
    mean.voxel = InBrick(found.node, {x, y, z}, level);
  }
  return mean;
}

void N3TreeModel::VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const {
  if (x < 0 || y < 0 || x >= size().x || y >= size().y) return;
  VisitLeaves(
      size().z,
      [&](int z) {
        const Found found = Find({x, y, z}, 0);
        return found.node.leaf() ? std::pair(found.node.voxel, ((z >> found.level) + 1) << found.level)
                                 : std::pair(InBrick(found.node, {x, y, z}, 0), z + 1);
      },
      visit);
}

std::uint64_t N3TreeModel::bytes() const {
  return nodes_.capacity() * sizeof(N3Node) + voxels_.capacity() * sizeof(Voxel);
}

}  // namespace facetless
