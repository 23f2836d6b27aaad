#include "render/voxels/voxelize.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/model/walk.h"
#include "render/trace/view_crossings.h"
#include "render/view/section.h"
#include "render/voxels/column_parts.h"
#include "render/voxels/touched_voxels.h"

namespace facetless {
namespace {

std::uint8_t Byte(float channel) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(channel, 0.0f, 1.0f)));
}

// The voxels of faces and of solids (law 6).
class VoxelColors {
 public:
  explicit VoxelColors(const Model& model) : solids_(model) {
    for (std::uint32_t face = 0; face < model.PlacedFaceCount(); ++face)
      of_faces_.push_back(Of(model.PlacedFaceColor(face), solids_.ClosedSolidOfFace(face)));
    for (std::uint32_t solid = 0; solid < solids_.count(); ++solid)
      of_solids_.push_back(Of(solids_.ColorOf(solid), solid));
  }
  const SectionSolids& solids() const { return solids_; }
  Voxel OfFace(std::uint32_t placed_face) const { return of_faces_[placed_face]; }
  Voxel OfSolid(std::uint32_t solid) const { return of_solids_[solid]; }

 private:
  static Voxel Of(const Color& color, std::uint32_t solid) {
    const std::uint32_t material =
        solid == kNoIndex ? kMostMaterials : std::min<std::uint32_t>(solid + 1, kMostMaterials);
    return Voxel::Of(Byte(color.r), Byte(color.g), Byte(color.b), static_cast<std::uint8_t>(material));
  }

  SectionSolids solids_;
  std::vector<Voxel> of_faces_, of_solids_;
};

// The voxels of a part of a column, from the bottom.
struct Inside {
  int begin, end;
  std::uint32_t solid, lower_face, upper_face;
};

// Makes the runs of columns from the crossings of their rays. Each thread has one.
class ColumnMaker {
 public:
  ColumnMaker(const VoxelGrid& grid, const VoxelColors& colors)
      : grid_(grid), colors_(colors), parts_(grid, colors.solids()) {}

  VoxelStats stats;

  // Appends the runs of a column to *runs.
  void Make(std::span<const RayCrossing> crossings, std::uint8_t doubt, std::vector<VoxelRun>* runs) {
    ++stats.columns;
    const std::uint64_t near_centres = CentresNear(crossings);
    const bool odd = parts_.List(crossings);
    inside_.clear();
    for (const ColumnPart& part : parts_.list()) {
      // The centre of voxel k is at k + 0.5.
      const int begin = std::max(static_cast<int>(std::ceil(part.begin - 0.5)), 0),
                end = std::min(static_cast<int>(std::ceil(part.end - 0.5)), grid_.size.z);
      if (begin < end) inside_.push_back({begin, end, part.solid, part.lower_face, part.upper_face});
    }
    if (doubt != 0 || odd) {
      ++stats.columns_in_doubt;
      stats.columns_odd += odd;
      for (std::size_t bit = 0; bit < stats.doubts.size(); ++bit) stats.doubts[bit] += doubt >> bit & 1;
      stats.not_certified += static_cast<std::uint64_t>(grid_.size.z);
    } else {
      stats.not_certified += near_centres;
      stats.certified += static_cast<std::uint64_t>(grid_.size.z) - near_centres;
    }
    AppendRuns(runs);
  }

 private:
  // The number of centres within the error of a crossing.
  std::uint64_t CentresNear(std::span<const RayCrossing> crossings) const {
    std::uint64_t centres = 0;
    for (const RayCrossing& crossing : crossings) {
      // A crossing without a bound may be anywhere.
      const double error = std::isfinite(crossing.error) ? crossing.error / grid_.pitch : grid_.size.z;
      const double at = grid_.size.z - crossing.depth / grid_.pitch;
      const double first = std::max(std::ceil(at - error - 0.5), 0.0),
                   last = std::min(std::floor(at + error - 0.5), grid_.size.z - 1.0);
      if (first <= last) centres += static_cast<std::uint64_t>(last - first) + 1;
    }
    return std::min(centres, static_cast<std::uint64_t>(grid_.size.z));
  }

  void AppendRuns(std::vector<VoxelRun>* runs) {
    std::sort(inside_.begin(), inside_.end(), [](const Inside& a, const Inside& b) {
      return std::tie(a.begin, a.solid) < std::tie(b.begin, b.solid);
    });
    const std::size_t first = runs->size();
    const auto append = [&](int begin, int end, Voxel voxel) {
      if (begin >= end) return;
      if (runs->size() > first && runs->back().z_end == begin && runs->back().voxel == voxel) {
        runs->back().z_end = end;
      } else {
        runs->push_back({begin, end, voxel});
      }
    };
    int filled = 0;
    for (const Inside& part : inside_) {
      const int begin = std::max(part.begin, filled);
      if (begin >= part.end) continue;
      filled = part.end;
      // The lowest voxel and the highest one have the colours of the faces there.
      int low = begin, high = part.end;
      if (begin == part.begin) append(low, low + 1, colors_.OfFace(part.lower_face)), ++low;
      if (low < high) {
        append(low, high - 1, colors_.OfSolid(part.solid));
        append(high - 1, high, colors_.OfFace(part.upper_face));
      }
    }
  }

