#include "render/trace/tile_tracer.h"

#include <algorithm>
#include <cmath>

#include "render/trace/hit_geometry.h"

namespace facetless {
namespace {

// A gap seen at grazing incidence covers gap/cosine of the surface; beyond this factor the band would swallow
// the face.
constexpr double kMaxBandScale = 64;

// A root in the overlap past the border of its patch belongs to the border: on a closed surface without edges
// the other side of the seam may have left it to this one. Where the patch is continued it lies where it lies.
double OntoPatch(double bezier, double half, double leaf_overlap, bool low_continued, bool high_continued) {
  const double overlap = 2 * leaf_overlap * half;
  if (!low_continued && bezier < 0 && bezier >= -overlap) return 0;
  if (!high_continued && bezier > 1 && bezier <= 1 + overlap) return 1;
  return bezier;
}

}  // namespace

TraceShared::TraceShared(const Scene::Data& scene_data, const PreparedView& prepared,
                         const Camera& view_camera, const CameraFrame& view_frame)
    : scene(scene_data), view(prepared), camera(view_camera), frame(view_frame) {
  const Model& model = *scene.model;
  edges.reserve(model.instances.size());
  for (const Instance& instance : model.instances) {
    edges.emplace_back(model, instance.placement, frame);
    mirrored_.push_back(instance.placement.Determinant() < 0);
  }
  if (model.instances.size() < 2) return;
  instance_of_face_.reserve(model.PlacedFaceCount());
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    instance_of_face_.insert(instance_of_face_.end(), model.parts[model.instances[i].part].faces.count, i);
  }
}

TraceShared::PlacedFace TraceShared::Placed(std::uint32_t placed_face) const {
  const Model& model = *scene.model;
  const std::uint32_t index = instance_of_face_.empty() ? 0 : instance_of_face_[placed_face];
  const Instance& instance = model.instances[index];
  const std::uint32_t face =
      model.parts[instance.part].faces.first + placed_face - instance.first_placed_face;
  return {index, face, model.faces[face].reversed != mirrored_[index] ? -1.0 : 1.0};
}

TraceShared::LeafParameters TraceShared::Parameters(const Leaf& leaf, std::uint32_t face, double s,
                                                    double t) const {
  const Surface& surface = scene.model->surfaces[scene.model->faces[face].surface];
  const FaceData& data = scene.faces[face];
  const std::uint32_t i = leaf.patch / surface.v_spans.count, j = leaf.patch % surface.v_spans.count;
  return {&scene.spans[surface.u_spans.first + i], &scene.spans[surface.v_spans.first + j],
          OntoPatch(leaf.u_mid + s * leaf.u_half, leaf.u_half, leaf.overlap(), i == 0 && data.u_low_continued,
                    i + 1 == surface.u_spans.count && data.u_high_continued),
          OntoPatch(leaf.v_mid + t * leaf.v_half, leaf.v_half, leaf.overlap(), j == 0 && data.v_low_continued,
                    j + 1 == surface.v_spans.count && data.v_high_continued)};
}

RootTwin::RootTwin(const Leaf& leaf, const TileHit& hit) : depth(hit.depth) {
  const double border = 1 - 2 * leaf.overlap();
  on_border = !(leaf.flags & kLeafSeam) &&
              ((leaf.flags & kLeafHard) || std::fabs(hit.s) >= border || std::fabs(hit.t) >= border);
  // An error of the root moves the depth by at most the leaf's own depth range times it; a hard leaf's by the
  // range of a floor piece.
  error = std::fabs(hit.depth) * 0x1p-44 + std::fabs(hit.depth - leaf.near_depth) * 2 * leaf.overlap();
}

TileTracer::TileTracer(const TraceShared& shared, TileKernel kernel, bool certify)
    : shared_(shared), kernel_(kernel) {
  job_.coincidences = certify;
  job_.leaves = shared.view.tiles->leaves().data();
  job_.tile_size = kTileSize;
  job_.half_width = 0.5 * shared.camera.width_px;
  job_.half_height = 0.5 * shared.camera.height_px;
  job_.near_depth = shared.frame.projection == Projection::kPerspective ? shared.frame.near_mm : -INFINITY;
  job_.keep = [](void* context, const Leaf& hit_leaf, double hit_s, double hit_t, double x, double y,
                 std::uint8_t* hit_doubt) {
    return static_cast<TileTracer*>(context)->Keep(hit_leaf, RootOf(hit_leaf, hit_s, hit_t), x, y, hit_doubt);
  };
  job_.solve_hard = [](void* context, const Leaf& hard_leaf, double x, double y, double limit, void* sink,
                       void (*found)(void*, const TileHit&, std::uint8_t, bool)) {
    return static_cast<TileTracer*>(context)->SolveHard(hard_leaf, x, y, limit, sink, found);
  };
}

