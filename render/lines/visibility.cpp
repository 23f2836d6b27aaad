#include "render/lines/visibility.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "render/base/parallel.h"

namespace facetless {
namespace {

constexpr double kStep = 0.5, kSlack = 2, kShortest = 2;  // samples
// The largest slope, in samples of depth per sample. Steeper planes are ignored, as in shade/features.h,
// except for the line's own faces.
constexpr double kSteepest = 30;
// The distance beside a line at which the surface behind it is sampled, samples.
constexpr double kBeside = 2;

// Classes that are drawn paler than a silhouette.
bool IsPaler(LineClass kind) {
  return kind == LineClass::kSeam || kind == LineClass::kSmooth;
}

double Distance(const LinePoint& a, const LinePoint& b) {
  return std::sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
}

class Judge {
 public:
  Judge(const CameraFrame& frame, const SampleBuffer& samples, const CameraFrame& sample_frame,
        const std::vector<std::vector<std::uint32_t>>& joined)
      : samples_(samples),
        sample_frame_(sample_frame),
        joined_(joined),
        scale_x_(frame.pixel_x / sample_frame.pixel_x),
        scale_y_(frame.pixel_y / sample_frame.pixel_y) {}

  double scale() const { return std::max(scale_x_, scale_y_); }

  // The size of the picture, in the pixels of the lines.
  double width() const { return samples_.width / scale_x_; }
  double height() const { return samples_.height / scale_y_; }

  // Returns whether the point p of `line` is visible.
  bool Sees(const ViewLine& line, const LinePoint& p) const {
    const double x = p.x * scale_x_, y = p.y * scale_y_;
    // Outside the picture, use the nearest sample.
    const auto nearest = [](double at, int count) {
      return at > 0 ? static_cast<int>(std::min(at, count - 1.0)) : 0;
    };
    const int column = nearest(x, samples_.width), row = nearest(y, samples_.height);
    const std::size_t i = static_cast<std::size_t>(row) * samples_.width + column;
    const double depth = samples_.depth[i];
    if (!(depth < p.depth)) return true;
    const double pixel = std::max(sample_frame_.pixel_x, sample_frame_.pixel_y) *
                         (sample_frame_.projection == Projection::kPerspective ? depth : 1);
    // Continue the sample's tangent plane to the line.
    const Ray ray = PixelRay(sample_frame_, column + 0.5, row + 0.5), through = PixelRay(sample_frame_, x, y);
    const Vec3 normal{samples_.normal[i][0], samples_.normal[i][1], samples_.normal[i][2]};
    // A smooth edge may run along the contour.
    const bool contour = line.kind == LineClass::kSilhouette || IsPaler(line.kind);
    const bool own = samples_.face[i] == line.faces[0] || samples_.face[i] == line.faces[1] ||
                     (contour && Joined(line, samples_.face[i]));
    const double rate = Dot(normal, through.direction), most = own ? INFINITY : kSteepest * pixel;
    const double there = Dot(normal, ray.origin + depth * ray.direction - through.origin) / rate;
    double change = std::isfinite(there) ? std::clamp(there - depth, -most, most) : most;
    if (own) {
      // The contour may deviate from the chord of the line, away from the surface.
      const double steep = DepthSlope(normal, ray.direction);
      change = std::fabs(change) + kFlatness * scale() * steep * pixel;
    }
    return p.depth <= depth + std::max(change, 0.0) + 2 * std::fabs(change) + kSlack * pixel;
  }

  // Returns whether the line at p, with the direction (dx, dy), is an outline of the visible surface.
  bool IsOutline(const LinePoint& p, double dx, double dy) const {
    const double length = std::sqrt(dx * dx + dy * dy);
    if (!(length > 0)) return false;
    const double pixel = std::max(sample_frame_.pixel_x, sample_frame_.pixel_y) *
                         (sample_frame_.projection == Projection::kPerspective ? p.depth : 1);
    bool farther[2] = {false, false};
    for (int side = 0; side < 2; ++side) {
      const double reach = side == 0 ? kBeside : -kBeside;
      const double x = p.x * scale_x_ - reach * dy / length, y = p.y * scale_y_ + reach * dx / length;
      if (!(x >= 0 && y >= 0 && x < samples_.width && y < samples_.height)) return false;
      const std::size_t i = static_cast<std::size_t>(y) * samples_.width + static_cast<std::size_t>(x);
      // Check whether the surface is farther away than a continuous surface could be.
      farther[side] = !(samples_.depth[i] < p.depth + kBeside * kSteepest * pixel);
    }
    return farther[0] != farther[1];
  }

