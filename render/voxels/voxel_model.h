// Voxel models: a box of cubes that are empty or filled, in several encodings behind one interface.
//
//     std::unique_ptr<VoxelModel> model = MakeVoxelModel("octree", {512, 512, 300});
//     model->Fill({{0, 0, 0}, {512, 512, 1}}, Voxel::Of(200, 40, 40));
//     if (model->Get(3, 4, 0).filled()) ...
//
//  1. The voxel (x, y, z) is the cube [x, x+1) × [y, y+1) × [z, z+1) in the coordinates of the model, with
//     0 ≤ x < size.x and so on. VoxelGrid (voxel_grid.h) places these coordinates in millimetres.
//  2. All encodings hold the same models: converting from any of them to any other, and back, changes no voxel.
//  3. A level of detail l stands for the cubes of 2^l voxels on a side, aligned to multiples of 2^l. The voxel of such a
//     cube has the mean colour of its filled voxels, and `share` says which part of its 8^l voxels is filled. The mean is
//     that of the means of the eight cubes of level l − 1, weighted by their filled voxels, and is rounded on each level.
//  4. The interface serves edits, conversions and single questions. Rays walk through the encodings themselves
//     (voxel_walk.h), without a virtual call for each step.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "render/base/result.h"

namespace facetless {

// An empty voxel is 0. A filled one has a colour in its low 24 bits (sRGB, red lowest), and in its high 8 bits a
// material, 1 … 255.
struct Voxel {
  std::uint32_t bits = 0;

  static constexpr Voxel Of(std::uint8_t red, std::uint8_t green, std::uint8_t blue,
                            std::uint8_t material = 1) {
    return {std::uint32_t{red} | std::uint32_t{green} << 8 | std::uint32_t{blue} << 16 |
            std::uint32_t{material} << 24};
  }
  constexpr bool filled() const { return bits != 0; }
  constexpr std::uint8_t red() const { return static_cast<std::uint8_t>(bits); }
  constexpr std::uint8_t green() const { return static_cast<std::uint8_t>(bits >> 8); }
  constexpr std::uint8_t blue() const { return static_cast<std::uint8_t>(bits >> 16); }
  constexpr std::uint8_t material() const { return static_cast<std::uint8_t>(bits >> 24); }
  constexpr bool operator==(const Voxel&) const = default;
};

struct VoxelPoint {
  int x = 0, y = 0, z = 0;
  constexpr bool operator==(const VoxelPoint&) const = default;
};

// The largest number of voxels along an axis.
inline constexpr int kMostVoxelsPerAxis = 1 << 16;

// The voxels low ≤ (x, y, z) < high.
struct VoxelBox {
  VoxelPoint low, high;
  bool empty() const { return low.x >= high.x || low.y >= high.y || low.z >= high.z; }
  std::uint64_t volume() const {
    return empty() ? 0
                   : std::uint64_t(high.x - low.x) * std::uint64_t(high.y - low.y) *
                         std::uint64_t(high.z - low.z);
  }
  bool Holds(VoxelPoint p) const {
    return p.x >= low.x && p.x < high.x && p.y >= low.y && p.y < high.y && p.z >= low.z && p.z < high.z;
  }
};
VoxelBox Intersection(const VoxelBox& a, const VoxelBox& b);

// The mean of the voxels of a cube.
struct VoxelMean {
  Voxel
      voxel;  // the mean colour, and the material of the filled voxel that comes first; empty if none is filled
  double share = 0;  // of the cube's voxels that are filled, 0 … 1
};

// Voxels of one column with the same value: z_begin ≤ z < z_end.
struct VoxelRun {
  int z_begin = 0, z_end = 0;
  Voxel voxel;
  bool operator==(const VoxelRun&) const = default;
};

class VoxelModel {
 public:
  virtual ~VoxelModel() = default;

  virtual std::string_view encoding() const = 0;  // a name of VoxelEncodings()
  VoxelPoint size() const { return size_; }
  VoxelBox box() const { return {{0, 0, 0}, size_}; }

  // Outside the model, all voxels are empty.
  virtual Voxel Get(int x, int y, int z) const = 0;
  // The mean of the cube of level `level` that holds the voxel (law 3); empty if the voxel lies outside the model. Cubes are
  // not clipped to the model. The level must be 0 … 16. This implementation computes the mean from the voxels.
  virtual VoxelMean GetMean(int x, int y, int z, int level) const;
  // Calls visit for the filled runs of the column (x, y), in ascending order, each as long as possible.
  virtual void VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const = 0;

  // Edits. Voxels outside the model are ignored.
  virtual void Fill(const VoxelBox& box, Voxel voxel) = 0;
  void Set(int x, int y, int z, Voxel voxel) { Fill({{x, y, z}, {x + 1, y + 1, z + 1}}, voxel); }
  // Replaces the whole column. The runs must be ascending and must not overlap.
  virtual void SetColumn(int x, int y, std::span<const VoxelRun> runs) = 0;
  // Copies the voxels of `from` in `box`, empty ones included, so that box.low comes to lie at `at`.
  void Copy(const VoxelModel& from, const VoxelBox& box, VoxelPoint at);

  virtual std::uint64_t Count() const;      // filled voxels
  virtual std::uint64_t bytes() const = 0;  // memory

 protected:
  explicit VoxelModel(VoxelPoint size) : size_(size) {}

 private:
  VoxelPoint size_;
};

// An encoding by name.
struct VoxelEncoding {
  std::string_view name;
  std::string_view description;  // one sentence
};
// raw, runs, octree, adaptive-octree, n3-tree.
std::span<const VoxelEncoding> VoxelEncodings();

// Makes an empty model. Errors: kBadUsage (no encoding has that name; a size is not 1 … kMostVoxelsPerAxis),
// kLimitExceeded (the encoding needs more than `max_bytes` even when it is empty).
Result<std::unique_ptr<VoxelModel>> MakeVoxelModel(std::string_view encoding, VoxelPoint size,
                                                   std::uint64_t max_bytes = std::uint64_t{16} << 30);

// The same voxels in another encoding. Errors: those of MakeVoxelModel.
Result<std::unique_ptr<VoxelModel>> Converted(const VoxelModel& model, std::string_view encoding,
                                              std::uint64_t max_bytes = std::uint64_t{16} << 30);

// Whether two models hold the same voxels.
bool SameVoxels(const VoxelModel& a, const VoxelModel& b);

}  // namespace facetless
