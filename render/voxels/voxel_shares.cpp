#include "render/voxels/voxel_shares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "render/accel/tile_leaf.h"
#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/trace/view_crossings.h"
#include "render/voxels/column_parts.h"
#include "render/voxels/touched_voxels.h"

namespace facetless {
namespace {

// The sums over the voxels of a slab. Each slab has its own, so that they do not depend on the threads.
struct ShareSums {
  double share = 0, bound = 0;
  float greatest_bound = 0;
  std::uint64_t partial = 0;
};

// The measures of one column of voxels, made from the rays through its small columns.
class ColumnShares {
 public:
  ColumnShares(const VoxelGrid& grid, const VoxelGrid& fine, const SectionSolids& solids, int divisions)
      : divisions_(divisions),
        small_(1.0 / (double(divisions) * divisions * divisions)),
        pitch_(fine.pitch),
        parts_(fine, solids),
        heights_(static_cast<std::size_t>(grid.size.z) + 1) {}

  void Begin() {
    std::fill(heights_.begin(), heights_.end(), Height{});
    doubtful_ = 0;
  }

  // Adds a small column: its crossings, and the small voxels of it that a face touches.
  void Add(std::span<const RayCrossing> crossings, std::uint8_t doubt,
           std::span<const TouchedVoxel> touched) {
    const bool odd = parts_.List(crossings);
    merged_.clear();
    for (const ColumnPart& part : parts_.list()) merged_.push_back({part.begin, part.end});
    Merge();
    for (const Interval& part : merged_) AddLength(part);
    // Crossings that are not placed within a quarter of a small voxel do not say which centres are inside.
    const bool vague = std::any_of(crossings.begin(), crossings.end(), [&](const RayCrossing& crossing) {
      return !(crossing.error < 0.25 * pitch_);
    });
    if (doubt != 0 || odd || vague) {
      ++doubtful_;
      return;
    }
    // The small voxels whose centres are inside.
    for (const Interval& part : merged_) {
      const int top = static_cast<int>(heights_.size() - 1) * divisions_;
      AddCentres(std::clamp(static_cast<int>(std::ceil(part.begin - 0.5)), 0, top),
                 std::clamp(static_cast<int>(std::ceil(part.end - 0.5)), 0, top));
    }
    std::size_t next = 0;
    for (const TouchedVoxel& voxel : touched) {
      Height& height = heights_[static_cast<std::size_t>(voxel.z / divisions_)];
      ++height.touched;
      const double centre = voxel.z + 0.5;
      while (next < merged_.size() && merged_[next].end <= centre) ++next;
      if (next < merged_.size() && merged_[next].begin <= centre) --height.inside;
    }
  }

  // Appends the runs of the column, and adds to *sums.
  void End(std::vector<ShareRun>* runs, ShareSums* sums) {
    const std::size_t first = runs->size();
    const std::int64_t doubtful = std::int64_t{doubtful_} * divisions_;
    std::int64_t full = 0;
    for (std::size_t z = 0; z + 1 < heights_.size(); ++z) {
      const Height& height = heights_[z];
      full += height.full;
      full_length_ += height.full_length;
      const std::int64_t inside = height.inside + full, unknown = height.touched + doubtful;
      const double low = static_cast<double>(inside) * small_,
                   high = std::min(static_cast<double>(inside + unknown) * small_, 1.0);
      const double share = std::clamp((height.length + full_length_) * small_, low, high);
      ShareRun run{int(z), int(z) + 1, float(share), 0};
      if (unknown > 0) {
        run.bound = UpperFloat(std::max(high - run.share, run.share - low));
        ++sums->partial;
        sums->greatest_bound = std::max(sums->greatest_bound, run.bound);
      }
      sums->share += run.share;
      sums->bound += run.bound;
      if (run.share == 0 && run.bound == 0) continue;
      if (runs->size() > first && runs->back().z_end == run.z_begin && runs->back().share == run.share &&
          runs->back().bound == run.bound) {
        runs->back().z_end = run.z_end;
      } else {
        runs->push_back(run);
      }
    }
    full_length_ = 0;
  }

 private:
  struct Interval {
    double begin, end;
  };
  // Of a voxel. The members `full` change what holds for this voxel and all above it.
  struct Height {
    double length = 0, full_length = 0;  // in small voxels
    std::int64_t inside = 0, full = 0;   // small voxels inside that no face touches
    std::int64_t touched = 0;
  };

  static float UpperFloat(double value) {
    const float rounded = static_cast<float>(value);
    return rounded >= value ? rounded : std::nextafter(rounded, std::numeric_limits<float>::infinity());
  }