void TileTracer::Trace(int index, std::vector<Crossing>* crossings) {
  const TileLeaves& tiles = *shared_.view.tiles;
  job_.column = index % tiles.tiles_x() * kTileSize;
  job_.row = index / tiles.tiles_x() * kTileSize;
  job_.columns = std::min(kTileSize, shared_.camera.width_px - job_.column);
  job_.rows = std::min(kTileSize, shared_.camera.height_px - job_.row);
  bitmaps_.Build(tiles, index, job_.column, job_.row);
  job_.list = tiles.Tile(index).data();
  job_.words = bitmaps_.words();
  job_.row_bits = bitmaps_.Row(0);
  job_.column_bits = bitmaps_.Column(0);
  job_.context = this;
  job_.counters = &counters;
  job_.depth = depth.data();
  job_.error = error.data();
  job_.s = s.data();
  job_.t = t.data();
  job_.leaf = leaf.data();
  job_.doubt = doubt.data();
  crossings_ = crossings;
  job_.every_hit = nullptr;
  if (crossings) {
    job_.every_hit = [](void* context, int sample, std::uint32_t leaf_index, const TileHit& hit,
                        std::uint8_t hit_doubt) {
      TileTracer* self = static_cast<TileTracer*>(context);
      const int row = self->job_.row + sample / kTileSize, column = self->job_.column + sample % kTileSize;
      self->crossings_->push_back({static_cast<std::uint32_t>(row * self->shared_.camera.width_px + column),
                                   leaf_index, hit, hit_doubt});
    };
  }
  kernel_(job_);
}

TileTracer::Root TileTracer::RootOf(const Leaf& leaf, double s, double t) {
  return {s, t, leaf.root_error, leaf.root_error, leaf.c11 * leaf.c22 - leaf.c12 * leaf.c21};
}

bool TileTracer::Keep(const Leaf& hit_leaf, const Root& root, double x, double y, std::uint8_t* hit_doubt) {
  // Map the hit to native parameters: the hit, never the curve.
  const TraceShared::PlacedFace placed = shared_.Placed(hit_leaf.placed_face);
  const TraceShared::LeafParameters at = shared_.Parameters(hit_leaf, placed.face, root.s, root.t);
  const double u = at.u_map->ToNative(at.u), v = at.v_map->ToNative(at.v);
  const double error_u = root.error_s * hit_leaf.u_half / at.u_map->Rate(at.u),
               error_v = root.error_t * hit_leaf.v_half / at.v_map->Rate(at.v);

  const HitGeometry geometry = EvaluateHit(hit_leaf, root.s, root.t, x, y, shared_.frame);
  const double band_scale = std::min(kMaxBandScale, 1 / geometry.cosine);
  const TrimAnswer answer = shared_.scene.faces[placed.face].trim.Query(u, v, error_u, error_v, band_scale);

  // In an edge's band, both faces ask the edge itself.
  if (answer.coedge != kNoIndex && root.jacobian_sign != 0) {
    const double mm_per_px = std::max(shared_.frame.pixel_x, shared_.frame.pixel_y) *
                             (shared_.frame.projection == Projection::kPerspective ? geometry.depth : 1);
    const EdgeDecision decision = DecideAtEdge(
        *shared_.scene.model, shared_.edges[placed.instance], answer, x + 0.5 * shared_.camera.width_px,
        y + 0.5 * shared_.camera.height_px, mm_per_px, root.jacobian_sign > 0);
    if (decision.verdict != EdgeVerdict::kUnknown) {
      if (!decision.proven) *hit_doubt |= kDoubtTrim;
      return decision.verdict == EdgeVerdict::kKeep;
    }
  }
  if (!answer.certain) *hit_doubt |= kDoubtTrim;
  return answer.inside;
}

