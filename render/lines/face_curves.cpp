#include "render/lines/face_curves.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "render/base/parallel.h"
#include "render/model/walk.h"
#include "render/nurbs/bracketed_root.h"
#include "render/nurbs/surface_eval.h"
#include "render/trace/scene.h"

namespace facetless {
namespace {

constexpr int kCellsPerSpan = 8;
constexpr double kPixelsPerCell = 12;
constexpr int kMostCells = 512;          // in one direction of a face
constexpr double kPlaceWidth = 0x1p-48;  // of a cell's side; this is the full precision of a parameter
constexpr int kMostRefinements = 16;     // halvings of a chord; sufficient for a window of 1e-8 of the radius
// A bias that is added to the function, as a share of its largest value. With it, curves along grid lines and
// seams lie on one side of them, and a function that vanishes everywhere has no zeros.
constexpr double kBias = 1e-9;

// If the sine of the angle between the tangents, or the ratio of their lengths, is below this value, du × dv
// is mostly rounding.
constexpr double kSingular = 0x1p-26;

bool IsSingular(const SurfacePoint& p) {
  const double longest = std::fmax(Dot(p.du, p.du), Dot(p.dv, p.dv));
  const Vec3 normal = Cross(p.du, p.dv);
  return !(Dot(normal, normal) > kSingular * kSingular * longest * longest);
}

// The function whose zeros are the curve: n · view, or the height above a plane, scaled to about 1.
class FaceValue {
 public:
  FaceValue(const Model& model, std::uint32_t face, const Instance& instance, const CameraFrame& frame,
            const SectionPlane* plane)
      : surface(model, model.faces[face].surface),
        placement_(instance.placement),
        frame_(frame),
        plane_(plane),
        size_(model.Diagonal() > 0 ? model.Diagonal() : 1) {}

  double operator()(Vec2 uv) const {
    if (plane_ != nullptr) return Dot(plane_->normal, Point(uv) - plane_->point) / size_ + kBias;
    SurfacePoint p = surface.First(uv.x, uv.y);
    // At a pole, step back towards the middle until the tangents span a plane.
    for (double back = 0x1p-20; back <= 1 && IsSingular(p); back *= 16)
      p = surface.First(uv.x + back * (0.5 * (surface.u_begin() + surface.u_end()) - uv.x),
                        uv.y + back * (0.5 * (surface.v_begin() + surface.v_end()) - uv.y));
    const Vec3 normal = Normalized(Cross(placement_.Vector(p.du), placement_.Vector(p.dv)));
    const Vec3 view = frame_.projection == Projection::kPerspective
                          ? Normalized(placement_.Point(p.position) - frame_.eye)
                          : frame_.forward;
    return Dot(normal, view) + kBias;
  }
  Vec3 Point(Vec2 uv) const { return placement_.Point(surface.Position(uv.x, uv.y)); }
  PixelPoint Pixel(Vec2 uv) const { return Project(frame_, Point(uv)); }

  const SurfaceEval surface;

 private:
  const Placement& placement_;
  const CameraFrame& frame_;
  const SectionPlane* plane_;
  const double size_;
};

// The zero of the function between two points with the values a and b, which have different signs.
Vec2 ZeroBetween(const FaceValue& value, Vec2 from, double a, Vec2 to, double b) {
  if (a == 0) return from;
  if (b == 0) return to;
  return from + BracketedRoot([&](double t) { return value(from + t * (to - from)); }, a, b, kPlaceWidth) *
                    (to - from);
}

class FaceTracer {
 public:
  FaceTracer(const Scene::Data& scene, std::uint32_t face, std::uint32_t placed_face, const FaceValue& value,
             LineClass kind, int cells, const Camera& camera, const CameraFrame& frame)
      : scene_(scene),
        face_(face),
        placed_face_(placed_face),
        value_(value),
        kind_(kind),
        cells_(cells),
        camera_(camera),
        frame_(frame) {}

  void Run(std::vector<ViewLine>* lines) {
    const Surface& surface = scene_.model->surfaces[scene_.model->faces[face_].surface];
    columns_ = Lines(surface.u_spans);
    rows_ = Lines(surface.v_spans);
    std::vector<double> values(columns_.size() * rows_.size());
    for (std::size_t i = 0; i < columns_.size(); ++i)
      for (std::size_t j = 0; j < rows_.size(); ++j)
        values[i * rows_.size() + j] = value_({columns_[i], rows_[j]});
    FindPieces(values);
    Chain(lines);
  }

