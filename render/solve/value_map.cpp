#include "render/solve/value_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "render/base/parallel.h"
#include "render/solve/patch_jet.h"

namespace facetless {
namespace {

// A triangle may be off the surface by about this much on the screen, pixels.
constexpr double kChord = 0.25;
// The sides of quads are not shorter than this on the screen, pixels, and no patch has more than this many on a side.
constexpr double kLeastSide = 3;
constexpr int kMostQuads = 256;
// Rows of pixels that are drawn together.
constexpr int kBandRows = 16;

// A point in the axes of the eye: the column and the row relative to the image centre, times the depth in perspective
// views, and the depth.
struct EyePoint {
  double x = 0, y = 0, z = 0;
};

struct Corner {
  EyePoint point;
  double u = 0, v = 0;  // parameters of the patch
};

// The quads of a patch: (columns + 1)·(rows + 1) points, v fastest. No columns: the patch is not drawn.
struct Grid {
  int columns = 0, rows = 0;
  std::uint64_t first = 0;                  // index of its first point
  double low = INFINITY, high = -INFINITY;  // rows of pixels, relative to the image centre
  bool trimmed = false;                     // fragments must be asked whether they are trimmed away
};

// What is drawn, and how to draw a band of rows of it.
class Drawing {
 public:
  Drawing(const SolverScene& scene, const ValueMap::Size& size)
      : scene_(scene),
        width_(size.width),
        height_(size.height),
        center_x_(scene.frame().center_x),
        center_y_(scene.frame().center_y),
        perspective_(scene.frame().projection == Projection::kPerspective),
        near_(scene.frame().near_mm),
        grids_(scene.patches().size()) {}

  // Chooses the quads. Returns the memory that they need.
  std::uint64_t Plan() {
    ParallelFor(std::size_t{0}, grids_.size(), [&](std::size_t patch) { PlanPatch(patch); });
    std::uint64_t count = 0;
    for (Grid& grid : grids_) {
      grid.first = count;
      if (grid.columns > 0)
        count += static_cast<std::uint64_t>(grid.columns + 1) * static_cast<std::uint64_t>(grid.rows + 1);
    }
    points_count_ = count;
    return count * sizeof(EyePoint) + grids_.size() * sizeof(Grid);
  }

  void Evaluate(const Execution& execution) {
    points_.resize(points_count_);
    ParallelFor(std::size_t{0}, grids_.size(), [&](std::size_t index) {
      if (execution.cancelled()) return;
      const SolverPatch& patch = scene_.patches()[index];
      const Grid& grid = grids_[index];
      if (grid.columns == 0) return;
      EyePoint* out = points_.data() + grid.first;
      for (int i = 0; i <= grid.columns; ++i)
        for (int j = 0; j <= grid.rows; ++j, ++out) {
          const PatchJet<4> jet = EvaluatePatch<4>(&scene_.screen(patch)->x, patch.degree_u, patch.degree_v,
                                                   double(i) / grid.columns, double(j) / grid.rows);
          *out = InEyeAxes({jet.value[0], jet.value[1], jet.value[2], jet.value[3]});
        }
    });
  }

  // Calls put(patch, column, row, u, v) for each fragment of the rows [begin, end) that is nearer than what was put
  // there before.
  template <typename Put>
  void DrawBand(int begin, int end, const Put& put) const {
    std::vector<double> nearest(static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(width_),
                                INFINITY);
    for (std::size_t index = 0; index < grids_.size(); ++index) {
      const Grid& grid = grids_[index];
      if (grid.columns == 0 || grid.low + center_y_ > end || grid.high + center_y_ < begin) continue;
      DrawPatch(index, [&](const std::array<Screen, 3>& triangle) {
        Fill(triangle, index, begin, end, nearest, put);
      });
    }
  }

 private:
  // A corner on the screen. Divided by the depth, all these are linear there.
  struct Screen {
    double x = 0, y = 0;  // pixel coordinates
    double key = 0;       // increases with the depth
    double inverse = 1;   // 1/depth in perspective views
    double u = 0, v = 0;  // times `inverse`
  };

  EyePoint InEyeAxes(const ViewProjection::Point& p) const {
    return perspective_ ? EyePoint{p.x / p.q, p.y / p.q, p.w / p.q}
                        : EyePoint{p.x / p.w, p.y / p.w, p.q / p.w};
  }
  bool InFront(const EyePoint& p) const { return !perspective_ || p.z > near_; }