std::uint8_t TileTracer::SolveSeam(const Leaf& seam, double x, double y, void* sink,
                                   void (*found)(void* sink, const TileHit& hit, std::uint8_t doubt,
                                                 bool kept)) {
  // Every root of the face on this ray, with the trimming's answer.
  seam_roots_.clear();
  struct Others {
    TileTracer* self;
    const Leaf* leaf;
  };
  const std::uint64_t* rows = bitmaps_.Row(seam.row_begin - job_.row);
  const std::uint64_t* columns = bitmaps_.Column(seam.col_begin - job_.column);
  for (int word = 0; word < job_.words; ++word) {
    for (std::uint64_t bits = rows[word] & columns[word]; bits != 0; bits &= bits - 1) {
      const Leaf& leaf = job_.leaves[job_.list[64 * word + __builtin_ctzll(bits)]];
      if (leaf.placed_face != seam.placed_face || (leaf.flags & kLeafSeam)) continue;
      if (leaf.flags & kLeafHard) {
        Others others{this, &leaf};
        SolveHard(leaf, x, y, INFINITY, &others, [](void* to, const TileHit& hit, std::uint8_t, bool kept) {
          Others* into = static_cast<Others*>(to);
          if (kept) into->self->seam_roots_.emplace_back(*into->leaf, hit);
        });
        continue;
      }
      TileHit hit;
      std::uint8_t doubt = 0;
      if (SolveSample(leaf, x, y, &hit) != SampleRoot::kHit || !(hit.depth > job_.near_depth)) continue;
      if ((leaf.flags & kLeafTrimmed) && !Keep(leaf, RootOf(leaf, hit.s, hit.t), x, y, &doubt)) continue;
      seam_roots_.emplace_back(leaf, hit);
    }
  }

  // One more where they don't come out odd, or even, as the border says.
  std::sort(seam_roots_.begin(), seam_roots_.end(),
            [](const RootTwin& a, const RootTwin& b) { return a.depth < b.depth; });
  const auto end = std::unique(seam_roots_.begin(), seam_roots_.end(),
                               [](const RootTwin& a, const RootTwin& b) { return a.Is(b); });
  const bool odd = (end - seam_roots_.begin()) % 2 != 0;
  if (odd != ((seam.flags & kLeafOdd) != 0) && seam.near_depth > job_.near_depth)
    found(sink, {seam.near_depth, seam.s_low, seam.t_low, INFINITY}, kDoubtTrim, true);
  return 0;
}

std::uint8_t TileTracer::SolveHard(const Leaf& hard_leaf, double x, double y, double limit, void* sink,
                                   void (*found)(void* sink, const TileHit& hit, std::uint8_t doubt,
                                                 bool kept)) {
  if (hard_leaf.flags & kLeafSeam) return SolveSeam(hard_leaf, x, y, sink, found);
  roots_.clear();
  const std::uint8_t result = solver_.Solve(hard_leaf, x, y, limit, &roots_);
  for (const FallbackRoot& root : roots_) {
    if (!(root.hit.depth > job_.near_depth)) continue;
    std::uint8_t root_doubt = DoubtOf(hard_leaf, root, x, y);
    bool kept = true;
    if (hard_leaf.flags & kLeafTrimmed) {
      ++counters.trim_tests;
      kept = Keep(hard_leaf, {root.hit.s, root.hit.t, root.error_s, root.error_t, root.jacobian_sign}, x, y,
                  &root_doubt);
    }
    found(sink, root.hit, root_doubt, kept);
  }
  return result;
}

// Why a root of the fallback solver is not certified.
std::uint8_t TileTracer::DoubtOf(const Leaf& hard_leaf, const FallbackRoot& root, double x, double y) const {
  std::uint8_t result = root.on_border ? kDoubtTwoRoots : 0;
  if (!root.proven) {
    const bool singular = EvaluateHit(hard_leaf, root.hit.s, root.hit.t, x, y, shared_.frame).singular;
    result |= singular ? kDoubtPole : kDoubtSilhouette;
  }
  // Another root of the same leaf, not the same one found again at the border of two pieces.
  const auto apart = [](double a, double b, double errors) {
    return std::fabs(a - b) > errors + 2 * kBorderOverlap;
  };
  for (const FallbackRoot& other : roots_) {
    const bool same = !apart(root.hit.s, other.hit.s, root.error_s + other.error_s) &&
                      !apart(root.hit.t, other.hit.t, root.error_t + other.error_t);
    if (!same && std::fabs(root.hit.depth - other.hit.depth) <= root.hit.error + other.hit.error)
      result |= kDoubtTwoRoots;
  }
  return result;
}

}  // namespace facetless
