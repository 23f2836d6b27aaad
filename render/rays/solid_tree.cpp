#include "render/rays/solid_tree.h"

#include <algorithm>
#include <cmath>

#include "render/model/walk.h"
#include "render/nurbs/angle_map.h"
#include "render/trace/scene.h"

namespace facetless {
namespace {

// A piece is flat enough if its control points lie within this share of its diagonal from a bilinear patch,
// as for an arc of 11 degrees. Newton's method from the middle of such a piece then moves by less than a
// width, and the Jacobian turns by no more than that angle.
constexpr double kFlatness = 0.05;
constexpr int kMostHalvings = 12;  // of one patch, in both directions together
// A piece accepts roots up to this share of its width beyond its border. Neighbours overlap, so no root is
// lost between them.
constexpr double kOverlap = 0x1p-20;
// The number of widths by which the iterates of Newton's method may leave the piece.
constexpr double kStray = 1.5;
constexpr int kMostSteps = 12;
// A piece turns by less than 17 degrees from its middle to a corner. If the sine of the viewing angle at its
// middle is larger than this, the piece has no fold.
constexpr double kGrazing = 0.3;
constexpr int kStarts = 4;  // starting points in each direction, for a piece that may have a fold
// A root is accepted if the residual is within this share of the size of the coordinates: 2^-52, times the
// number of operations of an evaluation.
constexpr double kResidual = 0x1p-46;
constexpr std::uint32_t kPiecesPerLeaf = 4;
// The largest number of nodes on the stack: one per level of a tree that halves fewer than 2^32 pieces, plus
// two and a reserve.
constexpr int kDeepest = 40;

// A patch's net over a part of its Bézier square.
struct Net {
  int p, q;
  std::vector<Vec4> points;
  double s0 = 0, s1 = 1, t0 = 0, t1 = 1;