 private:
  // The grid lines in one direction. Each span is divided into equal cells.
  std::vector<double> Lines(Range spans) const {
    const int cells = std::clamp(kMostCells / std::max(1, int(spans.count)), 1, cells_);
    std::vector<double> lines;
    for (const Span& span : Elements(scene_.model->spans, spans)) {
      for (int k = 0; k < cells; ++k) lines.push_back(span.begin + (span.end - span.begin) * k / cells);
    }
    lines.push_back(scene_.model->spans[spans.end() - 1].end);
    return lines;
  }

  // Finds the pieces of the curve in the cells, as pairs of cell sides that they connect.
  void FindPieces(const std::vector<double>& values) {
    const std::size_t nv = rows_.size();
    const auto positive = [&](std::size_t i, std::size_t j) { return values[i * nv + j] >= 0; };
    const auto place = [&](std::size_t i, std::size_t j) { return Vec2{columns_[i], rows_[j]}; };
    // The key of a side that starts at the corner (i, j) is even along u and odd along v.
    const auto side = [&](std::size_t i, std::size_t j, bool along_v) { return 2 * (i * nv + j) + along_v; };
    for (std::size_t i = 0; i + 1 < columns_.size(); ++i) {
      for (std::size_t j = 0; j + 1 < nv; ++j) {
        const bool a = positive(i, j), b = positive(i + 1, j), c = positive(i + 1, j + 1),
                   d = positive(i, j + 1);
        if (a == b && b == c && c == d) continue;
        std::vector<std::size_t> met;
        // Find a zero on the side from corner (i, j) to corner (k, l).
        const auto meet = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
          if (positive(i, j) == positive(k, l)) return;
          const std::size_t key = side(i, j, k == i);
          met.push_back(key);
          if (!places_.contains(key))
            places_[key] =
                ZeroBetween(value_, place(i, j), values[i * nv + j], place(k, l), values[k * nv + l]);
        };
        meet(i, j, i + 1, j);
        meet(i + 1, j, i + 1, j + 1);
        meet(i, j + 1, i + 1, j + 1);
        meet(i, j, i, j + 1);
        if (met.size() == 2) {
          pieces_.emplace_back(met[0], met[1]);
        } else {
          // There are two pieces. Choose them so that they do not separate the centre from the corners with
          // its sign.
          const bool centre = value_(0.5 * (place(i, j) + place(i + 1, j + 1))) >= 0;
          const bool around_a = centre != a;  // the corners a and c are cut off
          pieces_.emplace_back(met[0], around_a ? met[3] : met[1]);
          pieces_.emplace_back(met[2], around_a ? met[1] : met[3]);
        }
      }
    }
  }

