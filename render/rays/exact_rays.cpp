#include "render/rays/exact_rays.h"

#include <algorithm>
#include <cmath>

#include "render/base/stopwatch.h"
#include "render/base/trigonometry.h"
#include "render/kernels/dispatch.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

constexpr double kEpsilon = 0x1p-53;
// A face is plane if its control points are within this share of its diagonal of a plane: a few roundings.
constexpr double kFlat = 0x1p-44;
// If the sine of the angle between a ray and a face is below this, the pieces of the face are solved, whatever a cone
// says.
constexpr double kLeastRise = 0x1p-12;

Error Cancelled() {
  return {ErrorCode::kCancelled, "stopped while preparing the rays"};
}

Error OverLimit(std::uint64_t max_bytes) {
  return {ErrorCode::kLimitExceeded, "the pieces for rays need more than the memory limit of " +
                                         std::to_string(max_bytes >> 20) + " MiB"};
}

// Returns the box of a placed box, with a margin for the rounding of its corners.
Box3 Placed(const Box3& box, const PlacedPart& part) {
  Box3 placed;
  double size = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                 corner & 4 ? box.high.z : box.low.z};
    placed.Add(part.placement().Point(p));
    for (int row = 0; row < 3; ++row) {
      const double* m = part.placement().m[row];
      size = std::max(
          size, std::fabs(m[0] * p.x) + std::fabs(m[1] * p.y) + std::fabs(m[2] * p.z) + std::fabs(m[3]));
    }
  }
  const double margin = 8 * kEpsilon * size;
  const Vec3 slack{margin, margin, margin};
  return {placed.low - slack, placed.high + slack};
}

bool IsUsable(const RayStart& start, const SecondaryRay& ray) {
  const double length = Dot(ray.direction, ray.direction);
  const double position = Dot(start.position, start.position);
  return std::fabs(length - 1) <= 0x1p-48 && std::isfinite(position) && ray.length > 0;
}

// Returns a bound of the difference between a patch's parameter and one that runs linearly along its native parameter,
// over a part of a span that is `width` wide, in halves of that part. For an angle, f = tan(φ·α)/tan(α) with φ from −1
// to 1 along the span, and α a quarter of its width. As |f''| ≤ 2α²/cos²α, f differs from its chord by at most
// |f''|·Δφ²/8, and f' is at least α/tan(α).
double Unevenness(const Span& span, double width) {
  if (span.map == SpanMap::kLinear) return 0;
  const double alpha = 0.25 * (span.end - span.begin), tangent = PolyTan(alpha);
  const double step = 2 * width / (span.end - span.begin);
  return 0.5 * alpha * (1 + tangent * tangent) * tangent * step * 1.001;
}

BlockRay LineOf(const RayStart& start, const SecondaryRay& ray) {
  return {{start.position.x, start.position.y, start.position.z},
          {ray.direction.x, ray.direction.y, ray.direction.z},
          ray.length,
          start.error};
}

// Returns whether anything blocks the ray (law 3).
RayPassage PassageOf(const RayRoots& roots) {
  RayPassage passage;
  if (roots.blocked()) return {.blocked = true, .certified = true, .doubt = 0};
  for (const RayRoot& root : roots.roots()) {
    passage.blocked = passage.blocked || root.inside;
    passage.doubt |= root.doubt;
    if (root.border) passage.doubt |= kDoubtTwoRoots;
  }
  for (const OpenQuestion& question : roots.questions()) passage.doubt |= question.doubt;
  if (!roots.complete()) passage.doubt |= kDoubtSilhouette;
  passage.certified = passage.doubt == 0;
  return passage;
}

