#include "render/trace/section_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/kernels/dispatch.h"
#include "render/model/walk.h"
#include "render/trace/section_contact.h"
#include "render/trace/section_rows.h"

namespace facetless {
namespace {

// The number of blocks of the first pass, and the number of pieces into which a block is divided.
constexpr int kFirstBlocks = 128, kPieces = 8;
// A block is accepted if it disagrees with its halves by less than this share of the area. The sum over a
// thousand such blocks is three digits below 1e-6, the accuracy required of a section's area.
constexpr double kBlockTolerance = 1e-12;
// The largest number of divisions by eight of a block, which is 1/128 of the extent. The result is 2^-31 of
// the extent, where chords that end like a square root are known to 2^-46.
constexpr int kMostLevels = 8;
constexpr std::size_t kMostDivided =
    4096;  // blocks on all levels together, which is a quarter of a million rows
// Faces thinner than this share of the extent cannot contain an area that is significant at the required
// accuracy.
constexpr double kThinnestFace = 1e-6;
// A face lies in the plane if all its control points do, within 2^-36 of the size. This tolerance is for the
// rounding of numbers that were written to a text file and placed a few times. The plane is moved by four
// times the tolerance.
constexpr double kCoincident = 0x1p-36, kMoves = 4;
// If the plane is tangent at its new position, too, it is moved again, twice as far each time.
constexpr int kMostMoves = 4;
// The number of pieces of surfaces that may be divided for one plane, which takes a tenth of a second.
constexpr std::size_t kMostPieces = 1 << 16;
// Below this height, as a share of the size, the rounding of a surface hides which parts are above the plane
// and which are below.
constexpr double kFinestHeight = 0x1p-48;
// The largest number of undecided rows, each of which uses up the work limit of the fallback solver, some
// milliseconds. After that, blocks that contain such rows are not divided.
constexpr std::uint64_t kMostUndecidedRows = 1024;
// The rounding of the two ends of a chord, as a share of the model's size, for each row of a block.
constexpr double kChordRounding = 0x1p-48;

// The weights of the open formulas for four and eight equidistant midpoints, which are exact to degree three
// and seven.
constexpr std::array<double, 4> kFour = {13.0 / 48, 11.0 / 48, 11.0 / 48, 13.0 / 48};
constexpr std::array<double, kBlockRows> kEight = {295627.0 / 1935360, 71329.0 / 1935360,  471771.0 / 1935360,
                                                   128953.0 / 1935360, 128953.0 / 1935360, 471771.0 / 1935360,
                                                   71329.0 / 1935360,  295627.0 / 1935360};

// The result of measuring a block.
struct Block {
  double begin = 0, end = 0, error = 0, odd = 0;  // odd: errors and doubts of the rows themselves
  std::vector<SectionArea::OfSolid> solids;
  double area = 0;
  bool forced = false;     // the block must be divided, whatever its error
  bool undecided = false;  // a row of the block is undecided
};

double Difference(double a, double b) {
  return std::fabs(a - b);
}

// Extrapolates the length of the next row from six rows, which start at `rows` and are `step` apart.
double Continued(const SectionRow* rows, int step) {
  constexpr double kExtrapolate[] = {-1, 6, -15, 20, -15, 6};
  double sum = 0;
  for (int i = 0; i < 6; ++i) sum += kExtrapolate[i] * rows[i * step].length;
  return sum;
}

// Integrates a block. rows[−1] and rows[kBlockRows] are the adjacent rows of the neighbouring blocks.
Block Integrate(double begin, double end, const SectionRow* rows) {
  Block block;
  block.begin = begin;
  block.end = end;
  const double width = end - begin;
  double eight = 0, four = 0, odd = 0;
  for (int i = 0; i < kBlockRows; ++i) {
    eight += kEight[i] * rows[i].length;
    four += 0.5 * kFour[i % 4] * rows[i].length;
    odd += (rows[i].unsure + rows[i].error) / kBlockRows;
    for (const SectionArea::OfSolid& chord : rows[i].solids) {
      auto sum = std::find_if(block.solids.begin(), block.solids.end(),
                              [&](const auto& s) { return s.solid == chord.solid; });
      if (sum == block.solids.end()) sum = block.solids.insert(sum, {chord.solid, 0});
      sum->area_mm2 += width * kEight[i] * chord.area_mm2;
    }
  }
  // Neither formula shows changes between the last row and the row of the neighbour, but the row of the
  // neighbour does.
  const double before = Difference(Continued(rows + 5, -1), rows[-1].length),
               after = Difference(Continued(rows + 2, 1), rows[kBlockRows].length);
  block.area = width * eight;
  block.error = width * Difference(eight, four) + width / kBlockRows * (before + after);
  block.odd = width * odd;
  return block;
}

// The intervals of the scan axis covered by faces that are thinner than a block of the first pass.
std::vector<std::pair<double, double>> ThinFaces(const Scene::Data& scene, const SectionScan& scan) {
  std::vector<std::pair<double, double>> thin;
  const double extent = scan.end - scan.begin;
  for (const Instance& instance : scene.model->instances) {
    for (const std::uint32_t f : Indices(FacesOf(*scene.model, instance))) {
      const auto range = scan.ProjectOntoAxis(scene.faces[f].bounds, instance.placement);
      if (!range) continue;
      const double width = range->second - range->first;
      if (width >= kThinnestFace * extent && width < extent / kFirstBlocks) thin.push_back(*range);
    }
  }
  std::sort(thin.begin(), thin.end());
  return thin;
}

bool ContainsThinFace(const std::vector<std::pair<double, double>>& thin, double begin, double end) {
  for (const auto& [low, high] : thin) {
    if (low > end) break;
    if (high >= begin && high - low < end - begin) return true;
  }
  return false;
}

// The placed faces all of whose control points lie in the plane.
std::vector<std::uint32_t> FacesInPlane(const Model& model, const SectionPlane& plane, double tolerance) {
  std::vector<std::uint32_t> found;
  for (const Instance& instance : model.instances) {
    for (const PlacedFace face : WalkPlacedFaces(model, instance)) {
      const auto points = PointsOf(model, model.surfaces[model.faces[face.face].surface]);
      const bool in_plane = std::all_of(points.begin(), points.end(), [&](const Vec4& p) {
        const Vec3 placed = instance.placement.Point({p.x / p.w, p.y / p.w, p.z / p.w});
        return std::fabs(Dot(plane.normal, placed - plane.point)) <= tolerance;
      });
      if (in_plane) found.push_back(face.id);
    }
  }
  return found;
}

// The position at which the cut is measured, and the faces that made a displacement necessary.
struct MeasuredPlane {
  double offset = 0;  // displacement along the normal, mm
  double error = 0;   // area that the surfaces in between cover, mm²
  std::vector<std::uint32_t> coincident, touching;
};

MeasuredPlane ChooseMeasuredPlane(const Scene::Data& scene, const SectionPlane& plane,
                                  const SectionSolids& solids) {
  const Model& model = *scene.model;
  const double size = std::max({model.Diagonal(), Length(model.bounds.center()), Length(plane.point)});
  const double thickness = kCoincident * size;
  const SectionScan scan(plane, model.bounds);
  MeasuredPlane place;
  if (!(scan.begin < scan.end)) return place;
  place.coincident = FacesInPlane(model, plane, thickness);
  const auto touching = [&](double offset) {
    return ExamineSlab(scene, scan, solids, offset - thickness, offset + thickness, 2 * thickness,
                       kMostPieces, place.coincident)
        .touching_faces;
  };
  place.touching = touching(0);
  if (place.coincident.empty() && place.touching.empty()) return place;

  // Move away from a face in the plane to the kept side, and from a tangent surface to the side where less
  // changes.
  place.error = INFINITY;
  double move = kMoves * thickness;
  for (int k = 0; k < kMostMoves; ++k, move *= 2) {
    for (const double offset : {-move, move}) {
      if (offset > 0 && !place.coincident.empty()) continue;
      if (k + 1 < kMostMoves && !touching(offset).empty()) continue;
      const SlabContact between =
          ExamineSlab(scene, scan, solids, std::min(offset, 0.0), std::max(offset, 0.0), kFinestHeight * size,
                      kMostPieces, place.coincident);
      if (between.area_mm2 < place.error) place.offset = offset, place.error = between.area_mm2;
    }
    if (place.error < INFINITY) break;
  }
  return place;
}

class Measurement {
 public:
  Measurement(const Scene::Data& scene, std::span<const SectionPlane> planes, std::size_t index,
              const SectionSolids& solids, const SectionAreaOptions& options, TileKernel kernel)
      : scene_(scene),
        solids_(solids),
        rows_(scene, planes, index, solids_, options.max_bytes, options.execution, kernel) {}