  // Joins pieces that share a side.
  void Chain(std::vector<ViewLine>* lines) {
    std::map<std::size_t, std::vector<std::size_t>> at;  // pieces by side
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      at[pieces_[k].first].push_back(k);
      at[pieces_[k].second].push_back(k);
    }
    std::vector<bool> used(pieces_.size(), false);
    const auto walk = [&](std::size_t start, std::size_t from) {
      std::vector<Vec2> chain = {places_[from]};
      for (std::size_t k = start;;) {
        used[k] = true;
        from = pieces_[k].first == from ? pieces_[k].second : pieces_[k].first;
        chain.push_back(places_[from]);
        const auto& next = at[from];
        const auto found = std::find_if(next.begin(), next.end(), [&](std::size_t n) { return !used[n]; });
        if (found == next.end()) break;
        k = *found;
      }
      Draw(chain, lines);
    };
    // Follow open chains from their ends, and then closed chains.
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      if (used[k]) continue;
      if (at[pieces_[k].first].size() == 1) {
        walk(k, pieces_[k].first);
      } else if (at[pieces_[k].second].size() == 1) {
        walk(k, pieces_[k].second);
      }
    }
    for (std::size_t k = 0; k < pieces_.size(); ++k)
      if (!used[k]) walk(k, pieces_[k].first);
  }

  bool Inside(Vec2 uv) const {
    const FaceTrim& trim = scene_.faces[face_].trim;
    return trim.whole() || trim.Query(uv.x, uv.y, 0, 0).inside;
  }

  // Refines a chain, trims it, and projects the remaining parts.
  void Draw(const std::vector<Vec2>& chain, std::vector<ViewLine>* lines) {
    std::vector<Vec2> fine = {chain.front()};
    for (std::size_t i = 1; i < chain.size(); ++i) {
      Refine(chain[i - 1], chain[i], 0, &fine);
      fine.push_back(chain[i]);
    }
    ViewLine line{kind_, true, {}, {placed_face_, kNoIndex}};
    const auto end = [&] {
      if (line.points.size() > 1) lines->push_back(line);
      line.points.clear();
    };
    const auto add = [&](Vec2 uv) {
      const PixelPoint p = value_.Pixel(uv);
      const bool ahead = frame_.projection == Projection::kOrthographic || p.depth > frame_.near_mm;
      if (!ahead || !std::isfinite(p.x) || !std::isfinite(p.y)) return end();
      line.points.push_back({p.x, p.y, p.depth});
    };
    bool inside = Inside(fine.front());
    if (inside) add(fine.front());
    for (std::size_t i = 1; i < fine.size(); ++i) {
      const bool here = Inside(fine[i]);
      if (here != inside) {
        Vec2 a = fine[i - 1], b = fine[i];
        for (int k = 0; k < 30; ++k) {
          const Vec2 middle = 0.5 * (a + b);
          (Inside(middle) == inside ? a : b) = middle;
        }
        add(0.5 * (a + b));
        if (!here) end();
        inside = here;
      }
      if (here) add(fine[i]);
    }
    end();
  }

  // Appends points of the curve between a and b until the chords are flat.
  void Refine(Vec2 a, Vec2 b, int depth, std::vector<Vec2>* out) {
    if (depth == kMostRefinements) return;
    const std::optional<Vec2> middle = OnCurve(0.5 * (a + b), b - a);
    if (!middle) return;
    const PixelPoint p = value_.Pixel(a), q = value_.Pixel(b), m = value_.Pixel(*middle);
    // Do not refine outside the window.
    const auto outside = [&](double p1, double p2, double p3, double size) {
      return (p1 < 0 && p2 < 0 && p3 < 0) || (p1 > size && p2 > size && p3 > size);
    };
    if (outside(p.x, q.x, m.x, camera_.width_px) || outside(p.y, q.y, m.y, camera_.height_px)) return;
    const double dx = q.x - p.x, dy = q.y - p.y, square = dx * dx + dy * dy;
    const double share =
        square > 0 ? std::clamp(((m.x - p.x) * dx + (m.y - p.y) * dy) / square, 0.0, 1.0) : 0;
    const double off_x = m.x - p.x - share * dx, off_y = m.y - p.y - share * dy;
    const double off_depth = m.depth - p.depth - share * (q.depth - p.depth);
    const double pixel = std::max(frame_.pixel_x, frame_.pixel_y) *
                         (frame_.projection == Projection::kPerspective ? m.depth : 1);
    const bool flat = off_x * off_x + off_y * off_y <= kFlatness * kFlatness &&
                      (square <= kFlatness * kFlatness || std::fabs(off_depth) <= kDepthFlatness * pixel);
    if (flat && depth > 0) return;
    Refine(a, *middle, depth + 1, out);
    out->push_back(*middle);
    Refine(*middle, b, depth + 1, out);
  }

  // The point on the curve in the direction perpendicular to the chord from `at`.
  std::optional<Vec2> OnCurve(Vec2 at, Vec2 chord) const {
    // Measure perpendicularity in units of cells, because u and v may have different scales.
    const double du = (columns_.back() - columns_.front()) / (columns_.size() - 1),
                 dv = (rows_.back() - rows_.front()) / (rows_.size() - 1);
    const Vec2 across{-chord.y / dv * du, chord.x / du * dv};
    const double here = value_(at);
    for (double reach = 0.05; reach < 2; reach *= 2) {
      for (const double sign : {1.0, -1.0}) {
        const Vec2 other = at + (sign * reach) * across;
        const double there = value_(other);
        if ((there >= 0) != (here >= 0)) return ZeroBetween(value_, at, here, other, there);
      }
    }
    return {};
  }

  const Scene::Data& scene_;
  const std::uint32_t face_, placed_face_;
  const FaceValue& value_;
  const LineClass kind_;
  const int cells_;  // per span
  const Camera& camera_;
  const CameraFrame& frame_;
  std::vector<double> columns_, rows_;
  std::map<std::size_t, Vec2> places_;  // points of the curve, by cell side
  std::vector<std::pair<std::size_t, std::size_t>> pieces_;
};