// Returns the nearest hit (law 3).
SecondaryHit HitOf(const RayRoots& roots, const RayScene& scene, const RayStart& start,
                   const SecondaryRay& ray) {
  SecondaryHit hit;
  const RayRoot* nearest = nullptr;
  for (const RayRoot& root : roots.roots()) {
    if (!root.inside) continue;
    if (nearest == nullptr || root.distance < nearest->distance ||
        (root.distance == nearest->distance && root.placed_face < nearest->placed_face))
      nearest = &root;
  }
  const double end = nearest != nullptr ? nearest->distance + nearest->error : INFINITY;
  for (const RayRoot& root : roots.roots()) {
    if (root.distance - root.error > end) continue;
    hit.doubt |= root.doubt;
    if (root.border) hit.doubt |= kDoubtTwoRoots;
    if (root.inside && root.placed_face != nearest->placed_face) hit.doubt |= kDoubtCoincident;
  }
  for (const OpenQuestion& question : roots.questions())
    if (question.distance <= end) hit.doubt |= question.doubt;
  if (!roots.complete()) hit.doubt |= kDoubtSilhouette;
  hit.certified = hit.doubt == 0;
  if (nearest == nullptr) return hit;

  hit.distance = nearest->distance;
  hit.placed_face = nearest->placed_face;
  hit.u = nearest->u;
  hit.v = nearest->v;
  hit.position = start.position + nearest->distance * ray.direction;
  const PlacedPart& part = scene.parts[scene.instance_of_face[nearest->placed_face]];
  const bool reversed = scene.model().faces[scene.FaceOf(nearest->placed_face)].reversed;
  hit.normal = (reversed ? -1.0 : 1.0) * part.outward() * nearest->normal;
  const auto size = [](Vec3 v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); };
  hit.error = nearest->error + 4 * kEpsilon * (size(start.position) + nearest->distance);
  return hit;
}

}  // namespace

Result<std::unique_ptr<ExactRays>> ExactRays::Build(const Scene& scene, const ExactRaysOptions& options,
                                                    const Execution& execution) {
  const Stopwatch watch;
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels) return kernels.error();
  std::unique_ptr<ExactRays> rays(new ExactRays);
  RayScene& shared = rays->scene_;
  const Model& model = scene.model();
  shared.scene = &scene.data();
  shared.nets = kernels.value().nets;
  shared.pixel = PixelOf(model.Diagonal());
  rays->structure_name_ = options.structure;

  // List the instances, and the faces of which at least one occurrence is shown.
  std::vector<bool> wanted(model.faces.size(), false);
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    const Instance& instance = model.instances[i];
    shared.parts.emplace_back(instance.placement);
    const Range faces = model.parts[instance.part].faces;
    for (std::uint32_t f = 0; f < faces.count; ++f) {
      const std::uint32_t id = instance.first_placed_face + f;
      const bool shown = options.leave_out == nullptr || !(*options.leave_out)[id];
      shared.instance_of_face.push_back(i);
      shared.shown.push_back(shown);
      if (shown) wanted[faces.first + f] = true;
    }
  }
  Result<SpacePieces> pieces =
      SpacePieces::Make(scene, wanted, options.open_share, options.max_bytes, execution);
  if (!pieces) return pieces.error();
  shared.pieces = std::move(pieces).value();
  shared.surfaces.reserve(model.faces.size());
  for (const Face& face : model.faces) shared.surfaces.emplace_back(model, face.surface);
  if (execution.cancelled()) return Cancelled();

  const Result<void> placed = rays->PlacePieces(shared.shown, options.max_bytes);
  if (!placed) return placed.error();
  const std::vector<Box3> boxes = rays->MakeBoxes();
  if (options.structure == kBlocks) {
    rays->visit_blocks_ = kernels.value().visit_blocks;
    RunWithThreads(execution.threads, [&] { rays->BuildBlocks(boxes); });
  } else {
    Result<AnyStructure> structure = MakeStructure(options.structure, boxes);
    if (!structure) return structure.error();
    rays->SetStructure(std::move(structure).value());
  }
  if (execution.cancelled()) return Cancelled();
  if (rays->bytes() > options.max_bytes) return OverLimit(options.max_bytes);

  rays->workers_ = std::make_unique<PerThread<Worker>>([scene = &rays->scene_] { return Worker(*scene); });
  rays->build_ms_ = watch.Milliseconds();
  return rays;
}

Result<void> ExactRays::PlacePieces(const std::vector<bool>& shown, std::uint64_t max_bytes) {
  const Model& model = scene_.model();
  const std::uint64_t own = scene_.pieces.bytes();
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    const Instance& instance = model.instances[i];
    const Range faces = model.parts[instance.part].faces;
    for (std::uint32_t f = 0; f < faces.count; ++f) {
      if (!shown[instance.first_placed_face + f]) continue;
      const Range range = scene_.pieces.OfFace(faces.first + f);
      for (std::uint32_t piece = range.first; piece < range.end(); ++piece)
        placed_.push_back({i, piece, instance.first_placed_face + f});
      if (own + placed_.size() * (sizeof(PlacedPiece) + sizeof(Box3)) > max_bytes)
        return OverLimit(max_bytes);
    }
  }
  return {};
}

