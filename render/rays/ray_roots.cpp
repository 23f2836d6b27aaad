#include "render/rays/ray_roots.h"

#include <algorithm>
#include <cmath>

#include "render/model/walk.h"
#include "render/trace/hit_geometry.h"
#include "render/trace/projected_edges.h"

namespace facetless {
namespace {

constexpr double kEpsilon = 0x1p-53;
// As for pictures (trace/tile_tracer.cpp): with a larger factor, the band of an edge would cover the whole face.
constexpr double kMaxBandScale = 64;
// The start's own root is recognised if its reach is at most this share of its piece, by which pieces are enlarged.
constexpr double kMostReach = kEnlarged - 1;
// Rounding of a point that SurfaceEval evaluates and a placement moves, in units of roundoff of the coordinates. The
// polynomials of one degree need a few operations for each control point.
constexpr double kPointUnits = 64;
// Rounding of native parameters and their way to a piece's own, in units of roundoff.
constexpr double kParameterUnits = 16;
// The square of the direction's length is 1 within 32 units of roundoff (ExactRays checks this); the rest is for
// arithmetic.
constexpr double kDistanceUnits = 64;

double Size(Vec3 v) {
  return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

// The range of distances of a projected net, including its errors; everything if a weight may vanish.
struct Distances {
  double near = INFINITY, far = -INFINITY;
};

Distances MeasureDistances(const BezierNet& net) {
  Distances range;
  double weight = INFINITY;
  for (int i = 0; i < net.points(); ++i) {
    const double distance = net.at(i, kQ) / net.at(i, kW);
    range.near = std::min(range.near, distance);
    range.far = std::max(range.far, distance);
    weight = std::min(weight, net.at(i, kW));
  }
  const double size = std::max(std::fabs(range.near), std::fabs(range.far));
  const double error =
      NetDepthError(net, {false, true, true}, size, weight) + kDistanceUnits * kEpsilon * size;
  if (!(error < INFINITY)) return {-INFINITY, INFINITY};
  return {range.near - error, range.far + error};
}

}  // namespace

std::uint32_t RayScene::FaceOf(std::uint32_t placed_face) const {
  const Instance& instance = model().instances[instance_of_face[placed_face]];
  return model().parts[instance.part].faces.first + placed_face - instance.first_placed_face;
}

// A piece on the ray: its projected net as a leaf, and its place in its face.
struct RayRoots::Site {
  const SpacePiece& piece;
  const Surface& surface;
  HardLeaf leaf;
  ParameterRect rect;
  PatchBounds bounds;
  const Span *u_span, *v_span;
  const SpanParameter *u_map, *v_map;
  std::uint32_t instance;

