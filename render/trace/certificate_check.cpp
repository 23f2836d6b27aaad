#include "render/trace/certificate_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/base/parallel.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

constexpr double kEpsilon = 0x1p-53;
// The rounding of a placed and projected point, in units of roundoff: it takes a few sums of three products
// each.
constexpr double kPlacingUnits = 32;
// The derivatives at the stated root are used for all points within its error, where they vary by less than
// this factor.
constexpr double kDerivativeSlack = 2;
// Pieces narrower than this many pixels are left to Newton's method.
constexpr double kNewtonPixels = 1.0 / 4;
constexpr int kNewtonSteps = 12;
constexpr int kMostHalvings = 96;
// The conditions for a certain hit: the least area that the tangents span on the screen, as a share of the
// largest possible area; the least distance from the border of the patch, in Bézier parameters; the largest
// residual, in pixels.
constexpr double kLeastSine = 1e-2, kBorderShare = 1e-6, kResidualPixels = 1e-7;
// A hit counts as nearer than another only if, after all errors, it is nearer by this share of the model's
// diagonal.
constexpr double kDepthShare = 1e-9;
// The widest band around an edge, in gaps, for grazing rays.
constexpr double kBandScale = 64;

// Values and first derivatives of the Bernstein polynomials of one degree.
struct Basis {
  std::array<double, kMaxDegree + 1> value, slope;
};

void Evaluate(int degree, double t, Basis* basis) {
  // Raise the degree one by one; the step before the last gives the derivatives.
  std::array<double, kMaxDegree + 1>& b = basis->value;
  b[0] = 1;
  for (int n = 1; n <= degree; ++n) {
    if (n == degree) {
      basis->slope[0] = -degree * b[0];
      for (int i = 1; i < n; ++i) basis->slope[i] = degree * (b[i - 1] - b[i]);
      basis->slope[n] = degree * b[n - 1];
    }
    b[n] = t * b[n - 1];
    for (int i = n - 1; i > 0; --i) b[i] = (1 - t) * b[i] + t * b[i - 1];
    b[0] = (1 - t) * b[0];
  }
}

// A point of a patch and its derivatives with respect to the Bézier parameters, mm, in part coordinates.
struct CheckedPoint {
  Vec3 point, du, dv;
};

CheckedPoint Evaluate(const Surface& surface, const Vec4* points, double u, double v) {
  Basis bu, bv;
  Evaluate(surface.degree_u, u, &bu);
  Evaluate(surface.degree_v, v, &bv);
  Vec4 value, by_u, by_v;
  for (int i = 0; i <= surface.degree_u; ++i) {
    Vec4 row, slope;
    for (int j = 0; j <= surface.degree_v; ++j) {
      row = row + bv.value[j] * *points;
      slope = slope + bv.slope[j] * *points;
      ++points;
    }
    value = value + bu.value[i] * row;
    by_u = by_u + bu.slope[i] * row;
    by_v = by_v + bu.value[i] * slope;
  }
  const double inverse = 1 / value.w;
  const Vec3 point{value.x * inverse, value.y * inverse, value.z * inverse};
  const auto derivative = [&](const Vec4& d) {
    return inverse * Vec3{d.x - point.x * d.w, d.y - point.y * d.w, d.z - point.z * d.w};
  };
  return {point, derivative(by_u), derivative(by_v)};
}

double LargestCoordinate(Vec3 p) {
  return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
}

Vec3 TranslationOf(const Placement& placement) {
  return {placement.m[0][3], placement.m[1][3], placement.m[2][3]};
}

// The length of the longest image of an axis unit vector under the placement, times √3. This bounds the image
// of any unit vector.
double PlacementScaleBound(const Placement& placement) {
  return std::sqrt(3.0) * std::max({Length(placement.Vector({1, 0, 0})), Length(placement.Vector({0, 1, 0})),
                                    Length(placement.Vector({0, 0, 1}))});
}