std::vector<Box3> ExactRays::MakeBoxes() const {
  std::vector<Box3> boxes;
  boxes.reserve(placed_.size());
  for (const PlacedPiece& placed : placed_)
    boxes.push_back(Placed(scene_.pieces.all()[placed.piece].box, scene_.parts[placed.instance]));
  return boxes;
}

void ExactRays::SetStructure(AnyStructure structure) const {
  structure_ = std::move(structure);
  structure_bytes_ = WithStructure(structure_, [](const auto& made) { return made.bytes(); });
}

const AnyStructure& ExactRays::structure_of_boxes() const {
  if (visit_blocks_ != nullptr)
    std::call_once(structure_once_,
                   [&] { SetStructure(std::move(MakeStructure("bvh", MakeBoxes())).value()); });
  return structure_;
}

std::uint64_t ExactRays::bytes() const {
  return scene_.pieces.bytes() + (blocks_ ? blocks_->bytes() : 0) + placed_.capacity() * sizeof(PlacedPiece) +
         structure_bytes_ + scene_.instance_of_face.capacity() * sizeof(std::uint32_t);
}

template <typename Structure, typename Finish>
void ExactRays::Trace(const Structure& structure, std::span<const RayStart> starts,
                      std::span<const SecondaryRay> rays, bool any, const Finish& finish) const {
  Worker& worker = workers_->local();
  if (!worker.state) worker.state.emplace(structure.state_size());
  RayRoots& roots = worker.roots;
  std::uint32_t last = kNoIndex;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const SecondaryRay& ray = rays[i];
    const RayStart& start = starts[ray.start];
    if (!IsUsable(start, ray)) {
      finish(i, nullptr);
      continue;
    }
    roots.Begin(start, ray.start == last, ray.direction, ray.length);
    last = ray.start;
    structure.Visit({start.position, ray.direction, 0, ray.length}, *worker.state, [&](std::uint32_t id) {
      roots.Examine(placed_[id].instance, scene_.pieces.all()[placed_[id].piece]);
      return any && roots.blocked() ? kStop : roots.limit();
    });
    finish(i, &roots);
  }
}

void ExactRays::BuildBlocks(const std::vector<Box3>& boxes) {
  FindFlatFaces();
  blocks_ = BlockTree::Build(
      boxes, [this](std::uint32_t id, Vec3 from, PieceShape* shape) { DescribePiece(id, from, shape); });
  if (blocks_) view_ = blocks_->blocks();
}

void ExactRays::FindFlatFaces() {
  const Model& model = scene_.model();
  plane_normals_.assign(model.faces.size(), Vec3{});
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const Surface& surface = model.surfaces[model.faces[f].surface];
    if (surface.kind != SurfaceKind::kPlane) continue;
    // The surface is called a plane; check that all of its control points lie in one plane, up to rounding.
    const SurfacePoint point =
        scene_.surfaces[f].First(0.5 * (scene_.surfaces[f].u_begin() + scene_.surfaces[f].u_end()),
                                 0.5 * (scene_.surfaces[f].v_begin() + scene_.surfaces[f].v_end()));
    const Vec3 normal = Normalized(Cross(point.du, point.dv));
    Box3 box;
    double off = 0;
    for (const Vec4& p : PointsOf(model, surface)) {
      const Vec3 at{p.x / p.w, p.y / p.w, p.z / p.w};
      box.Add(at);
      off = std::max(off, std::fabs(Dot(normal, at - point.position)));
    }
    if (off <= kFlat * box.diagonal()) plane_normals_[f] = normal;
  }
}