  double U(double s) const { return std::clamp(rect.U(s), bounds.u_low, bounds.u_high); }
  double V(double t) const { return std::clamp(rect.V(t), bounds.v_low, bounds.v_high); }
};

RayRoots::RayRoots(const RayScene& scene) : scene_(scene), solver_(*scene.nets), frame_({}, {0, 0, 1}, 1) {}

void RayRoots::Begin(const RayStart& start, bool same_start, Vec3 direction, double length) {
  if (!same_start) PrepareStart(start);
  frame_ = RayFrame(start.position, direction, scene_.pixel);
  length_ = limit_ = length;
  blocked_ = false;
  awaiting_own_ = start_face_ != kNoIndex && scene_.shown[start_face_];
  instance_ = kNoIndex;
  work_ = {};
  roots_.clear();
  questions_.clear();
}

void RayRoots::PrepareStart(const RayStart& start) {
  start_face_ = start.placed_face;
  start_error_ = 0;
  if (start_face_ == kNoIndex) return;
  start_u_ = start.u;
  start_v_ = start.v;
  const SurfaceEval& surface = scene_.surfaces[scene_.FaceOf(start_face_)];
  const PlacedPart& part = scene_.parts[scene_.instance_of_face[start_face_]];
  const Vec3 local = surface.Position(start.u, start.v), own = part.placement().Point(local);
  const auto& m = part.placement().m;
  double growth = 0;
  for (int row = 0; row < 3; ++row)
    growth = std::max(growth, std::fabs(m[row][0]) + std::fabs(m[row][1]) + std::fabs(m[row][2]));
  const double rounding =
      kPointUnits * kEpsilon * (growth * surface.magnitude() + Size({m[0][3], m[1][3], m[2][3]}) + Size(own));
  start_error_ = Length(own - start.position) + rounding;
  if (!std::isfinite(start_error_)) start_error_ = INFINITY;
}

void RayRoots::Examine(std::uint32_t instance, const SpacePiece& piece) {
  // Project the piece.
  if (instance != instance_ || projection_.empty()) {
    projection_.clear();
    projection_.emplace_back(frame_, scene_.parts[instance]);
    instance_ = instance;
  }
  const Model& model = scene_.model();
  const Surface& surface = model.surfaces[model.faces[piece.face].surface];
  net_.SetDegrees(surface.degree_u, surface.degree_v);
  BezierNet& net = net_.net;
  projection_[0].Project(piece, surface.rational, scene_.pieces.origin(piece.face), &net);
  work_.Spend(net.points());

  // Most candidates are beside the ray, behind it or too far away.
  if (scene_.nets->residual(net, 0, 0).empty) return;
  const Distances range = MeasureDistances(net);
  if (range.far < -2 * start_error_ || range.near > limit_) return;

  const Instance& placed = model.instances[instance];
  const std::uint32_t i = piece.place.patch / surface.v_spans.count,
                      j = piece.place.patch % surface.v_spans.count;
  Site site{piece,
            surface,
            {},
            {},
            SetBoxBounds(scene_.scene->faces[piece.face], surface, i, j),
            &model.spans[surface.u_spans.first + i],
            &model.spans[surface.v_spans.first + j],
            &scene_.scene->spans[surface.u_spans.first + i],
            &scene_.scene->spans[surface.v_spans.first + j],
            instance};
  site.rect = RectOf(piece.place, site.bounds);
  HardLeaf& leaf = site.leaf;
  leaf.placed_face = placed.first_placed_face + piece.face - model.parts[placed.part].faces.first;
  leaf.degree_u = surface.degree_u;
  leaf.degree_v = surface.degree_v;
  leaf.flags = FlagsOf({false, surface.rational, true});
  leaf.borders = BordersOf(site.rect);
  leaf.net = net.value;
  std::copy_n(net.error, int{kNetComponents}, leaf.error);
  leaf.place = piece.place;

  found_.clear();
  const std::uint8_t doubt = solver_.Solve(leaf, site.rect, 0, 0, limit_, &work_, &found_, /*whole=*/true);
  // The piece is not decided, for example because the ray runs along the plane of its own start. This is a doubt.
  if (doubt != 0) questions_.push_back({std::max(range.near, 0.0), doubt});
  for (const FallbackRoot& root : found_) AddRoot(site, root);
}

void RayRoots::AddRoot(const Site& site, const FallbackRoot& found) {
  RayRoot root;
  root.distance = found.hit.depth;
  root.error = found.hit.error + kDistanceUnits * kEpsilon * std::fabs(found.hit.depth);
  const Own own = IsOwnRoot(site, found);
  if (own != Own::kNo) FindOwnRoot();
  if (own == Own::kYes) return;
  if (root.distance + root.error <= 0 || root.distance - root.error > length_) return;
  root.placed_face = site.leaf.placed_face;
  root.patch = site.piece.place.patch;
  root.u = site.u_map->ToNative(site.U(found.hit.s));
  root.v = site.v_map->ToNative(site.V(found.hit.t));
  root.orientation = found.proven ? found.jacobian_sign : 0;
  const HitGeometry geometry = EvaluateHit(site.leaf, found.hit.s, found.hit.t, 0, 0, frame_.camera);
  root.normal = geometry.normal;
  if (!site.piece.whole) Trim(site, found, geometry.cosine, &root);
  // A root that is proven to be trimmed away is none.
  if (!root.inside && root.doubt == 0) return;
  if (own == Own::kUnknown) {
    root.doubt |= kDoubtSilhouette;
    root.inside = false;
  }
  if (!(root.distance - root.error > 0)) {
    root.doubt |= kDoubtCoincident;
    root.inside = false;
  }
  if (!(root.distance + root.error < length_)) {
    root.doubt |= kDoubtCoincident;
    root.inside = root.inside && root.distance < length_;
  }
  if (!found.proven) root.doubt |= geometry.singular ? kDoubtPole : kDoubtSilhouette;
  // Without a proof, the best answer for a root within the error of the start is that it is the start's own.
  const bool unclear = root.doubt != 0 || awaiting_own_;
  if (unclear && root.placed_face == start_face_ && root.distance * geometry.cosine <= 2 * start_error_)
    root.inside = false;
  root.border = found.on_border;
  if (root.border) PairWithNeighbour(&root);
  roots_.push_back(root);
  if (!root.border) Settle(root);
}

RayRoots::Own RayRoots::IsOwnRoot(const Site& site, const FallbackRoot& root) const {
  if (site.leaf.placed_face != start_face_) return Own::kNo;
  // The start's parameters in the piece, in the turn of a periodic surface that is nearest.
  const auto own_parameter = [](double native, double period, const Span& span, const SpanParameter& map,
                                double middle, double half, double* rounding) {
    const double width = span.end - span.begin, center = 0.5 * (span.begin + span.end);
    if (period > 0) native -= period * std::floor((native - center) / period + 0.5);
    // The map is not valid farther outside of the span than a piece of it may reach.
    if (!(std::fabs(native - center) <= 0.75 * width)) return double(INFINITY);
    *rounding = kParameterUnits * kEpsilon * (std::fabs(span.begin) + std::fabs(span.end) + period + width) /
                (width * half);
    return (map.ToBezier(native) - middle) / half;
  };
  double rounding_s = 0, rounding_t = 0;
  const double s = own_parameter(start_u_, site.surface.period_u, *site.u_span, *site.u_map, site.rect.u_mid,
                                 site.rect.u_half, &rounding_s);
  const double t = own_parameter(start_v_, site.surface.period_v, *site.v_span, *site.v_map, site.rect.v_mid,
                                 site.rect.v_half, &rounding_t);
  const double off_s = std::fabs(root.hit.s - s), off_t = std::fabs(root.hit.t - t);
  if (!root.proven) {
    // The start may be the point at which the ray is tangent to the surface.
    const bool near = off_s <= 2 * root.error_s + rounding_s && off_t <= 2 * root.error_t + rounding_t;
    return near ? Own::kUnknown : Own::kNo;
  }
  const double moved = start_error_ / scene_.pixel;
  const double reach_s = root.error_s + rounding_s + root.spread_s * moved;
  const double reach_t = root.error_t + rounding_t + root.spread_t * moved;
  if (!(off_s <= reach_s && off_t <= reach_t)) return Own::kNo;
  return reach_s <= kMostReach * root.half_s && reach_t <= kMostReach * root.half_t ? Own::kYes
                                                                                    : Own::kUnknown;
}

void RayRoots::Trim(const Site& site, const FallbackRoot& found, double cosine, RayRoot* root) const {
  const FaceData& face = scene_.scene->faces[site.piece.face];
  const double error_u = found.error_s * site.rect.u_half / site.u_map->Rate(site.U(found.hit.s));
  const double error_v = found.error_t * site.rect.v_half / site.v_map->Rate(site.V(found.hit.t));
  const double scale = cosine > 0 ? std::min(kMaxBandScale, 1 / cosine) : kMaxBandScale;
  const TrimAnswer answer = face.trim.Query(root->u, root->v, error_u, error_v, scale);

  // In the band of an edge, the edge itself decides for both faces.
  if (answer.coedge != kNoIndex && root->orientation != 0) {
    const ProjectedEdges edges(scene_.model(), scene_.model().instances[site.instance].placement,
                               frame_.camera);
    const EdgeDecision decision =
        DecideAtEdge(scene_.model(), edges, answer, 0, 0, scene_.pixel, root->orientation > 0);
    if (decision.verdict != EdgeVerdict::kUnknown) {
      if (!decision.proven) root->doubt |= kDoubtTrim;
      root->inside = root->inside && decision.verdict == EdgeVerdict::kKeep;
      return;
    }
  }
  // A closed surface without trimming continues across its border, where its neighbour decides.
  if (!answer.certain && !(face.trim.whole() && found.on_border)) root->doubt |= kDoubtTrim;
  root->inside = root->inside && (answer.inside || (face.trim.whole() && found.on_border));
}

void RayRoots::PairWithNeighbour(RayRoot* root) {
  for (RayRoot& other : roots_) {
    if (!other.border || other.placed_face != root->placed_face || other.patch == root->patch ||
        !other.inside || !root->inside || other.orientation * root->orientation <= 0 ||
        std::fabs(other.distance - root->distance) > other.error + root->error)
      continue;
    // Exactly one of the two patches contains the root, and both roots are at the same place.
    other.border = root->border = false;
    other.error += root->error;
    Settle(other);
    root->doubt |= other.doubt;
    return;
  }
}

bool RayRoots::complete() const {
  return !awaiting_own_ || std::none_of(roots_.begin(), roots_.end(),
                                        [&](const RayRoot& root) { return root.placed_face == start_face_; });
}

void RayRoots::FindOwnRoot() {
  if (!awaiting_own_) return;
  awaiting_own_ = false;
  for (const RayRoot& root : roots_)
    if (!root.border) Settle(root);
}

void RayRoots::Settle(const RayRoot& root) {
  if (!root.inside || root.doubt != 0) return;
  if (awaiting_own_ && root.placed_face == start_face_) return;
  blocked_ = true;
  limit_ = std::min(limit_, root.distance + root.error);
}

}  // namespace facetless