  Vec4& at(int k, int l) { return points[static_cast<std::size_t>(k) * (q + 1) + l]; }
  Vec3 Cartesian(int k, int l) const {
    const Vec4& h = points[static_cast<std::size_t>(k) * (q + 1) + l];
    return {h.x / h.w, h.y / h.w, h.z / h.w};
  }
};

// De Casteljau's algorithm in one direction. The lower half is returned, and the upper half replaces `net`.
Net SplitLower(Net& net, bool along_u) {
  Net lower = net;
  const int degree = along_u ? net.p : net.q, rows = along_u ? net.q : net.p;
  for (int r = 0; r <= rows; ++r) {
    const auto point = [&](Net& n, int i) -> Vec4& { return along_u ? n.at(i, r) : n.at(r, i); };
    for (int n = 0; n <= degree; ++n) {
      point(lower, n) = point(net, 0);
      for (int i = 0; i < degree - n; ++i) point(net, i) = 0.5 * (point(net, i) + point(net, i + 1));
    }
  }
  // `net` now holds the upper half, in order.
  double& low = along_u ? net.s0 : net.t0;
  double& high = along_u ? lower.s1 : lower.t1;
  high = low = 0.5 * (low + (along_u ? net.s1 : net.t1));
  return lower;
}

// The distances of the control points from the bilinear patch of the corners, along each direction, as a
// share of the diagonal.
struct Bend {
  double u = 0, v = 0;
};

Bend MeasureBend(const Net& net) {
  const double diagonal = std::max(Length(net.Cartesian(0, 0) - net.Cartesian(net.p, net.q)),
                                   Length(net.Cartesian(net.p, 0) - net.Cartesian(0, net.q)));
  Bend bend;
  for (int k = 0; k <= net.p; ++k) {
    for (int l = 0; l <= net.q; ++l) {
      const Vec3 p = net.Cartesian(k, l);
      const double s = static_cast<double>(k) / net.p, t = static_cast<double>(l) / net.q;
      bend.u = std::max(bend.u, Length(p - ((1 - s) * net.Cartesian(0, l) + s * net.Cartesian(net.p, l))));
      bend.v = std::max(bend.v, Length(p - ((1 - t) * net.Cartesian(k, 0) + t * net.Cartesian(k, net.q))));
    }
  }
  if (diagonal > 0) bend.u /= diagonal, bend.v /= diagonal;
  return bend;
}

// Returns whether origin + t·direction meets the box for a t in [low, high]. `inverse` may hold infinities.
bool Meets(const Box3& box, Vec3 origin, Vec3 inverse, double low, double high) {
  const auto slab = [&](double a, double b, double o, double i) {
    const double t0 = (a - o) * i, t1 = (b - o) * i;
    // fmin and fmax ignore the NaN of 0·∞, which occurs if the ray lies in the plane of a side.
    low = std::fmax(low, std::fmin(t0, t1));
    high = std::fmin(high, std::fmax(t0, t1));
  };
  slab(box.low.x, box.high.x, origin.x, inverse.x);
  slab(box.low.y, box.high.y, origin.y, inverse.y);
  slab(box.low.z, box.high.z, origin.z, inverse.z);
  return low <= high;
}

}  // namespace

// A ray with precomputed data for all pieces.
struct SolidTree::Probe {
  Vec3 origin, direction, inverse, unit, across, above;  // unit: along the direction; the others across it
  double t_least;
};

SolidTree::SolidTree(const Scene& scene, const std::vector<SurfaceEval>& surfaces,
                     const std::vector<std::uint32_t>& faces)
    : scene_(scene.data()), surfaces_(surfaces) {
  for (std::uint32_t face : faces) AddFace(face);
  if (!pieces_.empty()) Build();
}

void SolidTree::AddFace(std::uint32_t face) {
  const Model& model = *scene_.model;
  const Surface& surface = model.surfaces[model.faces[face].surface];
  const FaceData& data = scene_.faces[face];
  const double margin = kOverlap * data.bounds.diagonal();
  std::vector<Net> stack;
  for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
    if (data.patches[patch] == RectClass::kOutside) continue;
    const Span& u_span = model.spans[surface.u_spans.first + patch / surface.v_spans.count];
    const Span& v_span = model.spans[surface.v_spans.first + patch % surface.v_spans.count];
    const std::span<const Vec4> points = PatchPoints(model, surface, patch);
    stack.push_back({surface.degree_u, surface.degree_v, {points.begin(), points.end()}});
    while (!stack.empty()) {
      Net net = std::move(stack.back());
      stack.pop_back();
      Piece piece;
      piece.face = face;
      piece.u0 = BezierToNative(u_span, net.s0);
      piece.u1 = BezierToNative(u_span, net.s1);
      piece.v0 = BezierToNative(v_span, net.t0);
      piece.v1 = BezierToNative(v_span, net.t1);
      const RectClass where = data.trim.Classify(piece.u0, piece.u1, piece.v0, piece.v1);
      if (where == RectClass::kOutside) continue;
      const Bend bend = MeasureBend(net);
      const double least = std::min(net.s1 - net.s0, net.t1 - net.t0);
      if (std::max(bend.u, bend.v) > kFlatness && least > 1.0 / (1 << (kMostHalvings / 2))) {
        Net lower = SplitLower(net, bend.u >= bend.v);
        stack.push_back(std::move(net));
        stack.push_back(std::move(lower));
        continue;
      }
      piece.whole = where == RectClass::kInside;
      for (int k = 0; k <= net.p; ++k)
        for (int l = 0; l <= net.q; ++l) piece.box.Add(net.Cartesian(k, l));
      piece.box = {piece.box.low - Vec3{margin, margin, margin},
                   piece.box.high + Vec3{margin, margin, margin}};
      pieces_.push_back(piece);
    }
  }
}

void SolidTree::Build() {
  // Halve the number of pieces along the longest side of the box of their centres, so that the tree is
  // balanced.
  nodes_.push_back({{}, 0, static_cast<std::uint32_t>(pieces_.size())});
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    Box3 box, centers;
    const std::uint32_t first = nodes_[n].first, count = nodes_[n].count;
    for (std::uint32_t i = first; i < first + count; ++i) {
      box.Add(pieces_[i].box.low), box.Add(pieces_[i].box.high);
      centers.Add(pieces_[i].box.center());
    }
    nodes_[n].box = box;
    if (count <= kPiecesPerLeaf) continue;
    const Vec3 size = centers.high - centers.low;
    double Vec3::*axis = size.x >= size.y && size.x >= size.z ? &Vec3::x
                         : size.y >= size.z                   ? &Vec3::y
                                                              : &Vec3::z;
    const auto begin = pieces_.begin() + first;
    std::stable_sort(begin, begin + count, [&](const Piece& a, const Piece& b) {
      return a.box.center().*axis < b.box.center().*axis;
    });
    const std::uint32_t lower = count / 2;
    nodes_[n].first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[n].count = 0;
    nodes_.push_back({{}, first, lower});
    nodes_.push_back({{}, first + lower, count - lower});
  }
  bounds_ = nodes_[0].box;
}

