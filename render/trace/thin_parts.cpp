#include "render/trace/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "render/base/parallel.h"
#include "render/model/walk.h"
#include "render/view/projection.h"

namespace facetless {
namespace {

constexpr double kChord = 2;     // curves are walked along chords of about this length, pixels
constexpr double kThinnest = 1;  // a leaf of this width is not missed by the centres, pixels
constexpr double kSlackPixels =
    2;  // a piece may be hidden if it lies deeper than the centre by more than this
constexpr double kMostChords = 1 << 13;  // of one walk; longer ones are mostly outside the window
constexpr int kMaxPoints = 256;          // the degree of an edge is 8 bits wide

// Decides about pixels that a piece passes through, and collects the marked ones.
class Marker {
 public:
  Marker(const CameraFrame& frame, const SampleBuffer& centres)
      : centres_(centres),
        center_x_(frame.center_x),
        center_y_(frame.center_y),
        perspective_(frame.projection == Projection::kPerspective),
        slack_(kSlackPixels * std::max(frame.pixel_x, frame.pixel_y)) {}

  // Starts a new piece of a face.
  void Begin(std::uint32_t placed_face) {
    face_ = placed_face;
    last_ = kNoIndex;
  }

  // Visits the pixels that the chord crosses, from border to border. The points are pixel coordinates relative to the
  // image centre. depth(t), t ∈ [0,1], is the least depth of the piece at the point from + t·(to − from).
  template <typename Depth>
  void VisitChord(Vec2 from, Vec2 to, const Depth& depth) {
    const Vec2 origin = from + Vec2{center_x_, center_y_}, along = to - from;
    double begin = 0, end = 1;
    if (!std::isfinite(origin.x + origin.y + along.x + along.y)) return;
    if (!Clip(origin.x, along.x, centres_.width, &begin, &end) ||
        !Clip(origin.y, along.y, centres_.height, &begin, &end))
      return;
    const auto pixel = [](double at, int count) {
      return std::clamp(static_cast<int>(std::floor(at)), 0, count - 1);
    };
    int column = pixel(origin.x + begin * along.x, centres_.width),
        row = pixel(origin.y + begin * along.y, centres_.height);
    const int step_x = along.x > 0 ? 1 : -1, step_y = along.y > 0 ? 1 : -1;
    for (double t = begin;;) {
      VisitPixel(column, row, depth(t));
      const double next_x = along.x != 0 ? (column + (step_x > 0) - origin.x) / along.x : INFINITY,
                   next_y = along.y != 0 ? (row + (step_y > 0) - origin.y) / along.y : INFINITY;
      t = std::min(next_x, next_y);
      if (!(t < end)) return;
      (next_x < next_y ? column : row) += next_x < next_y ? step_x : step_y;
      if (column < 0 || row < 0 || column >= centres_.width || row >= centres_.height) return;
    }
  }

  // Visits the pixels of a box in the same coordinates. A box of more than a few pixels is left out: it is none of a
  // thin part.
  void VisitBox(double x_low, double x_high, double y_low, double y_high, double depth) {
    constexpr double kMostPixels = 8;
    const double first_column = std::max(std::floor(x_low + center_x_), 0.0),
                 last_column = std::min(std::floor(x_high + center_x_), centres_.width - 1.0),
                 first_row = std::max(std::floor(y_low + center_y_), 0.0),
                 last_row = std::min(std::floor(y_high + center_y_), centres_.height - 1.0);
    if (!(last_column - first_column < kMostPixels && last_row - first_row < kMostPixels)) return;
    for (int row = static_cast<int>(first_row); row <= static_cast<int>(last_row); ++row)
      for (int column = static_cast<int>(first_column); column <= static_cast<int>(last_column); ++column)
        VisitPixel(column, row, depth);
  }

  void VisitPixel(int column, int row, double depth) {
    const auto pixel = static_cast<std::uint32_t>(row * centres_.width + column);
    if (pixel == last_) return;
    last_ = pixel;
    if (depth > centres_.depth[pixel] + slack_ * (perspective_ ? std::max(depth, 0.0) : 1)) return;
    for (int i = std::max(row - 1, 0); i <= std::min(row + 1, centres_.height - 1); ++i)
      for (int j = std::max(column - 1, 0); j <= std::min(column + 1, centres_.width - 1); ++j)
        if (centres_.face[static_cast<std::size_t>(i) * centres_.width + j] == face_) return;
    marked_.push_back(pixel);
  }

  const std::vector<std::uint32_t>& marked() const { return marked_; }