// The rounding error of a placed point of a patch, relative to the eye, mm.
double PlacedPointRounding(const Surface& surface, double face_size, const Placement& placement,
                           const CameraFrame& frame) {
  const double scale = PlacementScaleBound(placement);
  const double size =
      scale * face_size + LargestCoordinate(TranslationOf(placement)) + LargestCoordinate(frame.eye);
  return kEpsilon * (kPlacingUnits + 8 * (surface.degree_u + surface.degree_v)) * size;
}

// A control point relative to a ray: its distances from two planes through the ray, times its weight on the
// screen; that weight; and its depth times the weight of the surface.
struct SeenPoint {
  double across, down, scale, depth, weight;
};

// A piece of a patch.
struct SeenPiece {
  std::vector<SeenPoint> points;
  double u = 0, v = 0, size_u = 1, size_v = 1;
  int level = 0;
};

std::vector<SeenPoint> SeenFromRay(const CameraFrame& frame, const Vec4* points, std::size_t count,
                                   const Placement& placement, double x, double y) {
  const Vec3 shift = TranslationOf(placement) - frame.eye;
  std::vector<SeenPoint> seen;
  seen.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 p = placement.Vector({points[k].x, points[k].y, points[k].z}) + points[k].w * shift;
    const double depth = Dot(p, frame.forward);
    const double scale = frame.projection == Projection::kPerspective ? depth : points[k].w;
    seen.push_back({Dot(p, frame.right) / frame.pixel_x - (x - frame.center_x) * scale,
                    Dot(p, frame.down) / frame.pixel_y - (y - frame.center_y) * scale, scale, depth,
                    points[k].w});
  }
  return seen;
}

struct SeenBox {
  explicit SeenBox(const std::vector<SeenPoint>& points) {
    for (const SeenPoint& p : points) {
      across_low = std::min(across_low, p.across);
      across_high = std::max(across_high, p.across);
      down_low = std::min(down_low, p.down);
      down_high = std::max(down_high, p.down);
      least_scale = std::min(least_scale, p.scale);
    }
  }
  bool HoldsRay() const { return !(across_low > 0 || across_high < 0 || down_low > 0 || down_high < 0); }
  double width() const { return std::max(across_high - across_low, down_high - down_low); }

  double across_low = INFINITY, across_high = -INFINITY, down_low = INFINITY, down_high = -INFINITY;
  double least_scale = INFINITY;
};

bool AllFarther(const std::vector<SeenPoint>& points, double depth) {
  return std::all_of(points.begin(), points.end(),
                     [&](const SeenPoint& p) { return p.depth > depth * p.weight; });
}

bool AllNearer(const std::vector<SeenPoint>& points, double depth) {
  return std::all_of(points.begin(), points.end(),
                     [&](const SeenPoint& p) { return p.depth <= depth * p.weight; });
}

SeenPoint Middle(const SeenPoint& a, const SeenPoint& b) {
  return {0.5 * (a.across + b.across), 0.5 * (a.down + b.down), 0.5 * (a.scale + b.scale),
          0.5 * (a.depth + b.depth), 0.5 * (a.weight + b.weight)};
}

// Returns whether the image of the piece is longer along u.
bool IsLongerAlongU(const SeenPiece& piece, int degree_u, int degree_v) {
  double along_u = 0, along_v = 0;
  const auto longest = [](double so_far, const SeenPoint& a, const SeenPoint& b) {
    return std::max({so_far, std::fabs(a.across - b.across), std::fabs(a.down - b.down)});
  };
  const int stride = degree_v + 1;
  for (int k = 0; k <= degree_u; ++k) {
    for (int l = 0; l <= degree_v; ++l) {
      const SeenPoint& here = piece.points[k * stride + l];
      if (k < degree_u) along_u = longest(along_u, here, piece.points[(k + 1) * stride + l]);
      if (l < degree_v) along_v = longest(along_v, here, piece.points[k * stride + l + 1]);
    }
  }
  return degree_u * along_u > degree_v * along_v;
}

