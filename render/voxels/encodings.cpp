#include "render/voxels/encodings.h"

#include <string>
#include <utility>

#include "render/voxels/adaptive_octree_model.h"
#include "render/voxels/n3_tree_model.h"
#include "render/voxels/octree_model.h"
#include "render/voxels/raw_model.h"
#include "render/voxels/run_model.h"

namespace facetless {
namespace {

struct Row {
  VoxelEncoding encoding;
  std::unique_ptr<VoxelModel> (*make)(const RunModel& runs);
  std::uint64_t (*least_bytes)(VoxelPoint size);  // of an empty model
};

template <typename Model>
std::unique_ptr<VoxelModel> Make(const RunModel& runs) {
  return std::make_unique<Model>(runs);
}

constexpr Row kRows[] = {
    {{"raw", "Every voxel, 4 bytes each."}, Make<RawModel>, RawModel::BytesOf},
    {{"runs", "The runs of equal voxels in each column."},
     Make<RunModel>,
     [](VoxelPoint size) {
       return 4 * static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
     }},
    {{"octree", "Cubes that are halved along each axis, with mean colours."},
     Make<OctreeModel>,
     [](VoxelPoint) { return std::uint64_t{0}; }},
    {{"adaptive-octree", "An octree in which a raw brick replaces each subtree that is no smaller."},
     Make<AdaptiveOctreeModel>,
     [](VoxelPoint) { return std::uint64_t{0}; }},
    {{"n3-tree", "Nodes of 4×4×4 children over bricks of 8×8×8 voxels with mip maps."},
     [](const RunModel& runs) -> std::unique_ptr<VoxelModel> { return std::make_unique<N3TreeModel>(runs); },
     [](VoxelPoint) { return std::uint64_t{0}; }},
};

Result<const Row*> FindRow(std::string_view name, VoxelPoint size, std::uint64_t max_bytes) {
  std::string names;
  for (const Row& row : kRows) {
    if (row.encoding.name != name) {
      names += (names.empty() ? "" : ", ") + std::string(row.encoding.name);
      continue;
    }
    for (const int n : {size.x, size.y, size.z})
      if (n < 1 || n > kMostVoxelsPerAxis)
        return Error{ErrorCode::kBadUsage, "a voxel model has 1 to " + std::to_string(kMostVoxelsPerAxis) +
                                               " voxels along each axis, not " + std::to_string(n)};
    if (row.least_bytes(size) > max_bytes)
      return Error{ErrorCode::kLimitExceeded,
                   std::to_string(size.x) + " × " + std::to_string(size.y) + " × " + std::to_string(size.z) +
                       " voxels as " + std::string(name) + " need more than " +
                       std::to_string(max_bytes >> 20) + " MB; use another encoding, or fewer voxels"};
    return &row;
  }
  return Error{ErrorCode::kBadUsage,
               "there is no encoding of voxels '" + std::string(name) + "'; there are: " + names};
}

}  // namespace

std::span<const VoxelEncoding> VoxelEncodings() {
  static const std::vector<VoxelEncoding> encodings = [] {
    std::vector<VoxelEncoding> all;
    for (const Row& row : kRows) all.push_back(row.encoding);
    return all;
  }();
  return encodings;
}

Result<std::unique_ptr<VoxelModel>> MakeVoxelModel(std::string_view encoding, VoxelPoint size,
                                                   std::uint64_t max_bytes) {
  const Result<const Row*> row = FindRow(encoding, size, max_bytes);
  if (!row.ok()) return row.error();
  return row.value()->make(RunModel(size));
}

Result<std::unique_ptr<VoxelModel>> Converted(const VoxelModel& model, std::string_view encoding,
                                              std::uint64_t max_bytes) {
  const Result<const Row*> row = FindRow(encoding, model.size(), max_bytes);
  if (!row.ok()) return row.error();
  if (const auto* runs = dynamic_cast<const RunModel*>(&model)) return row.value()->make(*runs);
  return row.value()->make(RunsOf(model));
}

}  // namespace facetless
