// Fuzz target: voxel files of all formats, and pictures of slices. A file that can be read is walked through, encoded in all ways, and counted.
#include <cstring>
#include <vector>

#include "render/image/slice_pictures.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_file.h"
#include "render/voxel_walks/voxel_walk.h"
#include "render/voxels/octree_model.h"
#include "tests/verify/fuzz/target.h"

namespace facetless {
namespace {

// Gives an octree's file the length and the checksum of its tree, so that mutants reach the reader of trees.
void Seal(std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kLengthAt = 56, kTreeAt = 72;
  if (bytes.size() < kTreeAt || std::memcmp(bytes.data(), "FLVXOCT\n", 8) != 0) return;
  const std::uint64_t numbers[2] = {bytes.size() - kTreeAt, Checksum(std::span(bytes).subspan(kTreeAt))};
  std::memcpy(bytes.data() + kLengthAt, numbers, sizeof numbers);
}

}  // namespace
}  // namespace facetless

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace facetless;
  static const InputFile file;
  constexpr std::uint64_t kMemory = 1 << 20;
  std::vector<std::uint8_t> bytes(data, data + size);
  Seal(bytes);
  const std::string path = file.Write(bytes.data(), bytes.size());
  if (const Result<Image8> slice = ReadPngSlice(path, 0, kMemory); slice.ok())
    Require(slice.value().bytes.size() == std::size_t(slice.value().width) * slice.value().height * 4);
  for (const VoxelFormat& format : VoxelFormats()) {
    const Result<VoxelFile> read = format.read(path, {.max_bytes = kMemory});
    if (!read.ok()) continue;
    const VoxelModel& model = *read.value().model;
    // Wide models of few voxels take long to encode.
    if (model.box().volume() > kMemory) continue;
    const auto octree = Converted(model, "octree", kMemory * 64);
    Require(octree.ok() && SameVoxels(model, *octree.value()) && octree.value()->Count() == model.Count());
    VoxelRay ray;
    if (!ray.Enter({-1, 0.5, 0.5}, {1, 0.25, 0.125}, 0, model.size())) continue;
    WalkCounters counters;
    const auto walk = BindVoxelWalk(*octree.value(), "");
    Require(walk.ok());
    const VoxelHit hit = walk.value()->Walk(ray, {}, &counters);
    Require(!hit.hit() || model.Get(hit.at.x, hit.at.y, hit.at.z) == hit.voxel);
  }
  return 0;
}