  // Decides how many quads a patch gets, and whether any of it can be seen.
  void PlanPatch(std::size_t index) {
    const SolverPatch& patch = scene_.patches()[index];
    const SolverFace& face = scene_.faces()[patch.face];
    Grid& grid = grids_[index];
    std::array<Vec3, (kMaxDegree + 1) * (kMaxDegree + 1)> net;  // the third number is the weight
    double left = INFINITY, right = -INFINITY;
    bool in_front = true, any_in_front = false;
    for (int k = 0; k < patch.points(); ++k) {
      const EyePoint p = InEyeAxes(scene_.screen(patch)[k]);
      in_front = in_front && InFront(p);
      any_in_front = any_in_front || InFront(p);
      const double scale = perspective_ ? 1 / p.z : 1;
      const ViewProjection::Point& point = scene_.screen(patch)[k];
      const Vec3 at{scale * p.x, scale * p.y, perspective_ ? point.q : point.w};
      net[static_cast<std::size_t>(k)] = at;
      left = std::min(left, at.x), right = std::max(right, at.x);
      grid.low = std::min(grid.low, at.y), grid.high = std::max(grid.high, at.y);
    }
    if (!any_in_front) return;
    if (!in_front) {
      // A net that is partly behind the eye has no bounds on the screen.
      grid.low = -INFINITY, grid.high = INFINITY;
    } else if (!(right + center_x_ >= 0 && left + center_x_ <= width_ && grid.high + center_y_ >= 0 &&
                 grid.low + center_y_ <= height_)) {
      return;
    }
    if (face.trim != nullptr && !face.trim->whole()) {
      const Vec2 a = scene_.Native(patch, 0, 0), b = scene_.Native(patch, 1, 1);
      const RectClass where = face.trim->Classify(std::min(a.x, b.x), std::max(a.x, b.x), std::min(a.y, b.y),
                                                  std::max(a.y, b.y), 0);
      if (where == RectClass::kOutside) return;
      grid.trimmed = where == RectClass::kMixed;
    }
    grid.columns = in_front ? Quads(net.data(), patch.degree_u, patch.degree_v, true) : kMostQuads;
    grid.rows = in_front ? Quads(net.data(), patch.degree_u, patch.degree_v, false) : kMostQuads;
  }

  // Returns the number of quads along u (or v), from the differences of the net on the screen.
  static int Quads(const Vec3* net, int degree_u, int degree_v, bool along_u) {
    const auto size = [](Vec3 d) { return Length(Vec2{d.x, d.y}); };
    const int stride_u = degree_v + 1, along = along_u ? degree_u : degree_v;
    const int stride = along_u ? stride_u : 1;
    double bend = 0, twist = 0, longest = 0, speed = 0, weight_speed = 0, least_weight = INFINITY;
    for (int r = 0; r <= (along_u ? degree_v : degree_u); ++r) {
      const Vec3* row = net + (along_u ? r : r * stride_u);
      double length = 0;
      for (int c = 0; c <= along; ++c) {
        least_weight = std::min(least_weight, row[c * stride].z);
        if (c == along) break;
        const Vec3 d = row[(c + 1) * stride] - row[c * stride];
        length += size(d);
        speed = std::max(speed, size(d));
        weight_speed = std::max(weight_speed, std::fabs(d.z));
        if (c + 1 < along) bend = std::max(bend, size(row[(c + 2) * stride] - row[(c + 1) * stride] - d));
      }
      longest = std::max(longest, length);
    }
    for (int k = 0; k < degree_u; ++k)
      for (int l = 0; l < degree_v; ++l) {
        const Vec3* p = net + k * stride_u + l;
        twist = std::max(twist, size(p[0] - p[1] - (p[stride_u] - p[stride_u + 1])));
      }
    // Weights change the speed along a curve: S″ = (N″ − 2w′·S′ − w″·S)/w. Here that is estimated, and not bounded.
    const double second =
        along * (along - 1.0) * bend + 2.0 * along * along * speed * weight_speed / least_weight;
    // A chord over 1/n of a curve is off by at most max|S″|/(8n²), and the diagonal of a twisted quad by
    // max|Suv|/(4n²).
    const double wanted = std::sqrt(std::max(second / 8, degree_u * degree_v * twist / 4) / kChord);
    const double most = std::min<double>(kMostQuads, std::max(1.0, longest / kLeastSide));
    return std::max(1, static_cast<int>(std::ceil(std::fmin(wanted, most))));
  }