  // Makes the intervals of solids that overlap one.
  void Merge() {
    std::sort(merged_.begin(), merged_.end(),
              [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
    std::size_t last = 0;
    for (std::size_t i = 1; i < merged_.size(); ++i) {
      if (merged_[i].begin <= merged_[last].end) {
        merged_[last].end = std::max(merged_[last].end, merged_[i].end);
      } else {
        merged_[++last] = merged_[i];
      }
    }
    if (!merged_.empty()) merged_.resize(last + 1);
  }

  // Adds the lengths of an interval in each voxel, in small voxels.
  void AddLength(Interval part) {
    const double top = double(heights_.size() - 1) * divisions_;
    part.begin = std::clamp(part.begin, 0.0, top);
    part.end = std::clamp(part.end, 0.0, top);
    if (part.begin >= part.end) return;
    const auto first = static_cast<std::size_t>(part.begin / divisions_),
               last = static_cast<std::size_t>(part.end / divisions_);
    if (first == last) {
      heights_[first].length += part.end - part.begin;
      return;
    }
    heights_[first].length += double(first + 1) * divisions_ - part.begin;
    heights_[first + 1].full_length += divisions_;
    heights_[last].full_length -= divisions_;
    heights_[last].length += part.end - double(last) * divisions_;
  }

  void AddCentres(int begin, int end) {
    if (begin >= end) return;
    const int first = begin / divisions_, last = end / divisions_;
    const auto at = [&](int z) -> Height& { return heights_[static_cast<std::size_t>(z)]; };
    if (first == last) {
      at(first).inside += end - begin;
      return;
    }
    at(first).inside += (first + 1) * divisions_ - begin;
    at(first + 1).full += divisions_;
    at(last).full -= divisions_;
    at(last).inside += end - last * divisions_;
  }

  const int divisions_;
  const double small_;  // the share of a small voxel
  const double pitch_;  // of small voxels, mm
  ColumnParts parts_;
  std::vector<Interval> merged_;
  std::vector<Height> heights_;  // of each z, and one above
  int doubtful_ = 0;             // small columns in doubt
  double full_length_ = 0;
};

class ShareMeter {
 public:
  ShareMeter(const Scene& scene, const ShareOptions& options, const Execution& execution, VoxelShares* result)
      : scene_(scene),
        options_(options),
        execution_(execution),
        solids_(scene.model()),
        result_(*result),
        fine_(Fine(result->grid, options.divisions)) {}

  Result<void> Run() {
    const Stopwatch stopwatch;
    Result<std::vector<TouchedSlab>> touched =
        FindTouchedVoxels(scene_, fine_, {.max_bytes = options_.accuracy.max_bytes}, execution_);
    if (!touched.ok()) return touched.error();
    touched_ = std::move(touched).value();
    result_.touch_ms = stopwatch.Milliseconds();
    result_.slabs.resize(static_cast<std::size_t>(result_.grid.size.x));
    sums_of_slabs_.resize(result_.slabs.size());
    PerThread<Worker> workers([&] { return Worker(result_.grid, fine_, solids_, options_.divisions); });
    const Result<CrossingStats> done =
        VisitCrossings(scene_, ColumnCamera(fine_, VoxelAxis::kZ), options_.accuracy, execution_,
                       [&](const TileCrossings& tile) { Visit(tile, &workers.local()); });
    if (!done.ok()) return done.error();
    for (const ShareSums& sums : sums_of_slabs_) {
      result_.volume_mm3 += sums.share * result_.grid.voxel_mm3();
      result_.volume_bound_mm3 += sums.bound * result_.grid.voxel_mm3();
      result_.greatest_bound = std::max(result_.greatest_bound, sums.greatest_bound);
      result_.partial += sums.partial;
    }
    result_.rays = done.value().rays;
    result_.rays_in_doubt = done.value().rays_in_doubt;
    result_.trace_ms = done.value().prepare_ms + done.value().trace_ms;
    result_.peak_bytes = done.value().bytes + result_.bytes();
    for (const TouchedSlab& slab : touched_) result_.peak_bytes += slab.capacity() * sizeof(TouchedVoxel);
    return {};
  }

 private:
  static VoxelGrid Fine(const VoxelGrid& grid, int divisions) {
    return {grid.origin,
            grid.pitch / divisions,
            {grid.size.x * divisions, grid.size.y * divisions, grid.size.z * divisions}};
  }

  // The slabs of one column of tiles, which are made from the top of the picture, the highest y, to its bottom.
  struct Worker {
    Worker(const VoxelGrid& grid, const VoxelGrid& fine, const SectionSolids& solids, int divisions)
        : column(grid, fine, solids, divisions) {}
    ColumnShares column;
    struct Slab {
      std::vector<ShareRun> runs;          // of descending y
      std::vector<std::uint32_t> lengths;  // of each column, the same order
      ShareSums sums;
    };
    std::vector<Slab> slabs;
  };

  std::span<const TouchedVoxel> TouchedIn(int x, int y) const {
    const TouchedSlab& slab = touched_[static_cast<std::size_t>(x)];
    const auto found =
        std::equal_range(slab.begin(), slab.end(), TouchedVoxel{static_cast<std::uint16_t>(y), 0, 0, 0},
                         [](const TouchedVoxel& a, const TouchedVoxel& b) { return a.y < b.y; });
    return {found.first, found.second};
  }

  void Visit(const TileCrossings& tile, Worker* worker) {
    const int d = options_.divisions;
    if (tile.row == 0) worker->slabs.assign(static_cast<std::size_t>(tile.columns / d), {});
    for (int left = 0; left < tile.columns; left += d) {
      Worker::Slab& slab = worker->slabs[static_cast<std::size_t>(left / d)];
      for (int top = 0; top < tile.rows; top += d) {
        worker->column.Begin();
        for (int i = top; i < top + d; ++i)
          for (int j = left; j < left + d; ++j)
            worker->column.Add(tile.Of(i, j), tile.DoubtOf(i, j),
                               TouchedIn(tile.column + j, fine_.size.y - 1 - (tile.row + i)));
        const std::size_t before = slab.runs.size();
        worker->column.End(&slab.runs, &slab.sums);
        slab.lengths.push_back(static_cast<std::uint32_t>(slab.runs.size() - before));
      }
      if (tile.last_of_column) Store((tile.column + left) / d, slab);
    }
  }

  // Stores the columns of a slab in ascending order of y.
  void Store(int x, const Worker::Slab& from) {
    VoxelShares::Slab& to = result_.slabs[static_cast<std::size_t>(x)];
    to.first.push_back(0);
    to.runs.reserve(from.runs.size());
    auto end = from.runs.end();
    for (std::size_t y = from.lengths.size(); y-- > 0;) {
      const auto begin = end - static_cast<std::ptrdiff_t>(from.lengths[y]);
      to.runs.insert(to.runs.end(), begin, end);
      to.first.push_back(static_cast<std::uint32_t>(to.runs.size()));
      end = begin;
    }
    sums_of_slabs_[static_cast<std::size_t>(x)] = from.sums;
  }

  const Scene& scene_;
  const ShareOptions& options_;
  const Execution& execution_;
  const SectionSolids solids_;
  VoxelShares& result_;
  const VoxelGrid fine_;
  std::vector<TouchedSlab> touched_;
  std::vector<ShareSums> sums_of_slabs_;
};

}  // namespace

ShareRun VoxelShares::Get(int x, int y, int z) const {
  const std::span<const ShareRun> column = Column(x, y);
  const auto after = std::upper_bound(column.begin(), column.end(), z,
                                      [](int at, const ShareRun& run) { return at < run.z_end; });
  if (after == column.end() || z < after->z_begin) return {z, z + 1, 0, 0};
  return {z, z + 1, after->share, after->bound};
}

std::uint64_t VoxelShares::bytes() const {
  std::uint64_t sum = slabs.capacity() * sizeof(Slab);
  for (const Slab& slab : slabs)
    sum += slab.first.capacity() * sizeof(std::uint32_t) + slab.runs.capacity() * sizeof(ShareRun);
  return sum;
}

Result<void> CheckDivisions(const VoxelGrid& grid, int divisions) {
  // A tile holds whole columns of voxels.
  const int d = divisions;
  if (d < 2 || d > kTileSize || kTileSize % d != 0)
    return Error{ErrorCode::kBadUsage,
                 "fraction is " + std::to_string(d) +
                     ", but a voxel is divided into 2, 4, 8, 16 or 32 parts along each side"};
  const int most = std::max({grid.size.x, grid.size.y, grid.size.z});
  if (most > kMostVoxelsPerAxis / d)
    return Error{ErrorCode::kBadUsage, "fraction: " + std::to_string(most) + " voxels with " +
                                           std::to_string(d) + " parts each are more than " +
                                           std::to_string(kMostVoxelsPerAxis) +
                                           " along a side; use fewer voxels or fewer parts"};
  return {};
}

Result<VoxelShares> MeasureShares(const Scene& scene, const VoxelGrid& grid, const ShareOptions& options,
                                  const Execution& execution) {
  if (auto checked = CheckDivisions(grid, options.divisions); !checked.ok()) return checked.error();
  VoxelShares shares;
  shares.grid = grid;
  shares.divisions = options.divisions;
  std::optional<Result<void>> done;
  RunWithThreads(execution.threads, [&] { done = ShareMeter(scene, options, execution, &shares).Run(); });
  if (!done->ok()) return done->error();
  return shares;
}

}  // namespace facetless
