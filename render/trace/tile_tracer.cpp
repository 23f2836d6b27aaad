#include "render/trace/tile_tracer.h"

#include <algorithm>
#include <cmath>

#include "render/model/walk.h"
#include "render/trace/hit_geometry.h"

namespace facetless {
namespace {

// A gap seen at grazing incidence covers gap/cosine of the surface; beyond this factor the band would swallow
// the face.
constexpr double kMaxBandScale = 64;

// A border of a patch in one of its parameters.
struct PatchBorder {
  bool across_u, high;
};

// Which border a root lies on or beyond, within its error. None at a corner: there it has three neighbours.
std::optional<PatchBorder> BorderOf(double u, double error_u, double v, double error_v) {
  const bool low_u = u<error_u, high_u = u> 1 - error_u, low_v = v<error_v, high_v = v> 1 - error_v;
  if (low_u + high_u + low_v + high_v != 1) return {};
  return PatchBorder{low_u || high_u, high_u || high_v};
}

// A root in the overlap past the border of its patch belongs to the border: on a closed surface without edges
// the other side of the seam may have left it to this one. Where the patch is continued it lies where it
// lies.
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
  const std::uint32_t face = FacesOf(model, instance).first + placed_face - instance.first_placed_face;
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

std::uint8_t TraceShared::CheckRoot(const Leaf& leaf, const LeafRoot& root, double x, double y, double depth,
                                    double error, CheckStats* stats) const {
  const PlacedFace placed = Placed(leaf.placed_face);
  ++stats->roots;
  const bool holds =
      check->RootHolds({placed.instance, placed.face, leaf.patch, leaf.u_mid + root.s * leaf.u_half,
                        leaf.v_mid + root.t * leaf.v_half, root.error_s * leaf.u_half,
                        root.error_t * leaf.v_half, x + frame.center_x, y + frame.center_y, depth, error});
  if (holds) return 0;
  ++stats->roots_contradicted;
  return kDoubtContradicted;
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
    : shared_(shared), kernel_(kernel), solver_(*shared.view.nets) {
  job_.coincidences = certify;
  job_.leaves = shared.view.tiles->leaves().data();
  job_.tile_size = kTileSize;
  job_.half_width = 0.5 * shared.camera.width_px;
  job_.half_height = 0.5 * shared.camera.height_px;
  job_.near_depth = shared.frame.projection == Projection::kPerspective ? shared.frame.near_mm : -INFINITY;
  job_.axes = {shared.frame.right, shared.frame.down, shared.frame.forward, shared.frame.pixel_x,
               shared.frame.pixel_y};
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
  job_.resolver = this;
  job_.counters = &counters;
  job_.depth = depth.data();
  job_.error = error.data();
  job_.s = s.data();
  job_.t = t.data();
  job_.leaf = leaf.data();
  job_.doubt = doubt.data();
  job_.normal = crossings ? nullptr : normal.data();
  crossings_ = crossings;
  job_.every_hit = crossings != nullptr;
  if (empty()) return;
  work_.fill({});
  kernel_(job_);
}

bool TileTracer::IsInsideFace(const Leaf& hit_leaf, double hit_s, double hit_t, double x, double y,
                              std::uint8_t* hit_doubt) {
  return IsInsideFace(hit_leaf, RootOf(hit_leaf, hit_s, hit_t), x, y, hit_doubt);
}

bool TileTracer::OwnsBorderRoot(const Leaf& hit_leaf, double x, double y, TileHit* hit,
                                std::uint8_t* hit_doubt) {
  return OwnsBorderRoot(hit_leaf, RootOf(hit_leaf, hit->s, hit->t), x, y, hit, hit_doubt);
}

void TileTracer::RecordHit(int sample, std::uint32_t leaf_index, const TileHit& hit, std::uint8_t hit_doubt) {
  const int row = job_.row + sample / kTileSize, column = job_.column + sample % kTileSize;
  crossings_->push_back(
      {static_cast<std::uint32_t>(row * shared_.camera.width_px + column), leaf_index, hit, hit_doubt});
}

int TileTracer::SampleAt(double x, double y) const {
  const int row = static_cast<int>(y - 0.5 + job_.half_height) - job_.row;
  const int column = static_cast<int>(x - 0.5 + job_.half_width) - job_.column;
  return row * kTileSize + column;
}

TileTracer::Root TileTracer::RootOf(const Leaf& leaf, double s, double t) {
  return {s, t, leaf.root_error, leaf.root_error, leaf.c11 * leaf.c22 - leaf.c12 * leaf.c21};
}

TileTracer::Root TileTracer::RootOf(const FallbackRoot& root) {
  return {root.hit.s, root.hit.t, root.error_s, root.error_t, root.proven ? root.jacobian_sign : 0};
}

TrimAnswer TileTracer::QueryTrim(const Leaf& hit_leaf, const Root& root, double cosine) const {
  // Map the hit to native parameters: the hit, never the curve.
  const std::uint32_t face = shared_.Placed(hit_leaf.placed_face).face;
  const TraceShared::LeafParameters at = shared_.Parameters(hit_leaf, face, root.s, root.t);
  return shared_.scene.faces[face].trim.Query(at.u_map->ToNative(at.u), at.v_map->ToNative(at.v),
                                              root.error_s * hit_leaf.u_half / at.u_map->Rate(at.u),
                                              root.error_t * hit_leaf.v_half / at.v_map->Rate(at.v),
                                              std::min(kMaxBandScale, 1 / cosine));
}

bool TileTracer::IsInsideFace(const Leaf& hit_leaf, const Root& root, double x, double y,
                              std::uint8_t* hit_doubt) {
  // Most hits lie farther from every edge than the widest band.
  const TrimAnswer far = QueryTrim(hit_leaf, root, 1 / kMaxBandScale);
  if (far.certain && far.coedge == kNoIndex) return far.inside;
  const TraceShared::PlacedFace placed = shared_.Placed(hit_leaf.placed_face);
  const HitGeometry geometry = EvaluateHit(hit_leaf, root.s, root.t, x, y, shared_.frame);
  const TrimAnswer answer = QueryTrim(hit_leaf, root, geometry.cosine);

  // In an edge's band, both faces ask the edge itself.
  if (answer.coedge != kNoIndex && root.jacobian_sign != 0) {
    const double mm_per_px = std::max(shared_.frame.pixel_x, shared_.frame.pixel_y) *
                             (shared_.frame.projection == Projection::kPerspective ? geometry.depth : 1);
    const EdgeDecision decision = DecideAtEdge(
        *shared_.scene.model, shared_.edges[placed.instance], answer, x + 0.5 * shared_.camera.width_px,
        y + 0.5 * shared_.camera.height_px, mm_per_px, root.jacobian_sign > 0);
    if (decision.verdict != EdgeVerdict::kUnknown) {
      if (!decision.proven && !OnSeam(hit_leaf, root, answer, geometry.depth, x, y)) *hit_doubt |= kDoubtTrim;
      return decision.verdict == EdgeVerdict::kKeep;
    }
  }
  if (answer.certain) return answer.inside;
  // A whole surface that closes goes on across its border.
  if (shared_.scene.faces[placed.face].trim.whole() &&
      NeighbourOf(hit_leaf, root, {geometry.depth, root.s, root.t, hit_leaf.depth_error}, x, y))
    return true;
  *hit_doubt |= kDoubtTrim;
  return answer.inside;
}

template <typename Found>
bool TileTracer::EveryRoot(std::uint32_t placed_face, double x, double y, const Found& found) {
  const int sample = SampleAt(x, y);
  RayWork& work = work_[sample];
  const std::uint64_t* rows = bitmaps_.Row(sample / kTileSize);
  const std::uint64_t* columns = bitmaps_.Column(sample % kTileSize);
  // A seam leaf asks all leaves of its ray, so that many seams on one ray ask many times as many.
  work.Spend(job_.words);
  for (int word = 0; word < job_.words; ++word) {
    for (std::uint64_t bits = rows[word] & columns[word]; bits != 0; bits &= bits - 1) {
      const Leaf& candidate = job_.leaves[job_.list[64 * word + __builtin_ctzll(bits)]];
      work.Spend(1);
      if (candidate.placed_face != placed_face || (candidate.flags & kLeafSeam)) continue;
      work.Spend(candidate.points());
      if (work.exhausted()) return false;
      if (candidate.flags & kLeafHard) {
        std::vector<FallbackRoot> roots;
        solver_.Solve(candidate, x, y, INFINITY, &work, &roots);
        for (const FallbackRoot& root : roots) found(candidate, RootOf(root), root.hit);
        continue;
      }
      TileHit hit;
      if (SolveSample(candidate, x, y, &hit) == SampleRoot::kHit)
        found(candidate, RootOf(candidate, hit.s, hit.t), hit);
    }
  }
  return !work.exhausted();
}

std::optional<TileTracer::Neighbour> TileTracer::NeighbourOf(const Leaf& own, const Root& root,
                                                             const TileHit& own_hit, double x, double y) {
  const double u = own.u_mid + root.s * own.u_half, v = own.v_mid + root.t * own.v_half;
  const std::optional<PatchBorder> border =
      BorderOf(u, root.error_s * own.u_half, v, root.error_t * own.v_half);
  if (!border || root.jacobian_sign == 0) return {};

  // The patch across it; on a closed surface, that at the other end.
  const TraceShared::PlacedFace placed = shared_.Placed(own.placed_face);
  const Surface& surface = shared_.scene.model->surfaces[shared_.scene.model->faces[placed.face].surface];
  const std::uint32_t nu = surface.u_spans.count, nv = surface.v_spans.count;
  std::uint32_t i = own.patch / nv, j = own.patch % nv;
  std::uint32_t& across = border->across_u ? i : j;
  const std::uint32_t count = border->across_u ? nu : nv;
  across = border->high ? (across + 1) % count : (across + count - 1) % count;
  const std::uint32_t patch = i * nv + j;

  // How far apart the two may be along the border and off it: what neighbours overlap, in native parameters.
  const auto native = [&](const Leaf& leaf, const Root& at) {
    struct Native {
      double along, reach_along, reach_off, rate_off;
    };
    const TraceShared::LeafParameters where = shared_.Parameters(leaf, placed.face, at.s, at.t);
    const double rate_u = where.u_map->Rate(where.u), rate_v = where.v_map->Rate(where.v);
    const double reach_u = (kBorderOverlap + 4 * at.error_s) * leaf.u_half / rate_u,
                 reach_v = (kBorderOverlap + 4 * at.error_t) * leaf.v_half / rate_v;
    return border->across_u ? Native{where.v_map->ToNative(where.v), reach_v, reach_u, rate_u}
                            : Native{where.u_map->ToNative(where.u), reach_u, reach_v, rate_v};
  };
  const auto here = native(own, root);
  // And in depth, which changes by its error where the root moves by its own. The ends of a surface that does
  // not close may lie behind each other.
  const auto depth_reach = [](const Root& at, double error) {
    return error * (4 + kBorderOverlap / std::min(at.error_s, at.error_t));
  };

  std::optional<Neighbour> neighbour;
  const auto consider = [&](const Leaf& leaf, const Root& other, const TileHit& hit) {
    const auto there = native(leaf, other);
    const double beyond_low =
        border->across_u ? leaf.u_mid + other.s * leaf.u_half : leaf.v_mid + other.t * leaf.v_half;
    const double inside = border->high ? beyond_low : 1 - beyond_low;  // of the opposite border
    const double error = border->across_u ? other.error_s * leaf.u_half : other.error_t * leaf.v_half;
    if (other.jacobian_sign * root.jacobian_sign <= 0 ||
        std::fabs(here.along - there.along) > here.reach_along + there.reach_along ||
        std::fabs(inside) > (here.reach_off + there.reach_off) * there.rate_off ||
        !(std::fabs(hit.depth - own_hit.depth) <=
          depth_reach(root, own_hit.error) + depth_reach(other, hit.error)))
      return;
    neighbour = Neighbour{hit.depth, hit.error, inside >= -error};
  };

  const bool complete =
      EveryRoot(own.placed_face, x, y, [&](const Leaf& leaf, const Root& other, const TileHit& hit) {
        if (leaf.patch == patch && !neighbour) consider(leaf, other, hit);
      });
  return complete ? neighbour : std::nullopt;
}

bool TileTracer::OnSeam(const Leaf& own, const Root& root, const TrimAnswer& answer, double depth, double x,
                        double y) {
  // The face goes on there: whichever coedge the edge gives the ray to, the ray has its hit.
  const Model& model = *shared_.scene.model;
  // At a corner another edge has a say.
  if (answer.other_coedge != kNoIndex &&
      model.coedges[answer.other_coedge].edge != model.coedges[answer.coedge].edge)
    return false;
  bool again = false;
  EveryRoot(own.placed_face, x, y, [&](const Leaf& leaf, const Root& other, const TileHit& hit) {
    if (again || other.jacobian_sign * root.jacobian_sign <= 0) return;
    if (std::fabs(hit.depth - depth) > hit.error + own.depth_error) return;
    const HitGeometry geometry = EvaluateHit(leaf, other.s, other.t, x, y, shared_.frame);
    const TrimAnswer there = QueryTrim(leaf, other, geometry.cosine);
    again = there.coedge != kNoIndex && there.coedge != answer.coedge &&
            model.coedges[there.coedge].edge == model.coedges[answer.coedge].edge;
  });
  return again;
}

bool TileTracer::OwnsBorderRoot(const Leaf& leaf, const Root& root, double x, double y, TileHit* hit,
                                std::uint8_t* hit_doubt) {
  // Where both patches have the root and turn the same way, the border runs between their images: one of them
  // has the ray, and the surface there is seen by it once.
  const std::optional<Neighbour> neighbour = NeighbourOf(leaf, root, *hit, x, y);
  if (!neighbour || !neighbour->within) {
    *hit_doubt |= kDoubtTwoRoots;
    return true;
  }
  // A root beyond the border is the neighbour's, unless there is an edge to decide that.
  const double u = leaf.u_mid + root.s * leaf.u_half, v = leaf.v_mid + root.t * leaf.v_half;
  const double error_u = root.error_s * leaf.u_half, error_v = root.error_t * leaf.v_half;
  const bool beyond = u < -error_u || u > 1 + error_u || v < -error_v || v > 1 + error_v;
  if (beyond && !(leaf.flags & kLeafTrimmed)) return false;
  hit->error += neighbour->error + std::fabs(neighbour->depth - hit->depth);
  return true;
}

std::uint8_t TileTracer::SolveSeam(const Leaf& seam, double x, double y, RootSink* roots) {
  // Every root of the face on this ray, with the trimming's answer.
  seam_roots_.clear();
  const bool complete =
      EveryRoot(seam.placed_face, x, y, [&](const Leaf& leaf, const Root& root, const TileHit& hit) {
        std::uint8_t ignored = 0;
        if (!(hit.depth > job_.near_depth)) return;
        if ((leaf.flags & kLeafTrimmed) && !IsInsideFace(leaf, root, x, y, &ignored)) return;
        seam_roots_.emplace_back(leaf, hit);
      });
  if (!complete) return kDoubtLimit;

  // One more where they don't come out odd, or even, as the border says.
  std::sort(seam_roots_.begin(), seam_roots_.end(),
            [](const RootTwin& a, const RootTwin& b) { return a.depth < b.depth; });
  const auto end = std::unique(seam_roots_.begin(), seam_roots_.end(),
                               [](const RootTwin& a, const RootTwin& b) { return a.Is(b); });
  const bool odd = (end - seam_roots_.begin()) % 2 != 0;
  if (odd != ((seam.flags & kLeafOdd) != 0) && seam.near_depth > job_.near_depth)
    roots->Add({seam.near_depth, seam.s_low, seam.t_low, INFINITY}, kDoubtTrim, true);
  return 0;
}

std::uint8_t TileTracer::SolveHardLeaf(const Leaf& hard_leaf, double x, double y, double limit,
                                       RootSink* roots) {
  if (hard_leaf.flags & kLeafSeam) return SolveSeam(hard_leaf, x, y, roots);
  roots_.clear();
  const std::uint8_t result = solver_.Solve(hard_leaf, x, y, limit, &work_[SampleAt(x, y)], &roots_);
  for (const FallbackRoot& root : roots_) {
    if (!(root.hit.depth > job_.near_depth)) continue;
    const Root at = RootOf(root);
    std::uint8_t root_doubt = DoubtOf(hard_leaf, root, x, y);
    TileHit hit = root.hit;
    if (shared_.check && root.proven && root_doubt == 0)
      root_doubt |= shared_.CheckRoot(hard_leaf, {hit.s, hit.t, root.error_s, root.error_t}, x, y, hit.depth,
                                      hit.error, &check);
    if (root.on_border && !OwnsBorderRoot(hard_leaf, at, x, y, &hit, &root_doubt)) continue;
    bool kept = true;
    if (hard_leaf.flags & kLeafTrimmed) {
      ++counters.trim_tests;
      kept = IsInsideFace(hard_leaf, at, x, y, &root_doubt);
    }
    roots->Add(hit, root_doubt, kept);
  }
  return result;
}

// Why a root of the fallback solver is not certified.
std::uint8_t TileTracer::DoubtOf(const Leaf& hard_leaf, const FallbackRoot& root, double x, double y) const {
  std::uint8_t result = 0;
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