  const VoxelGrid& grid_;
  const VoxelColors& colors_;
  ColumnParts parts_;
  std::vector<Inside> inside_;
};

void Add(const VoxelStats& from, VoxelStats* to) {
  to->columns += from.columns;
  to->columns_in_doubt += from.columns_in_doubt;
  to->columns_odd += from.columns_odd;
  to->certified += from.certified;
  to->not_certified += from.not_certified;
  for (std::size_t bit = 0; bit < from.doubts.size(); ++bit) to->doubts[bit] += from.doubts[bit];
}

class Voxelizer {
 public:
  Voxelizer(const Scene& scene, const VoxelizeOptions& options, const Execution& execution, Voxels* result)
      : scene_(scene),
        options_(options),
        execution_(execution),
        grid_(result->grid),
        colors_(scene.model()),
        result_(*result) {}

  Result<void> Run() {
    NameOpenFaces();
    const bool solid = options_.fill == VoxelFill::kSolid || options_.fill == VoxelFill::kConservative;
    if (solid)
      if (auto done = FillSolids(); !done.ok()) return done;
    if (options_.fill == VoxelFill::kSolid) return {};
    const Stopwatch stopwatch;
    Result<std::vector<TouchedSlab>> touched =
        options_.fill == VoxelFill::kThinSurface
            ? FindCrossedVoxels()
            : FindTouchedVoxels(scene_, grid_, {.max_bytes = options_.accuracy.max_bytes}, execution_);
    if (!touched.ok()) return touched.error();
    for (const TouchedSlab& slab : touched.value()) result_.stats.touched += slab.size();
    ParallelFor(0, grid_.size.x, [&](int x) { AddTouched(x, touched.value()[static_cast<std::size_t>(x)]); });
    result_.stats.touch_ms = stopwatch.Milliseconds();
    return {};
  }

 private:
  void NameOpenFaces() {
    const Model& model = scene_.model();
    VoxelStats& stats = result_.stats;
    stats.solids = colors_.solids().count();
    for (std::uint32_t face = 0; face < model.PlacedFaceCount(); ++face) {
      if (colors_.solids().ClosedSolidOfFace(face) != kNoIndex) continue;
      ++stats.open_faces;
      if (stats.open_face_names.size() < kMostOpenNames)
        stats.open_face_names.push_back(model.PlacedFaceName(face));
    }
  }

  void AddCosts(const CrossingStats& costs) {
    result_.stats.crossings += costs.crossings;
    result_.stats.peak_bytes = std::max(result_.stats.peak_bytes, costs.bytes);
    result_.stats.trace_ms += costs.prepare_ms + costs.trace_ms;
  }

  // The slabs of one column of tiles, which are made from the top of the picture, the highest y, to its bottom.
  struct Slabs {
    Slabs(const VoxelGrid& grid, const VoxelColors& colors) : maker(grid, colors) {}
    ColumnMaker maker;
    struct Slab {
      std::vector<VoxelRun> runs;          // of descending y
      std::vector<std::uint32_t> lengths;  // of each column, the same order
    };
    std::vector<Slab> slabs;
  };

  Result<void> FillSolids() {
    PerThread<Slabs> workers([&] { return Slabs(grid_, colors_); });
    const Result<CrossingStats> done =
        VisitCrossings(scene_, ColumnCamera(grid_, VoxelAxis::kZ), options_.accuracy, execution_,
                       [&](const TileCrossings& tile) {
                         Slabs& own = workers.local();
                         if (tile.row == 0) own.slabs.assign(static_cast<std::size_t>(tile.columns), {});
                         for (int j = 0; j < tile.columns; ++j) {
                           Slabs::Slab& slab = own.slabs[static_cast<std::size_t>(j)];
                           for (int i = 0; i < tile.rows; ++i) {
                             const std::size_t before = slab.runs.size();
                             own.maker.Make(tile.Of(i, j), tile.DoubtOf(i, j), &slab.runs);
                             slab.lengths.push_back(static_cast<std::uint32_t>(slab.runs.size() - before));
                           }
                           if (tile.last_of_column) StoreSlab(tile.column + j, slab);
                         }
                       });
    if (!done.ok()) return done.error();
    for (const Slabs& own : workers) Add(own.maker.stats, &result_.stats);
    AddCosts(done.value());
    return {};
  }

  // Stores the columns of a slab in ascending order of y.
  void StoreSlab(int x, const Slabs::Slab& slab) {
    std::vector<std::uint32_t> first{0};
    std::vector<VoxelRun> runs;
    runs.reserve(slab.runs.size());
    std::size_t end = slab.runs.size();
    for (std::size_t y = slab.lengths.size(); y-- > 0;) {
      const std::size_t begin = end - slab.lengths[y];
      runs.insert(runs.end(), slab.runs.begin() + static_cast<std::ptrdiff_t>(begin),
                  slab.runs.begin() + static_cast<std::ptrdiff_t>(end));
      first.push_back(static_cast<std::uint32_t>(runs.size()));
      end = begin;
    }
    result_.model.SetSlab(x, std::move(first), std::move(runs));
  }