 private:
  bool Joined(const ViewLine& line, std::uint32_t face) const {
    for (const std::uint32_t own : line.faces)
      if (own < joined_.size() && std::binary_search(joined_[own].begin(), joined_[own].end(), face))
        return true;
    return false;
  }
  // The slope of the surface, in pixels of depth per pixel of the picture.
  static double DepthSlope(Vec3 normal, Vec3 direction) {
    const double toward = std::fabs(Dot(normal, direction)) / Length(direction);
    const double square = Dot(normal, normal) - toward * toward;
    return toward > 0 ? std::sqrt(std::max(square, 0.0)) / toward : INFINITY;
  }

  const SampleBuffer& samples_;
  const CameraFrame& sample_frame_;
  const std::vector<std::vector<std::uint32_t>>& joined_;
  const double scale_x_, scale_y_;
};

struct Run {
  std::uint8_t state;      // kVisible and kOutline
  std::size_t begin, end;  // of the points
};

constexpr std::uint8_t kVisible = 1, kOutline = 2;

std::vector<ViewLine> SplitOne(const ViewLine& line, const CameraFrame& frame, const Judge& judge) {
  // Walk along the line in steps, and record which points are original points of the line.
  std::vector<LinePoint> points;
  std::vector<bool> own;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    if (i > 0) {
      const LinePoint &a = line.points[i - 1], &b = line.points[i];
      const int steps = static_cast<int>(std::ceil(Distance(a, b) * judge.scale() / kStep));
      for (int k = 1; k < steps; ++k) {
        points.push_back(Between(frame, a, b, double(k) / steps));
        own.push_back(false);
      }
    }
    points.push_back(line.points[i]);
    own.push_back(true);
  }
  // Test between the points, because the ends of lines lie on other lines.
  std::vector<Run> runs;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const LinePoint middle = Between(frame, points[i], points[i + 1], 0.5);
    std::uint8_t state = judge.Sees(line, middle) ? kVisible : 0;
    if (state == kVisible && IsPaler(line.kind) &&
        judge.IsOutline(middle, points[i + 1].x - points[i].x, points[i + 1].y - points[i].y))
      state |= kOutline;
    if (runs.empty() || runs.back().state != state) {
      runs.push_back({state, i, i + 1});
    } else {
      runs.back().end = i + 1;
    }
  }
  // Merge short runs with their neighbours.
  const auto length_of = [&](const Run& run) {
    double length = 0;
    for (std::size_t i = run.begin; i < run.end; ++i) length += Distance(points[i], points[i + 1]);
    return length * judge.scale();
  };
  while (runs.size() > 1) {
    std::size_t shortest = 0;
    double least = INFINITY;
    for (std::size_t k = 0; k < runs.size(); ++k)
      if (const double length = length_of(runs[k]); length < least) least = length, shortest = k;
    if (least >= kShortest) break;
    // Take over the state of the longer neighbour.
    const std::size_t before = shortest > 0 ? shortest - 1 : shortest + 1,
                      after = shortest + 1 < runs.size() ? shortest + 1 : before;
    runs[shortest].state = runs[length_of(runs[after]) > length_of(runs[before]) ? after : before].state;
    std::vector<Run> merged;
    for (const Run& run : runs) {
      if (!merged.empty() && merged.back().state == run.state) {
        merged.back().end = run.end;
      } else {
        merged.push_back(run);
      }
    }
    runs = std::move(merged);
  }
  std::vector<ViewLine> out;
  for (const Run& run : runs) {
    const LineClass kind = (run.state & kOutline) != 0 ? LineClass::kSilhouette : line.kind;
    ViewLine piece{kind, (run.state & kVisible) != 0, {}};
    for (std::size_t i = run.begin; i <= run.end; ++i)
      if (own[i] || i == run.begin || i == run.end) piece.points.push_back(points[i]);
    out.push_back(std::move(piece));
  }
  return out;
}

}  // namespace

std::vector<ViewLine> SplitByVisibility(const std::vector<ViewLine>& lines, const CameraFrame& frame,
                                        const SampleBuffer& samples, const CameraFrame& sample_frame,
                                        const std::vector<std::vector<std::uint32_t>>& joined) {
  const Judge judge(frame, samples, sample_frame, joined);
  std::vector<std::vector<ViewLine>> split(lines.size());
  ParallelFor(std::size_t{0}, lines.size(), [&](std::size_t i) {
    std::vector<ViewLine> pieces;
    CutToPicture(frame, judge.width(), judge.height(), lines[i], &pieces);
    for (const ViewLine& piece : pieces)
      for (ViewLine& part : SplitOne(piece, frame, judge)) split[i].push_back(std::move(part));
  });
  std::vector<ViewLine> out;
  for (auto& pieces : split)
    out.insert(out.end(), std::make_move_iterator(pieces.begin()), std::make_move_iterator(pieces.end()));
  return out;
}

}  // namespace facetless