 private:
  // Cuts the interval of t to where 0 ≤ origin + t·along ≤ count. Returns false if nothing is left.
  static bool Clip(double origin, double along, double count, double* begin, double* end) {
    if (along == 0) return 0 <= origin && origin <= count;
    const double low = -origin / along, high = (count - origin) / along;
    *begin = std::max(*begin, std::min(low, high));
    *end = std::min(*end, std::max(low, high));
    return *begin < *end;
  }

  const SampleBuffer& centres_;
  const double center_x_, center_y_;
  const bool perspective_;
  const double slack_;
  std::uint32_t face_ = kNoIndex, last_ = kNoIndex;
  std::vector<std::uint32_t> marked_;
};

struct CurvePoint {
  Vec2 at;
  double
      reach;  // the depth in orthographic views, its inverse in perspective ones: linear along a line of the image
};

// The point of a projected Bézier segment, by de Casteljau's algorithm.
CurvePoint PointAt(const ViewProjection::Point* p, int degree, double t) {
  ViewProjection::Point q[kMaxPoints];
  std::copy_n(p, degree + 1, q);
  for (int last = degree; last > 0; --last)
    for (int i = 0; i < last; ++i)
      q[i] = {(1 - t) * q[i].x + t * q[i + 1].x, (1 - t) * q[i].y + t * q[i + 1].y,
              (1 - t) * q[i].w + t * q[i + 1].w, (1 - t) * q[i].q + t * q[i + 1].q};
  return {{q[0].x / q[0].w, q[0].y / q[0].w}, q[0].q / q[0].w};
}

// Walks a projected segment. Segments that reach behind the eye are left out.
void WalkSegment(const ViewProjection& projection, std::span<const Vec4> points, const SampleBuffer& centres,
                 Marker* marker) {
  ViewProjection::Point p[kMaxPoints];
  double length = 0, x_low = INFINITY, x_high = -INFINITY, y_low = INFINITY, y_high = -INFINITY;
  const int degree = static_cast<int>(points.size()) - 1;
  for (int i = 0; i <= degree; ++i) {
    p[i] = projection(points[static_cast<std::size_t>(i)]);
    if (!(p[i].w > 0)) return;
    const double x = p[i].x / p[i].w, y = p[i].y / p[i].w;
    x_low = std::min(x_low, x);
    x_high = std::max(x_high, x);
    y_low = std::min(y_low, y);
    y_high = std::max(y_high, y);
    if (i > 0) length += Length(Vec2{x - p[i - 1].x / p[i - 1].w, y - p[i - 1].y / p[i - 1].w});
  }
  const double half_x = 0.5 * centres.width, half_y = 0.5 * centres.height;
  if (x_high < -half_x || x_low > half_x || y_high < -half_y || y_low > half_y) return;
  // Evaluate the segment at some points, and walk along the chords between them.
  const int chords =
      degree == 1 ? 1 : static_cast<int>(std::clamp(std::ceil(length / kChord), 1.0, kMostChords));
  CurvePoint from = PointAt(p, degree, 0);
  for (int chord = 1; chord <= chords; ++chord) {
    const CurvePoint to = PointAt(p, degree, static_cast<double>(chord) / chords);
    marker->VisitChord(from.at, to.at, [&](double t) {
      const double reach = from.reach + t * (to.reach - from.reach);
      return projection.perspective() ? 1 / reach : reach;
    });
    from = to;
  }
}

// Walks the edges of all faces of an instance.
void WalkEdges(const Model& model, const Instance& instance, const CameraFrame& frame,
               const SampleBuffer& centres, PerThread<Marker>* markers) {
  const ViewProjection projection(frame, instance.placement);
  const Range faces = FacesOf(model, instance);
  ParallelFor(faces.first, faces.end(), [&](std::uint32_t face) {
    Marker& marker = markers->local();
    for (const Coedge& coedge : CoedgesOf(model, model.faces[face])) {
      if (coedge.edge == kNoIndex) continue;
      marker.Begin(PlacedFaceId(model, instance, face));
      for (const EdgeSegment& segment : SegmentsOf(model, model.edges[coedge.edge]))
        WalkSegment(projection, PointsOf(model, segment), centres, &marker);
    }
  });
}

// A polynomial of a leaf along one of its parameters, where the other one is 0.
template <typename Real>
double Along(const Real* plane, int degree, int stride, double t) {
  double value = plane[degree * stride];
  for (int i = degree - 1; i >= 0; --i) value = value * t + plane[i * stride];
  return value;
}

// Walks a leaf along its length, if its image is narrow. Let J be the inverse of its matrix C: its columns are the
// sides of the parallelogram that is the leaf's image, but for its bend. The pixel of (s, t) is center + J·G/W.
template <typename Real>
void WalkLeaf(const CertifiedLeaf& leaf, Marker* marker) {
  const double determinant = leaf.c11 * leaf.c22 - leaf.c12 * leaf.c21;
  const Vec2 along_s{leaf.c22 / determinant, -leaf.c21 / determinant},
      along_t{-leaf.c12 / determinant, leaf.c11 / determinant};
  const double length_s = 2 * Length(along_s), length_t = 2 * Length(along_t);
  const double length = std::max(length_s, length_t);
  if (!(4 < kThinnest * length * std::fabs(determinant))) return;  // its area is 4/|det C|
  const bool by_s = length_s > length_t;
  const int degree = by_s ? leaf.degree_u : leaf.degree_v, stride = by_s ? leaf.degree_v + 1 : 1;
  const Real* g1 = CoefficientsOf<Real>(leaf);
  const Real *g2 = g1 + leaf.points(), *w = g2 + leaf.points();
  marker->Begin(leaf.placed_face);
  const int chords =
      degree == 1 ? 1 : static_cast<int>(std::clamp(std::ceil(length / kChord), 1.0, kMostChords));
  const auto point_at = [&](double t) {
    const double weight = (leaf.flags & kLeafWeightVaries) ? Along(w, degree, stride, t) : 1;
    const double b1 = Along(g1, degree, stride, t) / weight, b2 = Along(g2, degree, stride, t) / weight;
    return Vec2{leaf.center_x, leaf.center_y} + b1 * along_s + b2 * along_t;
  };
  Vec2 from = point_at(-1);
  for (int chord = 1; chord <= chords; ++chord) {
    const Vec2 to = point_at(2.0 * chord / chords - 1);
    marker->VisitChord(from, to, [&](double) { return leaf.near_depth; });
    from = to;
  }
}

// Visits the pixels that the control points of a hard leaf with few samples span.
void WalkHardLeaf(const HardLeaf& leaf, Marker* marker) {
  if (leaf.kind != HardKind::kSubdivide || leaf.box.samples() > kHardSamples) return;
  double x_low = INFINITY, x_high = -INFINITY, y_low = INFINITY, y_high = -INFINITY;
  for (int k = 0; k < leaf.points(); ++k) {
    const double* point = leaf.net + kNetComponents * k;
    const double x = point[kX] / point[kW], y = point[kY] / point[kW];
    x_low = std::min(x_low, x);
    x_high = std::max(x_high, x);
    y_low = std::min(y_low, y);
    y_high = std::max(y_high, y);
  }
  marker->Begin(leaf.placed_face);
  marker->VisitBox(x_low, x_high, y_low, y_high, leaf.near_depth);
}

// `is_single`: the coefficients of the leaves are floats.
void WalkLeaves(const LeafSpans& leaves, bool is_single, PerThread<Marker>* markers) {
  constexpr std::size_t kBlock = 1024;
  ParallelForBlocks(0, leaves.certified.size(), kBlock, [&](std::size_t first, std::size_t last) {
    Marker& marker = markers->local();
    for (std::size_t i = first; i < last; ++i) {
      if (is_single) {
        WalkLeaf<float>(leaves.certified[i], &marker);
      } else {
        WalkLeaf<double>(leaves.certified[i], &marker);
      }
    }
  });
  ParallelForBlocks(0, leaves.hard.size(), kBlock, [&](std::size_t first, std::size_t last) {
    Marker& marker = markers->local();
    for (std::size_t i = first; i < last; ++i) WalkHardLeaf(leaves.hard[i], &marker);
  });
}

}  // namespace

void MarkThinParts(const Scene::Data& scene, const PreparedView& view, const CameraFrame& frame,
                   const SampleBuffer& centres, PixelSet* pixels) {
  PerThread<Marker> markers([&] { return Marker(frame, centres); });
  for (const Instance& instance : scene.model->instances)
    WalkEdges(*scene.model, instance, frame, centres, &markers);
  const bool is_single = view.arithmetic.is_single();
  WalkLeaves(view.tiles->leaves(), is_single, &markers);
  for (const LeafLists& lists : view.between) WalkLeaves(lists.spans(), is_single, &markers);
  for (const Marker& marker : markers)
    for (const std::uint32_t pixel : marker.marked())
      pixels->Add(static_cast<int>(pixel % static_cast<std::uint32_t>(centres.width)),
                  static_cast<int>(pixel / static_cast<std::uint32_t>(centres.width)));
}

}  // namespace facetless