// Halves along the direction in which the image is longer. `low` and `high` are both the piece, and become its
// halves.
void Halve(int degree_u, int degree_v, SeenPiece* low, SeenPiece* high) {
  const bool along_u = IsLongerAlongU(*high, degree_u, degree_v);
  const int stride = degree_v + 1;
  const int degree = along_u ? degree_u : degree_v, lines = along_u ? degree_v : degree_u;
  const int step = along_u ? stride : 1, next_line = along_u ? 1 : stride;
  for (int line = 0; line <= lines; ++line) {
    SeenPoint* work = high->points.data() + line * next_line;
    for (int level = 1; level <= degree; ++level) {
      for (int k = 0; k <= degree - level; ++k) work[k * step] = Middle(work[k * step], work[(k + 1) * step]);
      low->points[line * next_line + level * step] = work[0];
    }
  }
  low->level = ++high->level;
  if (along_u) {
    low->size_u = high->size_u = 0.5 * high->size_u;
    high->u += low->size_u;
  } else {
    low->size_v = high->size_v = 0.5 * high->size_v;
    high->v += low->size_v;
  }
}

}  // namespace

struct CertificateCheck::Budget {
  int pieces = kMaxCheckedPieces;
};

CertificateCheck::CertificateCheck(const Scene::Data& scene, const CameraFrame& frame)
    : scene_(scene), frame_(frame) {
  const Model& model = *scene.model;
  face_sizes_.reserve(model.faces.size());
  for (const FaceData& face : scene.faces)
    face_sizes_.push_back(std::max(LargestCoordinate(face.bounds.low), LargestCoordinate(face.bounds.high)));
  first_ball_.reserve(model.faces.size());
  for (const Face& face : model.faces) {
    first_ball_.push_back(balls_.size());
    AddBalls(model.surfaces[face.surface]);
  }
  boxes_.resize(model.PlacedFaceCount());
  ParallelFor(std::size_t{0}, model.instances.size(), [&](std::size_t i) {
    const Instance& instance = model.instances[i];
    for (const PlacedFace placed : WalkPlacedFaces(model, instance))
      boxes_[placed.id] = ProjectBox(scene.faces[placed.face].bounds, instance.placement);
  });
}

CertificateCheck::FaceBox CertificateCheck::ProjectBox(const Box3& box, const Placement& placement) const {
  FaceBox image{INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY};
  bool in_front = true;
  for (int corner = 0; corner < 8; ++corner) {
    const PixelPoint p = Project(
        frame_, placement.Point({corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                 corner & 4 ? box.high.z : box.low.z}));
    in_front = in_front && (frame_.projection == Projection::kOrthographic || p.depth > frame_.near_mm);
    image.x_low = std::min(image.x_low, p.x);
    image.x_high = std::max(image.x_high, p.x);
    image.y_low = std::min(image.y_low, p.y);
    image.y_high = std::max(image.y_high, p.y);
    image.near_depth = std::min(image.near_depth, p.depth);
  }
  // The image of a box that crosses the eye plane may be anywhere.
  return in_front ? image : FaceBox{-INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY};
}

void CertificateCheck::AddBalls(const Surface& surface) {
  for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
    Box3 box;
    for (const Vec4& p : PatchPoints(*scene_.model, surface, patch))
      box.Add({p.x / p.w, p.y / p.w, p.z / p.w});
    balls_.push_back({box.center(), 0.5 * box.diagonal()});
  }
}