// The size of the box in the picture, pixels; 0 if it lies outside the window.
double SizeInPicture(const Box3& box, const Placement& placement, const Camera& camera,
                     const CameraFrame& frame) {
  double x_low = INFINITY, x_high = -INFINITY, y_low = INFINITY, y_high = -INFINITY;
  for (int k = 0; k < 8; ++k) {
    const PixelPoint p =
        Project(frame, placement.Point({k & 1 ? box.high.x : box.low.x, k & 2 ? box.high.y : box.low.y,
                                        k & 4 ? box.high.z : box.low.z}));
    // The size of a box that extends behind the eye is unbounded.
    if (frame.projection == Projection::kPerspective && !(p.depth > frame.near_mm)) return INFINITY;
    x_low = std::min(x_low, p.x);
    x_high = std::max(x_high, p.x);
    y_low = std::min(y_low, p.y);
    y_high = std::max(y_high, p.y);
  }
  if (x_high < 0 || y_high < 0 || x_low > camera.width_px || y_low > camera.height_px) return 0;
  return std::max(x_high - x_low, y_high - y_low);
}

std::vector<ViewLine> Collect(const Scene& scene, const SectionPlane* plane, const Camera& camera,
                              const CameraFrame& frame, const Execution& execution) {
  const Model& model = scene.model();
  struct Job {
    std::uint32_t instance, face;
    int cells;  // per span
  };
  std::vector<Job> jobs;
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    for (const std::uint32_t f : Indices(FacesOf(model, model.instances[i]))) {
      // A plane has no silhouette of its own.
      if (plane == nullptr && model.surfaces[model.faces[f].surface].kind == SurfaceKind::kPlane) continue;
      if (plane != nullptr) {
        // Check whether the plane intersects the box.
        const Box3& box = scene.data().faces[f].bounds;
        bool above = false, below = false;
        for (int k = 0; k < 8; ++k) {
          const Vec3 corner = model.instances[i].placement.Point({k & 1 ? box.high.x : box.low.x,
                                                                  k & 2 ? box.high.y : box.low.y,
                                                                  k & 4 ? box.high.z : box.low.z});
          (Dot(plane->normal, corner - plane->point) > 0 ? above : below) = true;
        }
        if (!above || !below) continue;
      }
      const double size =
          SizeInPicture(scene.data().faces[f].bounds, model.instances[i].placement, camera, frame);
      if (size < 1) continue;
      jobs.push_back({i, f, static_cast<int>(std::clamp(size / kPixelsPerCell, 2.0, double(kCellsPerSpan)))});
    }
  }
  std::vector<std::vector<ViewLine>> of_job(jobs.size());
  ParallelFor(std::size_t{0}, jobs.size(), [&](std::size_t k) {
    if (execution.cancelled()) return;
    const Instance& instance = model.instances[jobs[k].instance];
    const std::uint32_t placed_face = PlacedFaceId(model, instance, jobs[k].face);
    const FaceValue value(model, jobs[k].face, instance, frame, plane);
    FaceTracer(scene.data(), jobs[k].face, placed_face, value,
               plane ? LineClass::kCut : LineClass::kSilhouette, jobs[k].cells, camera, frame)
        .Run(&of_job[k]);
  });
  std::vector<ViewLine> lines;
  for (auto& own : of_job)
    lines.insert(lines.end(), std::make_move_iterator(own.begin()), std::make_move_iterator(own.end()));
  return lines;
}

}  // namespace

std::vector<ViewLine> SilhouetteLines(const Scene& scene, const Camera& camera, const CameraFrame& frame,
                                      const Execution& execution) {
  return Collect(scene, nullptr, camera, frame, execution);
}

std::vector<ViewLine> CutLines(const Scene& scene, const SectionPlane& plane, const Camera& camera,
                               const CameraFrame& frame, const Execution& execution) {
  return Collect(scene, &plane, camera, frame, execution);
}

}  // namespace facetless
