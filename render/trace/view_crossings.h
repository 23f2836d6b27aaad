// All crossings of every ray of a view with the exact surfaces, tile by tile. Voxels need them, as does every other
// question about whole lines.
//
//     Result<CrossingStats> done = VisitCrossings(scene, camera, {}, execution, [&](const TileCrossings& tile) {
//       for (int i = 0; i < tile.rows; ++i)
//         for (int j = 0; j < tile.columns; ++j)
//           for (const RayCrossing& crossing : tile.Of(i, j)) ...
//     });
//
//  1. The crossings of a ray are sorted by depth, and a root that two leaves of a face found is listed once.
//  2. The doubt of a ray is the set of reasons (view/doubt.h) why its crossings are not proven to be complete and correct:
//     those of the ray as a whole, and those of each crossing. A ray without doubt is proven.
//  3. One thread visits the tiles of a column of tiles one after the other, from the top of the picture to its bottom.
//     Several threads may visit different columns of tiles at the same time.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "render/base/execution.h"
#include "render/trace/direct.h"
#include "render/view/camera.h"

namespace facetless {

struct RayCrossing {
  double depth, error;  // mm; the error is infinite if there is no bound
  std::uint32_t placed_face;
  std::uint8_t doubt;
};

struct TileCrossings {
  int column, row, columns, rows;  // the samples of the tile
  int tile_column;                 // number of the column of tiles
  bool last_of_column;             // the lowest tile of its column
  std::span<const RayCrossing> Of(int i, int j) const {
    const std::size_t k = static_cast<std::size_t>(i * columns + j);
    return crossings.subspan(first[k], first[k + 1] - first[k]);
  }
  std::uint8_t DoubtOf(int i, int j) const { return doubts[static_cast<std::size_t>(i * columns + j)]; }

  std::span<const RayCrossing> crossings;
  std::span<const std::uint32_t> first;  // index of each sample's first crossing, row by row; the end
  std::span<const std::uint8_t> doubts;  // of each ray: law 2
};

struct CrossingStats {
  std::uint64_t rays = 0, crossings = 0, rays_in_doubt = 0;
  std::uint64_t bytes = 0;  // of the leaves and bitmaps
  double prepare_ms = 0, trace_ms = 0;
};

// Errors: those of TraceDirect.
Result<CrossingStats> VisitCrossings(const Scene& scene, const Camera& camera,
                                     const ExactTraceOptions& accuracy, const Execution& execution,
                                     const std::function<void(const TileCrossings&)>& visit);

}  // namespace facetless