void ExactRays::DescribePiece(std::uint32_t id, Vec3 from, PieceShape* shape) const {
  const PlacedPiece& placed = placed_[id];
  const SpacePiece& piece = scene_.pieces.all()[placed.piece];
  const PlacedPart& part = scene_.parts[placed.instance];
  const Model& model = scene_.model();
  const Surface& surface = model.surfaces[model.faces[piece.face].surface];
  const Vec3 origin = scene_.pieces.origin(piece.face);
  // The origin of the face relative to `from`; then the points relative to that.
  const Vec3 moved = part.placement().Point(origin) - from;
  shape->degree_u = surface.degree_u;
  shape->degree_v = surface.degree_v;
  shape->points.clear();
  const int count = (surface.degree_u + 1) * (surface.degree_v + 1);
  double least = INFINITY, most = 0, size = 0;
  for (int i = 0; i < count; ++i) {
    const double* p = piece.net + kNetComponents * i;
    const double w = p[kW];
    const Vec3 local{p[kX] / w, p[kY] / w, p[kQ] / w};
    shape->points.push_back(moved + part.placement().Vector(local));
    least = std::min(least, w);
    most = std::max(most, w);
    size = std::max(size, std::fabs(local.x) + std::fabs(local.y) + std::fabs(local.z));
  }
  const auto& m = part.placement().m;
  double growth = 0, shift = 0;
  for (int row = 0; row < 3; ++row) {
    growth = std::max(growth, std::fabs(m[row][0]) + std::fabs(m[row][1]) + std::fabs(m[row][2]));
    shift = std::max(shift, std::fabs(m[row][3]));
  }
  const double weight_error = surface.rational ? piece.error[kW] : 0;
  const double own = least > weight_error
                         ? (piece.error[kX] + piece.error[kY] + piece.error[kQ] + size * weight_error) /
                               (least - weight_error)
                         : INFINITY;
  const double far = std::fabs(origin.x) + std::fabs(origin.y) + std::fabs(origin.z);
  shape->error = growth * own + 16 * kEpsilon * (growth * (far + size) + shift);
  shape->line = piece.line;
  shape->steep_only = !piece.whole;
  const Span& u = model.spans[surface.u_spans.first + piece.place.patch / surface.v_spans.count];
  const Span& v = model.spans[surface.v_spans.first + piece.place.patch % surface.v_spans.count];
  shape->uneven_s = (most - least) / least + Unevenness(u, piece.u_high - piece.u_low);
  shape->uneven_t = (most - least) / least + Unevenness(v, piece.v_high - piece.v_low);
}

bool ExactRays::IsOwnOnly(const RayStart& start, Vec3 direction, const SpacePiece& piece,
                          std::uint32_t instance) const {
  const PlacedPart& part = scene_.parts[instance];
  const Vec3 local = part.shifted_only() ? direction : part.inverse().Vector(direction);
  const double length = part.shifted_only() ? 1 : Length(local);
  const Vec3 normal = plane_normals_[piece.face];
  if (Dot(normal, normal) > 0) return std::fabs(Dot(normal, local)) > kLeastRise * length;
  const auto leaves = [&](const SpacePiece::Cone& cone, double share) {
    return piece.HasNear(start.u, start.v, share) &&
           std::fabs(Dot(cone.axis, local)) > std::max(cone.sine, kLeastRise) * length;
  };
  // The cones hold for the patch of the piece alone.
  return piece.patch_low.x <= start.u && start.u <= piece.patch_high.x && piece.patch_low.y <= start.v &&
         start.v <= piece.patch_high.y &&
         (leaves(piece.close, kCloseShare) || leaves(piece.wide, kWideShare));
}

bool ExactRays::PassageThroughBlocks(std::span<const RayStart> starts, const SecondaryRay& ray,
                                     Worker& worker, RayPassage* passage) const {
  const RayStart& start = starts[ray.start];
  BlockVisit& visit = worker.visit;
  visit.every = false;
  visit_blocks_(view_, LineOf(start, ray), &visit);
  if (visit.overflow) return false;
  ++worker.paths.rays;
  if (visit.blocked) {
    ++worker.paths.blocked;
    *passage = {.blocked = true, .certified = true, .doubt = 0};
    return true;
  }

  const bool own_known = ListOpen(start, ray, worker);
  ++(worker.open.empty() ? worker.paths.clear : worker.paths.solved);
  if (worker.open.empty()) {
    *passage = {.blocked = false, .certified = true, .doubt = 0};
    return true;
  }
  // Solve the pieces that are left open.
  RayRoots& roots = worker.roots;
  roots.Begin(start, worker.prepared == ray.start, ray.direction, ray.length);
  worker.prepared = ray.start;
  if (own_known) roots.KnowOwnRoot();
  for (std::size_t i = 0; i < worker.open.size() && !roots.blocked(); ++i) {
    const PlacedPiece& placed = placed_[worker.open[i].id];
    roots.Examine(placed.instance, scene_.pieces.all()[placed.piece]);
    ++worker.paths.pieces_solved;
  }
  *passage = PassageOf(roots);
  return true;
}

