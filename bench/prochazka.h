// Tables 1 to 6 of P. Procházka, "Optimalizace vykreslování voxelové grafiky" (2013), on models of our own: sizes of encodings,
// nodes of octrees, and frames per second of kd-restart, kd-backtrack and kd-shortstack, without and with a light. Beside them,
// the rays per second of all walks.
//
//     std::vector<VoxelBench> models = {MeasureVoxels(CubeOfThesis(), options).value()};
//     for (Table& table : VoxelTables(models)) ...
//
//  1. The frames are those of a camera path that flies around the model, closer with each frame, and ends inside its box. They
//     have kFrameWidth × kFrameHeight pixels and, as in the thesis, a horizontal field of view of 90 degrees, no levels of
//     detail, ambient light alone or with one light that casts shadows, and as many threads as the run has. kd-shortstack has
//     half the height of the tree, as in the thesis's program.
//  2. The walks are compared on one thread, with the primary rays of the orthographic view iso at kRaySize² pixels. A rate
//     counts all pixels of the picture; the time includes making the rays, and the lists of tiles where there are any.
//  3. Competitors take turns, and the median counts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"
#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/voxel_walks/voxel_walk.h"
#include "render/voxels/run_model.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

inline constexpr int kFrameWidth = 640, kFrameHeight = 480, kFrames = 16, kRaySize = 512;

struct VoxelBenchModel {
  std::string name;
  RunModel voxels;
  VoxelGrid grid;
};

// The thesis's simplest model: one leaf on the second level of a tree over 1024³ voxels.
VoxelBenchModel CubeOfThesis();

struct EncodingSize {
  std::string encoding;
  double bytes = 0;
};

// How far the hits of a walk that is not exact are from the exact ones, over all pixels that either of them hits.
struct WalkDistortion {
  double other_voxel = 0;  // share of pixels with another voxel, or with a hit of only one of the two
  double mean_depth = 0, most_depth = 0;  // between both hits, in voxels
};

struct WalkFigures {
  std::string walk;
  double rays_per_second = 0;
  double side_bytes = 0;
  std::uint64_t pixels_hit = 0;
  WalkCounters counters;
  std::optional<WalkDistortion> distortion = {};
};

// Frames of the camera path by one walk.
struct PathFigures {
  std::string walk;
  double fps = 0, fps_light = 0;
  double worst_ms = 0, best_ms = 0;  // without the light
  WalkCounters primary, shadow;      // of all frames with the light
};

struct VoxelBench {
  std::string name;
  VoxelPoint size;
  std::uint64_t filled = 0;
  std::vector<EncodingSize> sizes;
  std::uint64_t nodes = 0, leaves = 0, filled_leaves = 0;  // of the octree; leaves include empty ones
  std::vector<WalkFigures> walks;
  std::vector<PathFigures> paths;  // kd-restart, kd-backtrack, kd-shortstack
};

struct VoxelBenchOptions {
  int repeats = 3;
  int divisor = 1;  // of the pictures' sizes; tests take small pictures
  Execution execution = {};
};

// Encodings of more than kMostRawBytes are not made, and their walks are left out. Errors: those of RenderVoxelPicture.
inline constexpr std::uint64_t kMostRawBytes = std::uint64_t{1} << 30;
Result<VoxelBench> MeasureVoxels(const VoxelBenchModel& model, const VoxelBenchOptions& options);

// The tables, with the published figures in parentheses for the models that correspond to those of the thesis by their names:
// cube (simple), terrain (voxlap), head (myhead).
std::vector<Table> VoxelTables(const std::vector<VoxelBench>& models);
nlohmann::json VoxelBenchJson(const VoxelBench& bench);

}  // namespace facetless
