#include "render/voxel_walks/voxel_normal.h"

#include <array>

#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

constexpr int kSide = 2 * kNormalReach + 1;

struct Sum {
  int x = 0, y = 0, z = 0;
};

// offset / |offset|², for all offsets, times the least common multiple of the squares.
constexpr std::array<Sum, kSide* kSide* kSide> kWeights = [] {
  static_assert(kNormalReach == 2);
  constexpr int kMultiple = 360;  // of 1, 2, 3, 4, 5, 6, 8, 9 and 12
  std::array<Sum, kSide * kSide * kSide> weights{};
  for (int x = 0; x < kSide; ++x)
    for (int y = 0; y < kSide; ++y)
      for (int z = 0; z < kSide; ++z) {
        const int dx = x - kNormalReach, dy = y - kNormalReach, dz = z - kNormalReach;
        const int square = dx * dx + dy * dy + dz * dz;
        if (square == 0) continue;
        const int factor = kMultiple / square;
        weights[static_cast<std::size_t>((x * kSide + y) * kSide + z)] = {factor * dx, factor * dy,
                                                                          factor * dz};
      }
  return weights;
}();

// Adds the weights of the cubes of `region`, which lies around the cube `at`.
void Add(const VoxelBox& region, VoxelPoint at, Sum* sum) {
  for (int x = region.low.x - at.x; x < region.high.x - at.x; ++x)
    for (int y = region.low.y - at.y; y < region.high.y - at.y; ++y)
      for (int z = region.low.z - at.z; z < region.high.z - at.z; ++z) {
        const Sum& weight = kWeights[static_cast<std::size_t>(
            ((x + kNormalReach) * kSide + y + kNormalReach) * kSide + z + kNormalReach)];
        sum->x += weight.x;
        sum->y += weight.y;
        sum->z += weight.z;
      }
}

// The filled cubes of a level in an octree, a node at a time. Coordinates count cubes of that level.
struct FilledNodes {
  const OctreeModel& model;
  VoxelBox around;
  VoxelPoint at;
  Sum sum = {};

  void Visit(const OctreeNode& node, const VoxelCube& cube) {
    if (!node.voxel.filled()) return;
    const auto later = [](int a, int b) { return a > b ? a : b; };
    const auto sooner = [](int a, int b) { return a < b ? a : b; };
    const int edge = cube.edge();
    const VoxelBox inside{
        {later(cube.low.x, around.low.x), later(cube.low.y, around.low.y), later(cube.low.z, around.low.z)},
        {sooner(cube.low.x + edge, around.high.x), sooner(cube.low.y + edge, around.high.y),
         sooner(cube.low.z + edge, around.high.z)}};
    if (inside.empty()) return;
    if (node.leaf() || cube.level == 0) {
      Add(inside, at, &sum);
      return;
    }
    const OctreeNode* const children = model.Children(node);
    for (int child = 0; child < 8; ++child) Visit(children[child], cube.Child(child));
  }
};

// The sum of the weights of the filled cubes around a cube of a level.
Sum SumOfFilled(const VoxelModel& model, VoxelPoint at, int level) {
  const VoxelBox around{{at.x - kNormalReach, at.y - kNormalReach, at.z - kNormalReach},
                        {at.x + kNormalReach + 1, at.y + kNormalReach + 1, at.z + kNormalReach + 1}};
  if (const auto* octree = dynamic_cast<const OctreeModel*>(&model)) {
    FilledNodes filled{*octree, around, at};
    filled.Visit(octree->root(), {{0, 0, 0}, octree->level() - level});
    return filled.sum;
  }
  Sum sum;
  for (int x = around.low.x; x < around.high.x; ++x)
    for (int y = around.low.y; y < around.high.y; ++y)
      for (int z = around.low.z; z < around.high.z; ++z)
        if (level == 0 ? model.Get(x, y, z).filled()
                       : model.GetMean(x << level, y << level, z << level, level).voxel.filled())
          Add({{x, y, z}, {x + 1, y + 1, z + 1}}, at, &sum);
  return sum;
}

// The normal that the sum of empty cubes says, or that of the side.
Vec3 NormalOf(Vec3 sum, const VoxelHit& hit, Vec3 direction) {
  // At a plane across an axis, the sum of the weights on one side of it has this length.
  constexpr double kPlane = 4964, kLeast = kPlane / 5;
  const Vec3 side = SideNormal(hit, direction);
  const bool clear = Dot(sum, sum) > kLeast * kLeast && Dot(sum, direction) < 0 && Dot(sum, side) > 0;
  return clear ? Normalized(sum) : side;
}

}  // namespace

Vec3 GridNormal(const VoxelModel& model, const VoxelHit& hit, Vec3 direction, NormalMemory* memory) {
  const VoxelPoint at{hit.at.x >> hit.level, hit.at.y >> hit.level, hit.at.z >> hit.level};
  if (memory == nullptr || !(memory->at == at) || memory->level != hit.level) {
    const Sum sum = SumOfFilled(model, at, hit.level);
    // All weights together are zero, so that the sum of the empty cubes is that of the filled ones, negated.
    const NormalMemory found{
        at,
        hit.level,
        {-static_cast<double>(sum.x), -static_cast<double>(sum.y), -static_cast<double>(sum.z)}};
    if (memory == nullptr) return NormalOf(found.sum, hit, direction);
    *memory = found;
  }
  return NormalOf(memory->sum, hit, direction);
}

Vec3 SideNormal(const VoxelHit& hit, Vec3 direction) {
  if (hit.side < 0) return -Normalized(direction);
  Vec3 normal{0, 0, 0};
  double Vec3::*const axes[] = {&Vec3::x, &Vec3::y, &Vec3::z};
  normal.*axes[hit.side] = direction.*axes[hit.side] > 0 ? -1 : 1;
  return normal;
}

}  // namespace facetless