  // The voxels of law 3: those of the crossings of the rays along all three axes.
  Result<std::vector<TouchedSlab>> FindCrossedVoxels() {
    struct Crossed {
      VoxelPoint at;
      std::uint32_t placed_face;
    };
    PerThread<std::vector<Crossed>> workers;
    const VoxelPoint n = grid_.size;
    for (const VoxelAxis axis : {VoxelAxis::kX, VoxelAxis::kY, VoxelAxis::kZ}) {
      const int along = axis == VoxelAxis::kX ? n.x : axis == VoxelAxis::kY ? n.y : n.z;
      const Result<CrossingStats> done = VisitCrossings(
          scene_, ColumnCamera(grid_, axis), options_.accuracy, execution_, [&](const TileCrossings& tile) {
            for (int i = 0; i < tile.rows; ++i)
              for (int j = 0; j < tile.columns; ++j)
                for (const RayCrossing& crossing : tile.Of(i, j)) {
                  const int column = tile.column + j, row = tile.row + i;
                  const int at = static_cast<int>(std::floor(along - crossing.depth / grid_.pitch));
                  if (at < 0 || at >= along) continue;
                  // Columns of the picture run along y, −x and x; rows run down along z, z and y.
                  const VoxelPoint p = axis == VoxelAxis::kX ? VoxelPoint{at, column, n.z - 1 - row}
                                       : axis == VoxelAxis::kY
                                           ? VoxelPoint{n.x - 1 - column, at, n.z - 1 - row}
                                           : VoxelPoint{column, n.y - 1 - row, at};
                  workers.local().push_back({p, crossing.placed_face});
                }
          });
      if (!done.ok()) return done.error();
      AddCosts(done.value());
      result_.stats.columns += done.value().rays;
      result_.stats.columns_in_doubt += done.value().rays_in_doubt;
      std::uint64_t crossed = 0;
      for (const std::vector<Crossed>& own : workers) crossed += own.size();
      if (crossed * (sizeof(Crossed) + sizeof(TouchedVoxel)) > options_.accuracy.max_bytes)
        return Error{ErrorCode::kLimitExceeded, "the voxels that the surfaces cross need more than " +
                                                    std::to_string(options_.accuracy.max_bytes >> 20) +
                                                    " MB; use fewer voxels, or raise --max-view-memory"};
    }
    std::vector<TouchedSlab> slabs(static_cast<std::size_t>(n.x));
    for (const std::vector<Crossed>& own : workers)
      for (const Crossed& crossed : own)
        slabs[static_cast<std::size_t>(crossed.at.x)].push_back({static_cast<std::uint16_t>(crossed.at.y),
                                                                 static_cast<std::uint16_t>(crossed.at.z),
                                                                 crossed.placed_face, 0});
    for (TouchedSlab& slab : slabs) SortTouched(&slab, false);
    return slabs;
  }

  // Fills the touched voxels of a slab, in addition to those that are filled.
  void AddTouched(int x, const TouchedSlab& touched) {
    if (touched.empty()) return;
    std::vector<std::uint32_t> first{0};
    std::vector<VoxelRun> runs;
    std::size_t next = 0;
    for (int y = 0; y < grid_.size.y; ++y) {
      const std::size_t begin = runs.size();
      const auto append = [&](int low, int high, Voxel voxel) {
        if (low >= high) return;
        if (runs.size() > begin && runs.back().z_end == low && runs.back().voxel == voxel) {
          runs.back().z_end = high;
        } else {
          runs.push_back({low, high, voxel});
        }
      };
      const std::span<const VoxelRun> solid = result_.model.Column(x, y);
      std::size_t run = 0;
      int z = 0;  // below it, the column is done
      const auto append_solid = [&](int end) {
        for (; run < solid.size() && solid[run].z_begin < end; ++run) {
          append(std::max(solid[run].z_begin, z), std::min(solid[run].z_end, end), solid[run].voxel);
          if (solid[run].z_end > end) break;
        }
        z = end;
      };
      for (; next < touched.size() && touched[next].y == y; ++next) {
        append_solid(touched[next].z);
        append(z, z + 1, colors_.OfFace(touched[next].placed_face));
        z = touched[next].z + 1;
      }
      append_solid(grid_.size.z);
      first.push_back(static_cast<std::uint32_t>(runs.size()));
    }
    result_.model.SetSlab(x, std::move(first), std::move(runs));
  }

  const Scene& scene_;
  const VoxelizeOptions& options_;
  const Execution& execution_;
  const VoxelGrid& grid_;
  const VoxelColors colors_;
  Voxels& result_;
};

}  // namespace

Result<Voxels> Voxelize(const Scene& scene, const VoxelGrid& grid, const VoxelizeOptions& options,
                        const Execution& execution) {
  Voxels voxels{RunModel(grid.size), grid, {}};
  std::optional<Result<void>> done;
  RunWithThreads(execution.threads, [&] { done = Voxelizer(scene, options, execution, &voxels).Run(); });
  if (!done->ok()) return done->error();
  return voxels;
}

}  // namespace facetless