  template <typename Draw>
  void DrawPatch(std::size_t index, const Draw& draw) const {
    const Grid& grid = grids_[index];
    const auto corner = [&](int i, int j) {
      return Corner{
          points_[grid.first + static_cast<std::uint64_t>(i) * static_cast<std::uint64_t>(grid.rows + 1) +
                  static_cast<std::uint64_t>(j)],
          double(i) / grid.columns, double(j) / grid.rows};
    };
    for (int i = 0; i < grid.columns; ++i)
      for (int j = 0; j < grid.rows; ++j) {
        const Corner a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
        DrawClipped({a, b, c}, draw);
        DrawClipped({a, c, d}, draw);
      }
  }

  // Draws the part of a triangle in front of the eye, which is a triangle or two.
  template <typename Draw>
  void DrawClipped(const std::array<Corner, 3>& triangle, const Draw& draw) const {
    std::array<Screen, 4> polygon;
    int count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner &from = triangle[k], &to = triangle[(k + 1) % 3];
      if (InFront(from.point)) polygon[static_cast<std::size_t>(count++)] = OnScreen(from);
      if (InFront(from.point) == InFront(to.point)) continue;
      // The cut lies at twice the near distance at most, so that the division by the depth stays finite.
      const double t = (2 * near_ - from.point.z) / (to.point.z - from.point.z);
      const double s = std::clamp(t, 0.0, 1.0);
      const auto mix = [s](double a, double b) { return a + s * (b - a); };
      const EyePoint cut{mix(from.point.x, to.point.x), mix(from.point.y, to.point.y),
                         mix(from.point.z, to.point.z)};
      if (InFront(cut))
        polygon[static_cast<std::size_t>(count++)] = OnScreen({cut, mix(from.u, to.u), mix(from.v, to.v)});
    }
    for (int k = 2; k < count; ++k)
      draw({polygon[0], polygon[static_cast<std::size_t>(k - 1)], polygon[static_cast<std::size_t>(k)]});
  }

  Screen OnScreen(const Corner& corner) const {
    const auto& [x, y, z] = corner.point;
    if (!perspective_) return {x + center_x_, y + center_y_, z, 1, corner.u, corner.v};
    const double inverse = 1 / z;
    return {x * inverse + center_x_, y * inverse + center_y_, -inverse, inverse,
            corner.u * inverse,      corner.v * inverse};
  }

  // Puts the pixels whose centres lie in a triangle, borders included.
  template <typename Put>
  void Fill(const std::array<Screen, 3>& t, std::size_t index, int begin, int end,
            std::vector<double>& nearest, const Put& put) const {
    const auto [x_low, x_high] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [y_low, y_high] = std::minmax({t[0].y, t[1].y, t[2].y});
    const auto first = [](double low, int least) {
      return static_cast<int>(std::ceil(std::clamp(low - 0.5, double(least), 1e9)));
    };
    const auto last = [](double high, int most) {
      return static_cast<int>(std::floor(std::clamp(high - 0.5, -1e9, double(most))));
    };
    const double area = Edge(t[0], t[1], t[2].x, t[2].y);
    if (!(std::fabs(area) > 0)) return;
    const double share = 1 / area;
    for (int row = first(y_low, begin); row <= last(y_high, end - 1); ++row)
      for (int column = first(x_low, 0); column <= last(x_high, width_ - 1); ++column) {
        const double x = column + 0.5, y = row + 0.5;
        const double a = share * Edge(t[1], t[2], x, y), b = share * Edge(t[2], t[0], x, y),
                     c = share * Edge(t[0], t[1], x, y);
        if (!(a >= 0 && b >= 0 && c >= 0)) continue;
        const double key = a * t[0].key + b * t[1].key + c * t[2].key;
        double& depth = nearest[static_cast<std::size_t>(row - begin) * static_cast<std::size_t>(width_) +
                                static_cast<std::size_t>(column)];
        if (!(key < depth)) continue;
        const double scale = 1 / (a * t[0].inverse + b * t[1].inverse + c * t[2].inverse);
        const double u = std::clamp(scale * (a * t[0].u + b * t[1].u + c * t[2].u), 0.0, 1.0),
                     v = std::clamp(scale * (a * t[0].v + b * t[1].v + c * t[2].v), 0.0, 1.0);
        if (grids_[index].trimmed && !Inside(index, u, v)) continue;
        depth = key;
        put(index, column, row, u, v);
      }
  }

