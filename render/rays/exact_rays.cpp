#include "render/rays/exact_rays.h"

#include <algorithm>
#include <cmath>

#include "render/base/stopwatch.h"
#include "render/kernels/dispatch.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

constexpr double kEpsilon = 0x1p-53;

Error Cancelled() {
  return {ErrorCode::kCancelled, "stopped while preparing the rays"};
}

Error OverLimit(std::uint64_t max_bytes) {
  return {ErrorCode::kLimitExceeded, "the pieces for rays need more than the memory limit of " +
                                         std::to_string(max_bytes >> 20) + " MiB"};
}

// The box of a placed box. A corner is rounded a few times, relative to the coordinates that take part.
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

// The answer to whether anything is in between (law 3).
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

// The nearest hit (law 3).
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
  Result<SpacePieces> pieces = SpacePieces::Make(scene, wanted, options.max_bytes, execution);
  if (!pieces) return pieces.error();
  shared.pieces = std::move(pieces).value();
  shared.surfaces.reserve(model.faces.size());
  for (const Face& face : model.faces) shared.surfaces.emplace_back(model, face.surface);
  if (execution.cancelled()) return Cancelled();

  std::vector<Box3> boxes;
  const Result<void> placed = rays->PlacePieces(shared.shown, options.max_bytes, &boxes);
  if (!placed) return placed.error();
  Result<AnyStructure> structure = MakeStructure(options.structure, boxes);
  if (!structure) return structure.error();
  rays->structure_ = std::move(structure).value();
  if (execution.cancelled()) return Cancelled();
  if (rays->bytes() > options.max_bytes) return OverLimit(options.max_bytes);

  const StateSize size =
      WithStructure(rays->structure_, [](const auto& structure) { return structure.state_size(); });
  rays->workers_ =
      std::make_unique<PerThread<Worker>>([scene = &rays->scene_, size] { return Worker(*scene, size); });
  rays->build_ms_ = watch.Milliseconds();
  return rays;
}

Result<void> ExactRays::PlacePieces(const std::vector<bool>& shown, std::uint64_t max_bytes,
                                    std::vector<Box3>* boxes) {
  const Model& model = scene_.model();
  const std::uint64_t own = scene_.pieces.bytes();
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    const Instance& instance = model.instances[i];
    const Range faces = model.parts[instance.part].faces;
    for (std::uint32_t f = 0; f < faces.count; ++f) {
      if (!shown[instance.first_placed_face + f]) continue;
      const Range range = scene_.pieces.OfFace(faces.first + f);
      for (std::uint32_t piece = range.first; piece < range.end(); ++piece) {
        placed_.push_back({i, piece});
        boxes->push_back(Placed(scene_.pieces.all()[piece].box, scene_.parts[i]));
      }
      if (own + placed_.size() * (sizeof(PlacedPiece) + sizeof(Box3)) > max_bytes)
        return OverLimit(max_bytes);
    }
  }
  return {};
}

std::uint64_t ExactRays::bytes() const {
  const std::size_t structure =
      WithStructure(structure_, [](const auto& structure) { return structure.bytes(); });
  return scene_.pieces.bytes() + placed_.capacity() * sizeof(PlacedPiece) + structure +
         scene_.instance_of_face.capacity() * sizeof(std::uint32_t);
}

template <typename Structure, typename Finish>
void ExactRays::Trace(const Structure& structure, std::span<const RayStart> starts,
                      std::span<const SecondaryRay> rays, bool any, const Finish& finish) const {
  Worker& worker = workers_->local();
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
    structure.Visit({start.position, ray.direction, 0, ray.length}, worker.state, [&](std::uint32_t id) {
      roots.Examine(placed_[id].instance, scene_.pieces.all()[placed_[id].piece]);
      return any && roots.blocked() ? kStop : roots.limit();
    });
    finish(i, &roots);
  }
}

void ExactRays::FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                            std::span<RayPassage> passages) const {
  WithStructure(structure_, [&](const auto& structure) {
    Trace(structure, starts, rays, /*any=*/true, [&](std::size_t i, const RayRoots* roots) {
      passages[i] = roots != nullptr ? PassageOf(*roots) : RayPassage{.doubt = kDoubtUnresolved};
    });
  });
}

void ExactRays::FindNearest(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                            std::span<SecondaryHit> hits) const {
  WithStructure(structure_, [&](const auto& structure) {
    Trace(structure, starts, rays, /*any=*/false, [&](std::size_t i, const RayRoots* roots) {
      hits[i] = {};
      hits[i].doubt = kDoubtUnresolved;
      if (roots != nullptr) hits[i] = HitOf(*roots, scene_, starts[rays[i].start], rays[i]);
    });
  });
}

}  // namespace facetless
