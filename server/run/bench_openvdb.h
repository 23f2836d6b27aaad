// `facetless bench --openvdb FILE`: our voxels of exact solids against those that OpenVDB makes of a tessellation, and our
// walks through an octree against OpenVDB's rays.
//
//  1. The grid has `resolution` voxels along the longest side. All cores make the voxels on both sides, and the median of
//     some runs counts for ours; OpenVDB runs in a process of its own (openvdb/measure.h). Its tessellation is that of
//     `facetless mesh` at the relative tolerance 1e-3.
//  2. Where both disagree, ours is right if the centre is proven. Voxelize counts the centres that are not, so that at least
//     the other ones that differ are errors of the mesh or of OpenVDB.
//  3. Rays are those of 512 × 512 pixels of the view `iso`, without levels of detail, on one thread; the best of three
//     passes counts.
#pragma once

#include "bench/table.h"
#include "server/run/bench.h"

namespace facetless {

inline constexpr int kBenchVoxels = 512;

struct OpenVdbBench {
  nlohmann::json json;
  std::vector<Table> tables;
};

// Errors: kBadUsage (the build has no OpenVDB), those of Import, Voxelize and RunOpenVdb.
Result<OpenVdbBench> MeasureOpenVdb(const std::string& file, const ImportRequest& request,
                                    const RunOptions& options, int repeats, const RunContext& context,
                                    int resolution = kBenchVoxels);

}  // namespace facetless