  static double Edge(const Screen& a, const Screen& b, double x, double y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
  }

  bool Inside(std::size_t index, double u, double v) const {
    const SolverPatch& patch = scene_.patches()[index];
    const Vec2 native = scene_.Native(patch, u, v);
    return scene_.faces()[patch.face].trim->Query(native.x, native.y, 0, 0, 0).inside;
  }

  const SolverScene& scene_;
  const int width_, height_;
  const double center_x_, center_y_;
  const bool perspective_;
  const double near_;
  std::vector<Grid> grids_;
  std::vector<EyePoint> points_;
  std::uint64_t points_count_ = 0;
};

Error TooLarge(std::uint64_t bytes, std::uint64_t max_bytes) {
  return {ErrorCode::kLimitExceeded, "The map of preliminary values needs " + std::to_string(bytes >> 20) +
                                         " MB, more than the " + std::to_string(max_bytes >> 20) +
                                         " MB that are left; raise the memory limit"};
}

}  // namespace

Result<ValueMap> ValueMap::Draw(const SolverScene& scene, SolverUnit unit, const Size& size,
                                std::uint64_t max_bytes, const Execution& execution) {
  const bool by_patch = unit == SolverUnit::kPatch;
  const std::size_t surfaces = by_patch ? scene.patches().size() : scene.faces().size();
  if (size.published && surfaces > kMostPublishedSurfaces)
    return Error{ErrorCode::kBadUsage,
                 "starts: a map as published numbers at most " + std::to_string(kMostPublishedSurfaces) +
                     " surfaces, but the view has " + std::to_string(surfaces) + "; use map"};
  ValueMap map;
  map.width_ = size.width;
  map.published_ = size.published;
  const std::size_t pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  Drawing drawing(scene, size);
  const std::uint64_t own = pixels * sizeof(Pixel) + surfaces * sizeof(map.grids_[0]);
  const std::uint64_t needed = own + pixels * sizeof(double) + drawing.Plan();
  if (max_bytes > 0 && needed > max_bytes) return TooLarge(needed, max_bytes);
  map.pixels_.resize(pixels);
  map.grids_.assign(surfaces, {1, 1});
  if (!by_patch)
    for (std::size_t face = 0; face < surfaces; ++face)
      map.grids_[face] = {scene.faces()[face].columns, scene.faces()[face].rows};
  drawing.Evaluate(execution);

  // Equation 7: a parameter is stored as a share of its range.
  const double levels = size.published ? 255 : 65535;
  const auto level = [&](std::uint32_t index, double t, std::uint32_t count) {
    return static_cast<std::uint16_t>(std::floor(levels * (index + t) / count + 0.5));
  };
  const int bands = (size.height + kBandRows - 1) / kBandRows;
  ParallelFor(0, bands, [&](int band) {
    if (execution.cancelled()) return;
    drawing.DrawBand(band * kBandRows, std::min(size.height, (band + 1) * kBandRows),
                     [&](std::size_t index, int column, int row, double u, double v) {
                       const SolverPatch& patch = scene.patches()[index];
                       const auto surface = static_cast<std::uint32_t>(by_patch ? index : patch.face);
                       const auto& [columns, rows] = map.grids_[surface];
                       map.pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(size.width) +
                                   static_cast<std::size_t>(column)] = {
                           surface + 1, level(by_patch ? 0 : patch.i, u, columns),
                           level(by_patch ? 0 : patch.j, v, rows)};
                     });
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  return map;
}

std::optional<SolverStart> ValueMap::At(int column, int row) const {
  const Pixel& pixel = pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                               static_cast<std::size_t>(column)];
  if (pixel.number == 0) return std::nullopt;
  // Equations 5 and 6, or 8.
  const std::uint32_t surface = pixel.number - 1;
  const auto& [columns, rows] = grids_[surface];
  const double levels = published_ ? 255 : 65535;
  return SolverStart{
      surface, pixel.u / levels * columns, pixel.v / levels * rows, 0, double(columns), 0, double(rows),
      true};
}

std::uint64_t ValueMap::bytes() const {
  return pixels_.size() * sizeof(Pixel) + grids_.size() * sizeof(grids_[0]);
}

}  // namespace facetless