bool ExactRays::ListOpen(const RayStart& start, const SecondaryRay& ray, Worker& worker) const {
  const BlockVisit& visit = worker.visit;
  const RayBlock* const blocks = view_.blocks;
  bool own_known = false;
  worker.open.clear();
  for (int i = 0; i < visit.open_count; ++i) {
    const RayBlock& block = blocks[visit.open[i].block];
    for (std::uint32_t lanes = visit.open[i].lanes; lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      const std::uint32_t id = block.piece[lane];
      const PlacedPiece& placed = placed_[id];
      const SpacePiece& piece = scene_.pieces.all()[placed.piece];
      ++worker.paths.pieces_open;
      if (placed.placed_face == start.placed_face &&
          IsOwnOnly(start, ray.direction, piece, placed.instance)) {
        ++worker.paths.pieces_own;
        own_known = own_known || piece.Holds(start.u, start.v);
        continue;
      }
      worker.open.push_back({visit.every ? visit.near[i][lane] : 0, id});
    }
  }
  return own_known;
}

bool ExactRays::NearestThroughBlocks(std::span<const RayStart> starts, const SecondaryRay& ray,
                                     Worker& worker, SecondaryHit* hit) const {
  const RayStart& start = starts[ray.start];
  worker.visit.every = true;
  visit_blocks_(view_, LineOf(start, ray), &worker.visit);
  if (worker.visit.overflow) return false;
  const bool own_known = ListOpen(start, ray, worker);
  std::sort(worker.open.begin(), worker.open.end(), [](const OpenPiece& a, const OpenPiece& b) {
    return a.near != b.near ? a.near < b.near : a.id < b.id;
  });
  RayRoots& roots = worker.roots;
  roots.Begin(start, worker.prepared == ray.start, ray.direction, ray.length);
  worker.prepared = ray.start;
  if (own_known) roots.KnowOwnRoot();
  for (const OpenPiece& open : worker.open) {
    if (open.near > roots.limit()) break;
    const PlacedPiece& placed = placed_[open.id];
    roots.Examine(placed.instance, scene_.pieces.all()[placed.piece]);
  }
  *hit = HitOf(roots, scene_, start, ray);
  return true;
}

void ExactRays::FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                            std::span<RayPassage> passages) const {
  if (blocks_) return BlockedByTree(starts, rays, passages, workers_->local());
  BlockedByStructure(starts, rays, passages);
}

void ExactRays::BlockedByStructure(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                                   std::span<RayPassage> passages) const {
  WithStructure(structure_of_boxes(), [&](const auto& structure) {
    Trace(structure, starts, rays, /*any=*/true, [&](std::size_t i, const RayRoots* roots) {
      passages[i] = roots != nullptr ? PassageOf(*roots) : RayPassage{.doubt = kDoubtUnresolved};
    });
  });
}

void ExactRays::BlockedByTree(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                              std::span<RayPassage> passages, Worker& worker) const {
  worker.prepared = kNoIndex;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const RayStart& start = starts[rays[i].start];
    bool answered = false;
    if (blocks_->Reaches(start.position) && IsUsable(start, rays[i]))
      answered = PassageThroughBlocks(starts, rays[i], worker, &passages[i]);
    if (answered) continue;
    BlockedByStructure(starts, rays.subspan(i, 1), passages.subspan(i, 1));
    worker.prepared = kNoIndex;
  }
}

ExactRays::Paths ExactRays::CountPaths(std::span<const RayStart> starts,
                                       std::span<const SecondaryRay> rays) const {
  Worker& worker = workers_->local();
  worker.paths = {};
  std::vector<RayPassage> passages(rays.size());
  FindBlocked(starts, rays, passages);
  return worker.paths;
}

void ExactRays::NearestByStructure(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                                   std::span<SecondaryHit> hits) const {
  WithStructure(structure_of_boxes(), [&](const auto& structure) {
    Trace(structure, starts, rays, /*any=*/false, [&](std::size_t i, const RayRoots* roots) {
      hits[i] = {};
      hits[i].doubt = kDoubtUnresolved;
      if (roots != nullptr) hits[i] = HitOf(*roots, scene_, starts[rays[i].start], rays[i]);
    });
  });
}

void ExactRays::FindNearest(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                            std::span<SecondaryHit> hits) const {
  if (!blocks_) return NearestByStructure(starts, rays, hits);
  Worker& worker = workers_->local();
  worker.prepared = kNoIndex;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const RayStart& start = starts[rays[i].start];
    if (blocks_->Reaches(start.position) && IsUsable(start, rays[i]) &&
        NearestThroughBlocks(starts, rays[i], worker, &hits[i]))
      continue;
    NearestByStructure(starts, rays.subspan(i, 1), hits.subspan(i, 1));
    worker.prepared = kNoIndex;
  }
}

}  // namespace facetless
