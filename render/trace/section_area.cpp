#include "render/trace/section_area.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "render/kernels/dispatch.h"
#include "render/trace/parallel.h"
#include "render/trace/section_rows.h"

namespace facetless {
namespace {

using Clock = std::chrono::steady_clock;

// Blocks of the first pass, and pieces that a block is divided into.
constexpr int kFirstBlocks = 128, kPieces = 8;
// A block is good when it disagrees with its halves by less than this share of the area; a thousand such blocks stay
// three digits below the millionth that a section's area is asked to.
constexpr double kBlockTolerance = 1e-12;
// Divisions by eight of a block of 1/128 of the extent: 2^-31 of it, where chords that end like a square root are
// known to 2^-46.
constexpr int kMostLevels = 8;
constexpr std::size_t kMostDivided = 4096;  // blocks, in all levels together: a quarter of a million rows
// Faces thinner than this share of the extent have no room for an area that anybody could ask for.
constexpr double kThinnestFace = 1e-6;
// A face lies in the plane if its control points do, to the rounding of a model whose numbers went through a text
// file and a few placements: 2^-36 of the size. The plane is moved by four times that.
constexpr double kCoincident = 0x1p-36, kMoves = 4;

// Weights of the open formulas of four and eight equidistant midpoints, by row: exact to degree three and seven.
constexpr std::array<double, 4> kFour = {13.0 / 48, 11.0 / 48, 11.0 / 48, 13.0 / 48};
constexpr std::array<double, kBlockRows> kEight = {295627.0 / 1935360, 71329.0 / 1935360,  471771.0 / 1935360,
                                                   128953.0 / 1935360, 128953.0 / 1935360, 471771.0 / 1935360,
                                                   71329.0 / 1935360,  295627.0 / 1935360};

// What is left of a block when it has been measured.
struct Block {
  double begin = 0, end = 0, error = 0;
  std::vector<SectionArea::OfSolid> solids;
  double area = 0;
  bool forced = false;  // to be divided, whatever its error
};

double Difference(double a, double b) {
  return std::fabs(a - b);
}

// What the six rows from `rows` on, in steps of `step`, make one expect of the next.
double Continued(const SectionRow* rows, int step) {
  constexpr double kExtrapolate[] = {-1, 6, -15, 20, -15, 6};
  double sum = 0;
  for (int i = 0; i < 6; ++i) sum += kExtrapolate[i] * rows[i * step].length;
  return sum;
}

// rows[−1] and rows[kBlockRows] are those of the neighbours.
Block Integrate(double begin, double end, const SectionRow* rows) {
  Block block;
  block.begin = begin, block.end = end;
  const double width = end - begin;
  double eight = 0, four = 0, odd = 0;
  for (int i = 0; i < kBlockRows; ++i) {
    eight += kEight[i] * rows[i].length;
    four += 0.5 * kFour[i % 4] * rows[i].length;
    odd += rows[i].odd_length / kBlockRows;
    for (const SectionArea::OfSolid& chord : rows[i].solids) {
      auto sum = std::find_if(block.solids.begin(), block.solids.end(),
                              [&](const auto& s) { return s.solid == chord.solid; });
      if (sum == block.solids.end()) sum = block.solids.insert(sum, {chord.solid, 0});
      sum->area_mm2 += width * kEight[i] * chord.area_mm2;
    }
  }
  // What happens between the last row and the neighbour's shows in neither formula, but in the neighbour's row.
  const double before = Difference(Continued(rows + 5, -1), rows[-1].length),
               after = Difference(Continued(rows + 2, 1), rows[kBlockRows].length);
  block.area = width * eight;
  block.error = width * (Difference(eight, four) + odd) + width / kBlockRows * (before + after);
  return block;
}

// The stretches of the scan axis that faces cover which are thinner than a block of the first pass.
std::vector<std::pair<double, double>> ThinFaces(const Scene::Data& scene, const SectionScan& scan) {
  std::vector<std::pair<double, double>> thin;
  const double extent = scan.end - scan.begin;
  for (const Instance& instance : scene.model->instances) {
    const Range faces = scene.model->parts[instance.part].faces;
    for (std::uint32_t f = faces.first; f < faces.end(); ++f) {
      const auto range = scan.RangeOf(scene.faces[f].bounds, instance.placement);
      if (!range) continue;
      const double width = range->second - range->first;
      if (width >= kThinnestFace * extent && width < extent / kFirstBlocks) thin.push_back(*range);
    }
  }
  std::sort(thin.begin(), thin.end());
  return thin;
}

bool HoldsThinFace(const std::vector<std::pair<double, double>>& thin, double begin, double end) {
  for (const auto& [low, high] : thin) {
    if (low > end) break;
    if (high >= begin && high - low < end - begin) return true;
  }
  return false;
}

// Placed faces whose every control point lies in the plane.
std::vector<std::uint32_t> FacesIn(const Model& model, const SectionPlane& plane, double tolerance) {
  std::vector<std::uint32_t> found;
  for (const Instance& instance : model.instances) {
    const Range faces = model.parts[instance.part].faces;
    for (std::uint32_t f = faces.first; f < faces.end(); ++f) {
      const Surface& surface = model.surfaces[model.faces[f].surface];
      const std::size_t count = std::size_t(surface.PatchCount()) * surface.PointsPerPatch();
      bool in_plane = true;
      for (std::size_t i = 0; in_plane && i < count; ++i) {
        const Vec4& p = model.control_points[surface.first_control_point + i];
        const Vec3 placed = instance.placement.Point({p.x / p.w, p.y / p.w, p.z / p.w});
        in_plane = std::fabs(Dot(plane.normal, placed - plane.point)) <= tolerance;
      }
      if (in_plane) found.push_back(instance.first_placed_face + (f - faces.first));
    }
  }
  return found;
}

class Measurement {
 public:
  Measurement(const Scene::Data& scene, std::span<const SectionPlane> planes, std::size_t index,
              const SectionAreaOptions& options, TileKernel kernel)
      : scene_(scene),