bool CertificateCheck::RootHolds(const StatedRoot& root) const {
  const Model& model = *scene_.model;
  const Surface& surface = model.surfaces[model.faces[root.face].surface];
  const Placement& placement = model.instances[root.instance].placement;
  const CheckedPoint at = Evaluate(surface, PatchPoints(model, surface, root.patch).data(), root.u, root.v);
  const PixelPoint seen = Project(frame_, placement.Point(at.point));

  // Bound how far the surface point moves within the error of the root, and add the rounding of this
  // computation.
  const double error_u = root.error_u + 4 * kEpsilon, error_v = root.error_v + 4 * kEpsilon;
  const double moved = kDerivativeSlack * (Length(placement.Vector(at.du)) * error_u +
                                           Length(placement.Vector(at.dv)) * error_v);
  const double reach = moved + PlacedPointRounding(surface, face_sizes_[root.face], placement, frame_);
  const bool perspective = frame_.projection == Projection::kPerspective;
  const double mm_per_px = std::min(frame_.pixel_x, frame_.pixel_y) * (perspective ? seen.depth : 1);
  // In perspective views, the pixel coordinates also change with the depth.
  const double off_axis = perspective ? 1 + std::hypot((seen.x - frame_.center_x) * frame_.pixel_x,
                                                       (seen.y - frame_.center_y) * frame_.pixel_y)
                                      : 1;
  const double pixel_reach =
      reach * off_axis / mm_per_px + 16 * kEpsilon * (frame_.center_x + frame_.center_y);
  return std::fabs(seen.x - root.x) <= pixel_reach && std::fabs(seen.y - root.y) <= pixel_reach &&
         std::fabs(seen.depth - root.depth) <= root.depth_error + reach;
}

RayCheck CertificateCheck::CheckRay(double x, double y, double depth, double depth_error) const {
  const Model& model = *scene_.model;
  Budget budget;
  const Ray ray = PixelRay(frame_, x, y);
  const Vec3 along = Normalized(ray.direction);
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    const Instance& instance = model.instances[i];
    const double scale = PlacementScaleBound(instance.placement);
    for (const auto [placed_face, face] : WalkPlacedFaces(model, instance)) {
      const FaceBox& box = boxes_[placed_face];
      if (x < box.x_low || x > box.x_high || y < box.y_low || y > box.y_high) continue;
      const Surface& surface = model.surfaces[model.faces[face].surface];
      const double rounding = PlacedPointRounding(surface, face_sizes_[face], instance.placement, frame_);
      const double limit = depth - depth_error - rounding / kLeastSine - kDepthShare * model.Diagonal();
      if (box.near_depth > limit) continue;
      for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
        if (scene_.faces[face].patches[patch] == RectClass::kOutside) continue;
        const PatchBall& ball = balls_[first_ball_[face] + patch];
        const Vec3 to_center = instance.placement.Point(ball.center) - ray.origin;
        const Vec3 off = to_center - Dot(to_center, along) * along;
        const double reach = scale * ball.radius + rounding;
        if (Dot(off, off) > reach * reach) continue;
        if (PatchMeetsRay(i, face, patch, x, y, limit, &budget)) return RayCheck::kContradicted;
        if (budget.pieces <= 0) return RayCheck::kOpen;
      }
    }
  }
  return RayCheck::kClear;
}