  Result<SectionArea> Run() {
    const SectionScan& scan = rows_.scan();
    if (!(scan.begin < scan.end)) return area_;
    const double extent = scan.end - scan.begin;
    const SlabContact cut =
        ExamineSlab(scene_, scan, solids_, 0, 0, kFinestHeight * scan.size(), kMostPieces, {});
    area_.outline_mm = cut.outline_mm;
    area_.error_parts.gaps = cut.gap_mm2;
    thin_ = ThinFaces(scene_, scan);
    for (const SlabComponent& part :
         ThinComponents(cut.pieces, extent / kFirstBlocks, kThinnestFace * 1e-3 * extent)) {
      if (part.axis_high - part.axis_low >= kThinnestFace * extent) {
        thin_.emplace_back(part.axis_low, part.axis_high);
      } else {
        area_.error_parts.missed += part.box_mm2;
      }
    }
    std::sort(thin_.begin(), thin_.end());
    std::vector<Block> blocks;
    if (auto measured = Measure({{scan.begin, scan.end}}, kFirstBlocks, &blocks); !measured.ok())
      return measured.error();

    // Divide the worst blocks, level by level.
    std::vector<Block> good;
    std::size_t divided = 0;
    for (int level = 0; level < kMostLevels; ++level) {
      double area = 0;
      for (const Block& block : blocks) area += block.area;
      for (const Block& block : good) area += block.area;
      std::stable_sort(blocks.begin(), blocks.end(),
                       [](const Block& a, const Block& b) { return a.error + a.odd > b.error + b.odd; });
      std::vector<std::pair<double, double>> again;
      std::uint64_t risked = 0;
      for (Block& block : blocks) {
        const bool worth = block.forced || block.error + block.odd > kBlockTolerance * area;
        // All rows of an undecided block may be undecided again.
        const std::uint64_t risk = block.undecided ? kPieces * kBlockRows + 2 : 0;
        if (worth && (risk == 0 || area_.undecided_rows + risked + risk <= kMostUndecidedRows) &&
            divided + again.size() < kMostDivided) {
          risked += risk;
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
      area_.error_parts.rows += block.error;
      area_.error_parts.odd += block.odd;
      for (const auto& [solid, mm2] : block.solids) per_solid[solid] += mm2;
    }
    for (std::uint32_t s = 0; s < per_solid.size(); ++s)
      if (per_solid[s] > 0) area_.solids.push_back({s, per_solid[s]});
    area_.error_parts.rows += kChordRounding * scan.size() * (cut.pieces.empty() ? 0 : extent);
    area_.open_faces = open_faces_;
    return area_;
  }

 private:
  // Measures each interval in `pieces` blocks, and appends the blocks.
  Result<void> Measure(const std::vector<std::pair<double, double>>& stretches, int pieces,
                       std::vector<Block>* blocks) {
    std::vector<Result<SectionRows::Answer>> answers(stretches.size(), SectionRows::Answer{});
    ParallelFor(std::size_t{0}, stretches.size(), [&](std::size_t i) {
      // Trace one additional row on either side.
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
        blocks->back().forced = ContainsThinFace(thin_, blocks->back().begin, blocks->back().end);
        for (int r = 0; r < kBlockRows; ++r)
          blocks->back().undecided |= answer.rows[1 + std::size_t(k) * kBlockRows + r].undecided;
      }
      area_.rows += answer.rows.size();
      area_.doubtful_rows += answer.doubtful_rows;
      area_.odd_rows += answer.odd_rows;
      area_.undecided_rows += answer.undecided_rows;
      std::vector<std::uint32_t> all;
      std::set_union(open_faces_.begin(), open_faces_.end(), answer.open_faces.begin(),
                     answer.open_faces.end(), std::back_inserter(all));
      open_faces_ = std::move(all);
    }
    return {};
  }

  const Scene::Data& scene_;
  const SectionSolids& solids_;
  const SectionRows rows_;
  std::vector<std::pair<double, double>> thin_;
  std::vector<std::uint32_t> open_faces_;
  SectionArea area_;
};

}  // namespace

Result<SectionArea> MeasureSection(const Scene& scene, std::span<const SectionPlane> planes,
                                   std::size_t index, const SectionAreaOptions& options) {
  const Stopwatch stopwatch;
  if (auto sound = CheckSections(planes); !sound.ok()) return sound.error();
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels.ok()) return kernels.error();

  const SectionSolids solids(scene.model());
  MeasuredPlane place = ChooseMeasuredPlane(scene.data(), planes[index], solids);
  std::vector<SectionPlane> moved(planes.begin(), planes.end());
  moved[index].point = moved[index].point + place.offset * moved[index].normal;

  std::optional<Result<SectionArea>> result;
  RunWithThreads(options.execution.threads, [&] {
    result = Measurement(scene.data(), moved, index, solids, options, kernels.value().trace_tile).Run();
  });
  if (!result->ok()) return *std::move(result);
  SectionArea area = std::move(*result).value();
  area.coincident_faces = std::move(place.coincident);
  area.touching_faces = std::move(place.touching);
  area.moved_mm = place.offset == 0 ? 0 : -place.offset;
  area.error_parts.move = place.error;
  const SectionArea::ErrorParts& parts = area.error_parts;
  area.error_mm2 = parts.rows + parts.odd + parts.move + parts.gaps + parts.missed;
  area.ms = stopwatch.Milliseconds();
  return area;
}

}  // namespace facetless