        solids_(*scene.model),
        rows_(scene, planes, index, solids_, options.max_bytes, options.cancel, kernel) {}

  Result<SectionArea> Run() {
    const SectionScan& scan = rows_.scan();
    if (!(scan.begin < scan.end)) return area_;
    thin_ = ThinFaces(scene_, scan);
    std::vector<Block> blocks;
    if (auto measured = Measure({{scan.begin, scan.end}}, kFirstBlocks, &blocks); !measured.ok())
      return measured.error();

    // Divide the worst, level by level.
    std::vector<Block> good;
    std::size_t divided = 0;
    for (int level = 0; level < kMostLevels; ++level) {
      double area = 0;
      for (const Block& block : blocks) area += block.area;
      for (const Block& block : good) area += block.area;
      std::stable_sort(blocks.begin(), blocks.end(),
                       [](const Block& a, const Block& b) { return a.error > b.error; });
      std::vector<std::pair<double, double>> again;
      for (Block& block : blocks) {
        if ((block.error > kBlockTolerance * area || block.forced) && divided + again.size() < kMostDivided) {
          again.emplace_back(block.begin, block.end);
        } else {
          good.push_back(std::move(block));
        }
      }
      blocks.clear();
      if (again.empty()) break;
      divided += again.size();
      if (auto measured = Measure(again, kPieces, &blocks); !measured.ok()) return measured.error();
    }
    good.insert(good.end(), std::make_move_iterator(blocks.begin()), std::make_move_iterator(blocks.end()));

    // Add up along the axis.
    std::sort(good.begin(), good.end(), [](const Block& a, const Block& b) { return a.begin < b.begin; });
    std::vector<double> per_solid(solids_.stride(), 0.0);
    for (const Block& block : good) {
      area_.area_mm2 += block.area;
      area_.error_mm2 += block.error;
      for (const auto& [solid, mm2] : block.solids) per_solid[solid] += mm2;
    }
    for (std::uint32_t s = 0; s < per_solid.size(); ++s)
      if (per_solid[s] > 0) area_.solids.push_back({s, per_solid[s]});
    area_.open_faces = static_cast<std::uint32_t>(open_faces_.size());
    return area_;
  }

 private:
  // Measures each stretch in `pieces` blocks, and appends them.
  Result<void> Measure(const std::vector<std::pair<double, double>>& stretches, int pieces,
                       std::vector<Block>* blocks) {
    std::vector<Result<SectionRows::Answer>> answers(stretches.size(), SectionRows::Answer{});
    ParallelFor(std::size_t{0}, stretches.size(), [&](std::size_t i) {
      // One row more on either side.
      const auto [begin, end] = stretches[i];
      const double row = (end - begin) / (pieces * kBlockRows);
      answers[i] = rows_.Trace(begin - row, end + row, pieces * kBlockRows + 2);
    });
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      if (!answers[i].ok()) return answers[i].error();
      const SectionRows::Answer& answer = answers[i].value();
      const auto [begin, end] = stretches[i];
      for (int k = 0; k < pieces; ++k) {
        blocks->push_back(Integrate(begin + (end - begin) * k / pieces,
                                    begin + (end - begin) * (k + 1) / pieces,
                                    &answer.rows[1 + std::size_t(k) * kBlockRows]));
        blocks->back().forced = HoldsThinFace(thin_, blocks->back().begin, blocks->back().end);
      }
      area_.rows += answer.rows.size();
      area_.doubtful_rows += answer.doubtful_rows;
      area_.odd_rows += answer.odd_rows;
      std::vector<std::uint32_t> all;
      std::set_union(open_faces_.begin(), open_faces_.end(), answer.open_faces.begin(),
                     answer.open_faces.end(), std::back_inserter(all));
      open_faces_ = std::move(all);
    }
    return {};
  }

  const Scene::Data& scene_;

  const SectionSolids solids_;
  const SectionRows rows_;
  std::vector<std::pair<double, double>> thin_;
  std::vector<std::uint32_t> open_faces_;
  SectionArea area_;
};

}  // namespace

Result<SectionArea> MeasureSection(const Scene& scene, std::span<const SectionPlane> planes,
                                   std::size_t index, const SectionAreaOptions& options) {
  const Clock::time_point start = Clock::now();
  if (auto sound = CheckSections(planes); !sound.ok()) return sound.error();
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels.ok()) return kernels.error();

  // Leave the plane of a face for the kept side.
  const Model& model = scene.model();
  std::vector<SectionPlane> moved(planes.begin(), planes.end());
  const double size =
      std::max({model.Diagonal(), Length(model.bounds.center()), Length(planes[index].point)});
  std::vector<std::uint32_t> coincident = FacesIn(model, planes[index], kCoincident * size);
  const double moved_mm = coincident.empty() ? 0 : kMoves * kCoincident * size;
  moved[index].point = moved[index].point - moved_mm * moved[index].normal;

  std::optional<Result<SectionArea>> result;
  RunWithThreads(options.threads, [&] {
    result = Measurement(scene.data(), moved, index, options, kernels.value().trace_tile).Run();
  });
  if (!result->ok()) return *std::move(result);
  SectionArea area = std::move(*result).value();
  area.coincident_faces = std::move(coincident);
  area.moved_mm = moved_mm;
  area.ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return area;
}

}  // namespace facetless