// Returns whether the ray certainly hits the patch at a smaller depth than `limit`. The patch is halved
// repeatedly, in coordinates relative to two planes through the ray.
bool CertificateCheck::PatchMeetsRay(std::uint32_t instance, std::uint32_t face, std::uint32_t patch,
                                     double x, double y, double limit, Budget* budget) const {
  const Model& model = *scene_.model;
  const Surface& surface = model.surfaces[model.faces[face].surface];
  const bool perspective = frame_.projection == Projection::kPerspective;
  std::vector<SeenPiece> open(1);
  open[0].points = SeenFromRay(frame_, PatchPoints(model, surface, patch).data(), surface.PointsPerPatch(),
                               model.instances[instance].placement, x, y);
  while (!open.empty()) {
    SeenPiece piece = std::move(open.back());
    open.pop_back();
    if (--budget->pieces <= 0) return false;

    // Skip a piece that lies on one side of a plane, behind the hit, or behind the eye.
    const SeenBox box(piece.points);
    if (!box.HoldsRay()) continue;
    if (AllFarther(piece.points, limit)) continue;
    if (perspective && AllNearer(piece.points, frame_.near_mm)) continue;

    // For this check, a narrow piece is assumed to have at most one root.
    if (box.least_scale > 0 && box.width() <= kNewtonPixels * box.least_scale) {
      if (IsCertainHit(instance, face, patch, piece.u + 0.5 * piece.size_u, piece.v + 0.5 * piece.size_v, x,
                       y, limit))
        return true;
      continue;
    }
    if (piece.level >= kMostHalvings) continue;
    SeenPiece low = piece;
    Halve(surface.degree_u, surface.degree_v, &low, &piece);
    open.push_back(std::move(low));
    open.push_back(std::move(piece));
  }
  return false;
}

// Newton's method on the patch itself, from (u, v).
bool CertificateCheck::IsCertainHit(std::uint32_t instance, std::uint32_t face, std::uint32_t patch, double u,
                                    double v, double x, double y, double limit) const {
  const Model& model = *scene_.model;
  const Surface& surface = model.surfaces[model.faces[face].surface];
  const Placement& placement = model.instances[instance].placement;
  const bool perspective = frame_.projection == Projection::kPerspective;
  // Take one more step after the residual is small; the remaining residual is then rounding.
  bool converged = false;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const CheckedPoint at = Evaluate(surface, PatchPoints(model, surface, patch).data(), u, v);
    const PixelPoint seen = Project(frame_, placement.Point(at.point));
    if (perspective && !(seen.depth > frame_.near_mm)) return false;
    // Compute the images of the tangents, in pixels.
    const double scale = perspective ? seen.depth : 1;
    const auto image = [&](Vec3 tangent) {
      const Vec3 d = placement.Vector(tangent);
      const double along = perspective ? Dot(d, frame_.forward) : 0;
      return Vec2{(Dot(d, frame_.right) / frame_.pixel_x - along * (seen.x - frame_.center_x)) / scale,
                  (Dot(d, frame_.down) / frame_.pixel_y - along * (seen.y - frame_.center_y)) / scale};
    };
    const Vec2 du = image(at.du), dv = image(at.dv), off{x - seen.x, y - seen.y};
    const double determinant = Cross(du, dv);
    // The hit is not certain at grazing incidence, or if the tangents are nearly parallel.
    const double area = std::fabs(determinant) * frame_.pixel_x * frame_.pixel_y * scale * scale;
    if (!(area > kLeastSine * Length(placement.Vector(at.du)) * Length(placement.Vector(at.dv))))
      return false;
    if (converged) {
      if (!(seen.depth < limit)) return false;
      // The hit must be away from the border of the patch and from every edge.
      if (!(u > kBorderShare && u < 1 - kBorderShare && v > kBorderShare && v < 1 - kBorderShare))
        return false;
      const std::uint32_t i = patch / surface.v_spans.count, j = patch % surface.v_spans.count;
      const SpanParameter& u_map = scene_.spans[surface.u_spans.first + i];
      const SpanParameter& v_map = scene_.spans[surface.v_spans.first + j];
      const TrimAnswer trim =
          scene_.faces[face].trim.Query(u_map.ToNative(u), v_map.ToNative(v), kBorderShare / u_map.Rate(u),
                                        kBorderShare / v_map.Rate(v), kBandScale);
      return trim.certain && trim.inside && trim.coedge == kNoIndex;
    }
    converged = std::fabs(off.x) <= kResidualPixels && std::fabs(off.y) <= kResidualPixels;
    u += Cross(off, dv) / determinant;
    v += Cross(du, off) / determinant;
    if (!(u > -1 && u < 2 && v > -1 && v < 2)) return false;
  }
  return false;
}

}  // namespace facetless