void SolidTree::Solve(const Piece& piece, const Probe& probe, std::optional<SolidHit>& nearest) const {
  // If the ray meets the piece steeply, there is at most one root, and Newton's method finds it from the
  // middle.
  const SurfaceEval& surface = surfaces_[piece.face];
  const SurfacePoint middle = surface.First(0.5 * (piece.u0 + piece.u1), 0.5 * (piece.v0 + piece.v1));
  const Vec3 normal = Cross(middle.du, middle.dv);
  if (std::fabs(Dot(normal, probe.unit)) > kGrazing * Length(normal)) {
    SolveFrom(piece, probe, {0.5, 0.5}, nearest);
    return;
  }
  // Along a fold, or at a pole, there may be two roots, between which Newton's method is unstable: start from
  // many points.
  for (int i = 0; i < kStarts; ++i)
    for (int j = 0; j < kStarts; ++j)
      SolveFrom(piece, probe, {(i + 0.5) / kStarts, (j + 0.5) / kStarts}, nearest);
}

// Runs Newton's method from a point of the piece, given in shares of its widths. Stores the root if it is
// accepted and is the nearest so far.
void SolidTree::SolveFrom(const Piece& piece, const Probe& probe, Vec2 start,
                          std::optional<SolidHit>& nearest) const {
  const SurfaceEval& surface = surfaces_[piece.face];
  const double width_u = piece.u1 - piece.u0, width_v = piece.v1 - piece.v0;
  const double enough = kResidual * (surface.magnitude() + Length(probe.origin));
  double u = piece.u0 + start.x * width_u, v = piece.v0 + start.y * width_v;
  bool solved = false;
  for (int step = 0; step < kMostSteps; ++step) {
    const SurfacePoint at = surface.First(u, v);
    const Vec3 rest = at.position - probe.origin;
    const double fx = Dot(rest, probe.across), fy = Dot(rest, probe.above);
    solved = std::fabs(fx) <= enough && std::fabs(fy) <= enough;
    if (solved) break;
    const double xu = Dot(at.du, probe.across), xv = Dot(at.dv, probe.across);
    const double yu = Dot(at.du, probe.above), yv = Dot(at.dv, probe.above);
    const double determinant = xu * yv - xv * yu;
    u += (fy * xv - fx * yv) / determinant;
    v += (fx * yu - fy * xu) / determinant;
    // Written in this form, the condition also ends the search if the step is NaN.
    if (!(u > piece.u0 - kStray * width_u && u < piece.u1 + kStray * width_u &&
          v > piece.v0 - kStray * width_v && v < piece.v1 + kStray * width_v))
      return;
  }
  if (!solved) return;

  // Accept the root only in its own piece, beyond t_least, and inside the trimmed face.
  const double slop_u = kOverlap * width_u, slop_v = kOverlap * width_v;
  if (!(u >= piece.u0 - slop_u && u <= piece.u1 + slop_u && v >= piece.v0 - slop_v && v <= piece.v1 + slop_v))
    return;
  u = std::clamp(u, surface.u_begin(), surface.u_end());
  v = std::clamp(v, surface.v_begin(), surface.v_end());
  const Vec3 rest = surface.Position(u, v) - probe.origin;
  const double t = Dot(rest, probe.direction) / Dot(probe.direction, probe.direction);
  if (!(t > probe.t_least) || (nearest && !(t < nearest->t))) return;
  if (!piece.whole) {
    const TrimAnswer answer = scene_.faces[piece.face].trim.Query(u, v, slop_u, slop_v);
    if (!answer.inside && answer.coedge == kNoIndex && answer.certain) return;
  }
  nearest = SolidHit{t, piece.face, u, v};
}

std::optional<SolidHit> SolidTree::Nearest(Vec3 origin, Vec3 direction, double t_least) const {
  std::optional<SolidHit> nearest;
  if (nodes_.empty()) return nearest;
  Probe probe{
      origin, direction, {1 / direction.x, 1 / direction.y, 1 / direction.z}, Normalized(direction), {},
      {},     t_least};
  const Vec3 unit = probe.unit;
  const Vec3 size{std::fabs(unit.x), std::fabs(unit.y), std::fabs(unit.z)};
  const Vec3 helper = size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                      : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                           : Vec3{0, 0, 1};
  probe.across = Normalized(Cross(unit, helper));
  probe.above = Cross(unit, probe.across);

  std::uint32_t stack[kDeepest];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    if (!Meets(node.box, origin, probe.inverse, t_least, nearest ? nearest->t : INFINITY)) continue;
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
        if (Meets(pieces_[i].box, origin, probe.inverse, t_least, nearest ? nearest->t : INFINITY))
          Solve(pieces_[i], probe, nearest);
      continue;
    }
    // Put the child whose middle comes first on top of the stack.
    const bool swap =
        Dot(nodes_[node.first].box.center() - nodes_[node.first + 1].box.center(), direction) > 0;
    stack[top++] = swap ? node.first : node.first + 1;
    stack[top++] = swap ? node.first + 1 : node.first;
  }
  return nearest;
}

}  // namespace facetless
