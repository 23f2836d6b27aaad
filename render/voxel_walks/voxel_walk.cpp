#include "render/voxel_walks/voxel_walk.h"

#include <charconv>

#include "render/voxel_walks/walks.h"

namespace facetless {
namespace {

constexpr NamedVoxelWalk kWalks[] = {
    {.name = "grid",
     .description = "Passes all voxels along the ray, one by one.",
     .encoding = "raw",
     .bind = BindGrid},
    {.name = "bresenham",
     .description = "Advances one voxel along the longest component, and misses some voxels between.",
     .encoding = "raw",
     .exact = false,
     .bind = BindBresenham},
    {.name = "columns",
     .description = "Passes the columns along the ray, and looks for the next run in each.",
     .encoding = "runs",
     .bind = BindColumns},
    {.name = "descent",
     .description =
         "Goes down to the leaf that holds the ray, and up as far as the ray leaves nodes; planes of a "
         "node are computed once.",
     .encoding = "octree",
     .levels = true,
     .bind = BindDescent},
    {.name = "kd-restart",
     .description = "Finds each next leaf from the root.",
     .encoding = "octree",
     .levels = true,
     .bind = BindKdRestart},
    {.name = "kd-restart-sorted",
     .description = "The same; the side through which a ray leaves a cube is tried in the order of the "
                    "direction's components.",
     .encoding = "octree",
     .levels = true,
     .bind = BindKdRestartSorted},
    {.name = "kd-backtrack",
     .description = "Finds each next leaf from the last node on the path that still holds the ray.",
     .encoding = "octree",
     .levels = true,
     .bind = BindKdBacktrack},
    {.name = "kd-shortstack",
     .description =
         "The same with the lowest K nodes of the path; if none of them holds the ray, from the root.",
     .encoding = "octree",
     .levels = true,
     .setting = "nodes that are kept",
     .usual = 4,
     .most = kMostShortstack,
     .bind = BindKdShortstack},
    {.name = "neighbours",
     .description = "Goes from leaf to leaf by links through their sides, which take memory of their own.",
     .encoding = "octree",
     .levels = true,
     .bind = BindNeighbours},
    {.name = "adaptive",
     .description = "Passes leaves of the tree, and all voxels of its bricks.",
     .encoding = "adaptive-octree",
     .levels = true,
     .bind = BindAdaptive},
    {.name = "bricks",
     .description =
         "Passes leaves of the tree, and all voxels of its bricks, or the cubes of their mip maps.",
     .encoding = "n3-tree",
     .levels = true,
     .bind = BindN3},
};

Error NoSuchWalk(std::string_view name) {
  std::string names;
  for (const NamedVoxelWalk& walk : kWalks) names += (names.empty() ? "" : ", ") + std::string(walk.name);
  return {ErrorCode::kBadUsage,
          "there is no walk through voxels '" + std::string(name) + "'; there are: " + names};
}

// The number after the name of a walk.
Result<int> SettingOf(const NamedVoxelWalk& walk, std::string_view text) {
  int setting = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), setting);
  const std::string name(walk.name);
  if (walk.setting.empty())
    return Error{ErrorCode::kBadUsage,
                 "the walk " + name + " has no setting; leave out ':" + std::string(text) + "'"};
  if (error != std::errc{} || end != text.data() + text.size() || setting < 1 || setting > walk.most)
    return Error{ErrorCode::kBadUsage, "the walk " + name + " takes a whole number from 1 to " +
                                           std::to_string(walk.most) + " (" + std::string(walk.setting) +
                                           "), not '" + std::string(text) + "'"};
  return setting;
}

}  // namespace

std::span<const NamedVoxelWalk> VoxelWalks() {
  return kWalks;
}

Result<const NamedVoxelWalk*> FindVoxelWalk(std::string_view name) {
  for (const NamedVoxelWalk& walk : kWalks)
    if (walk.name == name) return &walk;
  return NoSuchWalk(name);
}

const NamedVoxelWalk& UsualVoxelWalk(std::string_view encoding) {
  for (const NamedVoxelWalk& walk : kWalks)
    if (walk.encoding == encoding) return walk;
  return kWalks[0];
}

Result<std::unique_ptr<const BoundWalk>> BindVoxelWalk(const VoxelModel& model, std::string_view text) {
  if (text.empty()) text = UsualVoxelWalk(model.encoding()).name;
  const std::size_t colon = text.find(':');
  const Result<const NamedVoxelWalk*> found = FindVoxelWalk(text.substr(0, colon));
  if (!found) return found.error();
  const NamedVoxelWalk& walk = *found.value();
  int setting = walk.usual;
  if (colon != std::string_view::npos) {
    const Result<int> given = SettingOf(walk, text.substr(colon + 1));
    if (!given) return given.error();
    setting = given.value();
  }
  if (walk.encoding != model.encoding())
    return Error{ErrorCode::kBadUsage, "the walk " + std::string(walk.name) + " takes voxels encoded as " +
                                           std::string(walk.encoding) + ", not as " +
                                           std::string(model.encoding())};
  return walk.bind(model, setting);
}

}  // namespace facetless
