#include "render/trace/tile_tracer.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// The largest band_scale. A gap seen at grazing incidence covers gap/cosine of the surface; with a larger
// factor, the band would cover the whole face.
constexpr double kMaxBandScale = 64;
// The window of a leaf's trim index covers |s|, |t| up to this: most roots in its overlap, with their errors.
constexpr double kWindow = 1 + 0x1p-10;

// A border of a patch in one of its parameters.
struct PatchBorder {
  bool across_u, high;
};

// The border on which a root lies, or beyond which it lies, within its error. Nothing at a corner, where
// there are three neighbours.
std::optional<PatchBorder> FindPatchBorder(double u, double error_u, double v, double error_v) {
  const bool low_u = u<error_u, high_u = u> 1 - error_u, low_v = v<error_v, high_v = v> 1 - error_v;
  if (low_u + high_u + low_v + high_v != 1) return {};
  return PatchBorder{low_u || high_u, high_u || high_v};
}

// Returns the error bound of the depths of a leaf's roots, if the leaf has one bound for all of them.
double DepthErrorOf(const LeafSpans& leaves, std::uint32_t leaf) {
  return KindOf(leaf) == LeafKind::kCertified ? leaves.certified[leaf].depth_error : 0;
}

}  // namespace

TileTracer::TileTracer(const TraceShared& shared, TileKernel kernel, bool certify)
    : shared_(shared), kernel_(kernel), solver_(*shared.view.nets) {
  job_.coincidences = certify;
  job_.leaves = shared.view.tiles->leaves();
  job_.arithmetic = shared.view.arithmetic;
  job_.half_width = 0.5 * shared.camera.width_px;
  job_.half_height = 0.5 * shared.camera.height_px;
  job_.near_depth = shared.frame.projection == Projection::kPerspective ? shared.frame.near_mm : -INFINITY;
  job_.axes = {shared.frame.right, shared.frame.down, shared.frame.forward, shared.frame.pixel_x,
               shared.frame.pixel_y};
}

void TileTracer::Trace(int index, std::vector<Crossing>* crossings, const std::uint32_t* active) {
  const TileLeaves& tiles = *shared_.view.tiles;
  job_.column = index % tiles.tiles_x() * kTileSize;
  job_.row = index / tiles.tiles_x() * kTileSize;
  job_.columns = std::min(kTileSize, shared_.camera.width_px - job_.column);
  job_.rows = std::min(kTileSize, shared_.camera.height_px - job_.row);
  bitmaps_.Build(tiles, index);
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
  job_.active = active;
  if (empty()) return;
  work_.fill({});
  kernel_(job_);
}

const TileTracer::KeptSite& TileTracer::KeptSiteOf(std::uint32_t id) {
  KeptSite& kept = kept_sites_[id % kKeptSites];
  if (kept.site.leaf == id) return kept;
  kept.site = shared_.SiteOf(id);
  if (KindOf(id) != LeafKind::kCertified || !IsTrimmed(id)) return kept;
  const LeafSite& site = kept.site;
  kept.window = shared_.scene.faces[site.placed.face].trim.WindowOf(
      site.u_map->ToNative(site.U(-kWindow)), site.u_map->ToNative(site.U(kWindow)),
      site.v_map->ToNative(site.V(-kWindow)), site.v_map->ToNative(site.V(kWindow)), kMaxBandScale);
  return kept;
}

bool TileTracer::IsInsideFace(std::uint32_t id, double hit_s, double hit_t, double x, double y,
                              std::uint8_t* hit_doubt) {
  const KeptSite& kept = KeptSiteOf(id);
  return IsInsideFace(kept.site, &kept.window, MakeRoot(job_.leaves.certified[id], hit_s, hit_t), x, y,
                      hit_doubt);
}

bool TileTracer::OwnsBorderRoot(std::uint32_t id, double x, double y, TileHit* hit, std::uint8_t* hit_doubt) {
  return OwnsBorderRoot(SiteOf(id), MakeRoot(job_.leaves.certified[id], hit->s, hit->t), x, y, hit,
                        hit_doubt);
}

void TileTracer::RecordHit(int sample, std::uint32_t id, const TileHit& hit, std::uint8_t hit_doubt) {
  const int row = job_.row + sample / kTileSize, column = job_.column + sample % kTileSize;
  crossings_->push_back(
      {static_cast<std::uint32_t>(row * shared_.camera.width_px + column), id, hit, hit_doubt});
}

int TileTracer::SampleAt(double x, double y) const {
  const int row = static_cast<int>(y - 0.5 + job_.half_height) - job_.row;
  const int column = static_cast<int>(x - 0.5 + job_.half_width) - job_.column;
  return row * kTileSize + column;
}

TileTracer::Root TileTracer::MakeRoot(const CertifiedLeaf& certified, double root_s, double root_t) const {
  const double root_error = certified.RootError(job_.arithmetic);
  return {root_s, root_t, root_error, root_error,
          certified.c11 * certified.c22 - certified.c12 * certified.c21};
}

TileTracer::Root TileTracer::MakeRoot(const FallbackRoot& root) {
  return {root.hit.s, root.hit.t, root.error_s, root.error_t, root.proven ? root.jacobian_sign : 0};
}

TrimAnswer TileTracer::QueryTrim(const LeafSite& site, const TrimWindow* window, const Root& root,
                                 double cosine) const {
  // Map the hit to native parameters. The curve is never mapped.
  const double u = site.U(root.s), v = site.V(root.t);
  const double native_u = site.u_map->ToNative(u), native_v = site.v_map->ToNative(v);
  const double error_u = root.error_s * site.rect.u_half / site.u_map->Rate(u),
               error_v = root.error_t * site.rect.v_half / site.v_map->Rate(v);
  const double band_scale = std::min(kMaxBandScale, 1 / cosine);
  const FaceTrim& trim = shared_.scene.faces[site.placed.face].trim;
  return window != nullptr ? trim.Query(*window, native_u, native_v, error_u, error_v, band_scale)
                           : trim.Query(native_u, native_v, error_u, error_v, band_scale);
}

bool TileTracer::IsInsideFace(const LeafSite& site, const TrimWindow* window, const Root& root, double x,
                              double y, std::uint8_t* hit_doubt) {
  // Most hits lie farther from every edge than the widest band.
  const TrimAnswer far = QueryTrim(site, window, root, 1 / kMaxBandScale);
  if (far.certain && far.coedge == kNoIndex) return far.inside;
  const TraceShared::PlacedFace& placed = site.placed;
  const HitGeometry geometry = shared_.HitAt(site.leaf, root.s, root.t, x, y);
  const TrimAnswer answer = QueryTrim(site, window, root, geometry.cosine);

  // In the band of an edge, the edge itself decides for both faces.
  if (answer.coedge != kNoIndex && root.jacobian_sign != 0) {
    const double mm_per_px = std::max(shared_.frame.pixel_x, shared_.frame.pixel_y) *
                             (shared_.frame.projection == Projection::kPerspective ? geometry.depth : 1);
    const EdgeDecision decision = DecideAtEdge(
        *shared_.scene.model, shared_.edges[placed.instance], answer, x + 0.5 * shared_.camera.width_px,
        y + 0.5 * shared_.camera.height_px, mm_per_px, root.jacobian_sign > 0);
    if (decision.verdict != EdgeVerdict::kUnknown) {
      if (!decision.proven && !OnSeam(site, root, answer, geometry.depth, x, y)) *hit_doubt |= kDoubtTrim;
      return decision.verdict == EdgeVerdict::kKeep;
    }
  }
  if (answer.certain) return answer.inside;
  // A closed surface without trimming continues across its border.
  if (shared_.scene.faces[placed.face].trim.whole() &&
      FindNeighbourRoot(site, root, {geometry.depth, root.s, root.t, DepthErrorOf(job_.leaves, site.leaf)}, x,
                        y))
    return true;
  *hit_doubt |= kDoubtTrim;
  return answer.inside;
}

template <typename Found>
bool TileTracer::ForEachRoot(std::uint32_t placed_face, double x, double y, const Found& found) {
  const int sample = SampleAt(x, y);
  RayWork& work = work_[sample];
  const std::uint64_t* rows = bitmaps_.Row(sample / kTileSize);
  const std::uint64_t* columns = bitmaps_.Column(sample % kTileSize);
  // A seam leaf examines all leaves of its ray, so many seams on one ray multiply the work.
  work.Spend(job_.words);
  for (int word = 0; word < job_.words; ++word) {
    for (std::uint64_t bits = rows[word] & columns[word]; bits != 0; bits &= bits - 1) {
      const std::uint32_t id = job_.list[64 * word + __builtin_ctzll(bits)].leaf;
      const LeafHeader& candidate = job_.leaves.Header(id);
      work.Spend(1);
      if (candidate.placed_face != placed_face || KindOf(id) == LeafKind::kSeam) continue;
      work.Spend(candidate.points());
      if (work.exhausted()) return false;
      if (KindOf(id) == LeafKind::kHard) {
        std::vector<FallbackRoot> roots;
        solver_.Solve(job_.leaves.hard[IndexWithin(id)], shared_.SiteOf(id).rect, x, y, INFINITY, &work,
                      &roots);
        for (const FallbackRoot& root : roots) found(id, MakeRoot(root), root.hit);
        continue;
      }
      const CertifiedLeaf& certified = job_.leaves.certified[id];
      TileHit hit;
      if (SolveSample(certified, job_.arithmetic, x, y, &hit) == SampleRoot::kHit)
        found(id, MakeRoot(certified, hit.s, hit.t), hit);
    }
  }
  return !work.exhausted();
}

std::optional<TileTracer::Neighbour> TileTracer::FindNeighbourRoot(const LeafSite& own, const Root& root,
                                                                   const TileHit& own_hit, double x,
                                                                   double y) {
  const std::optional<PatchBorder> border = FindPatchBorder(
      own.rect.U(root.s), root.error_s * own.rect.u_half, own.rect.V(root.t), root.error_t * own.rect.v_half);
  if (!border || root.jacobian_sign == 0) return {};

  // Find the patch across the border; on a closed surface, this may be the patch at the other end.
  const Model& model = *shared_.scene.model;
  const Surface& surface = model.surfaces[model.faces[own.placed.face].surface];
  const std::uint32_t nu = surface.u_spans.count, nv = surface.v_spans.count;
  std::uint32_t i = own.patch / nv, j = own.patch % nv;
  std::uint32_t& across = border->across_u ? i : j;
  const std::uint32_t count = border->across_u ? nu : nv;
  across = border->high ? (across + 1) % count : (across + count - 1) % count;
  const std::uint32_t patch = i * nv + j;

  // The two roots may differ along the border and across it by the overlap of neighbours, in native
  // parameters.
  const auto native = [&](const LeafSite& site, const Root& at) {
    struct Native {
      double along, reach_along, reach_off, rate_off;
    };
    const double u = site.U(at.s), v = site.V(at.t);
    const double rate_u = site.u_map->Rate(u), rate_v = site.v_map->Rate(v);
    const double reach_u = (kBorderOverlap + 4 * at.error_s) * site.rect.u_half / rate_u,
                 reach_v = (kBorderOverlap + 4 * at.error_t) * site.rect.v_half / rate_v;
    return border->across_u ? Native{site.v_map->ToNative(v), reach_v, reach_u, rate_u}
                            : Native{site.u_map->ToNative(u), reach_u, reach_v, rate_v};
  };
  const auto here = native(own, root);
  // The depths must agree, too: the depth changes by its error if the root moves by its own. (The ends of a
  // surface that is not closed may lie behind each other.)
  const auto depth_reach = [](const Root& at, double error) {
    return error * (4 + kBorderOverlap / std::min(at.error_s, at.error_t));
  };

  std::optional<Neighbour> neighbour;
  const auto consider = [&](const LeafSite& site, const Root& other, const TileHit& hit) {
    const auto there = native(site, other);
    const double beyond_low = border->across_u ? site.rect.U(other.s) : site.rect.V(other.t);
    const double inside = border->high ? beyond_low : 1 - beyond_low;  // position of the opposite border
    const double error =
        border->across_u ? other.error_s * site.rect.u_half : other.error_t * site.rect.v_half;
    if (other.jacobian_sign * root.jacobian_sign <= 0 ||
        std::fabs(here.along - there.along) > here.reach_along + there.reach_along ||
        std::fabs(inside) > (here.reach_off + there.reach_off) * there.rate_off ||
        !(std::fabs(hit.depth - own_hit.depth) <=
          depth_reach(root, own_hit.error) + depth_reach(other, hit.error)))
      return;
    neighbour = Neighbour{hit.depth, hit.error, inside >= -error};
  };

  const bool complete =
      ForEachRoot(own.placed_face, x, y, [&](std::uint32_t id, const Root& other, const TileHit& hit) {
        if (!neighbour && job_.leaves.Place(id).patch == patch) consider(shared_.SiteOf(id), other, hit);
      });
  return complete ? neighbour : std::nullopt;
}

bool TileTracer::OnSeam(const LeafSite& own, const Root& root, const TrimAnswer& answer, double depth,
                        double x, double y) {
  // The face continues there: whichever coedge gets the ray, there is a hit.
  const Model& model = *shared_.scene.model;
  // At a corner, another edge takes part in the decision.
  if (answer.other_coedge != kNoIndex &&
      model.coedges[answer.other_coedge].edge != model.coedges[answer.coedge].edge)
    return false;
  bool again = false;
  const double own_error = DepthErrorOf(job_.leaves, own.leaf);
  ForEachRoot(own.placed_face, x, y, [&](std::uint32_t id, const Root& other, const TileHit& hit) {
    if (again || other.jacobian_sign * root.jacobian_sign <= 0) return;
    if (std::fabs(hit.depth - depth) > hit.error + own_error) return;
    const HitGeometry geometry = shared_.HitAt(id, other.s, other.t, x, y);
    const TrimAnswer there = QueryTrim(shared_.SiteOf(id), nullptr, other, geometry.cosine);
    again = there.coedge != kNoIndex && there.coedge != answer.coedge &&
            model.coedges[there.coedge].edge == model.coedges[answer.coedge].edge;
  });
  return again;
}

bool TileTracer::OwnsBorderRoot(const LeafSite& site, const Root& root, double x, double y, TileHit* hit,
                                std::uint8_t* hit_doubt) {
  // If both patches have the root with the same orientation, the border runs between their images. Exactly
  // one of them contains the ray, and the ray meets the surface once.
  const std::optional<Neighbour> neighbour = FindNeighbourRoot(site, root, *hit, x, y);
  if (!neighbour || !neighbour->within) {
    *hit_doubt |= kDoubtTwoRoots;
    return true;
  }
  // A root beyond the border belongs to the neighbour, unless there is an edge, which then decides.
  const double u = site.rect.U(root.s), v = site.rect.V(root.t);
  const double error_u = root.error_s * site.rect.u_half, error_v = root.error_t * site.rect.v_half;
  const bool beyond = u < -error_u || u > 1 + error_u || v < -error_v || v > 1 + error_v;
  if (beyond && !IsTrimmed(site.leaf)) return false;
  hit->error += neighbour->error + std::fabs(neighbour->depth - hit->depth);
  return true;
}

bool TileTracer::IsTrimmed(std::uint32_t id) const {
  return (job_.leaves.Header(id).flags & kLeafTrimmed) != 0;
}

std::uint8_t TileTracer::SolveSeam(const SeamLeaf& seam, double x, double y, RootSink* roots) {
  // Find every root of the face on this ray that lies inside the trimming.
  seam_roots_.clear();
  const bool complete =
      ForEachRoot(seam.placed_face, x, y, [&](std::uint32_t id, const Root& root, const TileHit& hit) {
        std::uint8_t ignored = 0;
        if (!(hit.depth > job_.near_depth)) return;
        if (IsTrimmed(id) && !IsInsideFace(shared_.SiteOf(id), nullptr, root, x, y, &ignored)) return;
        seam_roots_.emplace_back(shared_.view, id, hit);
      });
  if (!complete) return kDoubtLimit;

  // Add one crossing if the parity of the roots differs from the parity that the border requires.
  std::sort(seam_roots_.begin(), seam_roots_.end(),
            [](const RootTwin& a, const RootTwin& b) { return a.depth < b.depth; });
  const auto end = std::unique(seam_roots_.begin(), seam_roots_.end(),
                               [](const RootTwin& a, const RootTwin& b) { return a.Is(b); });
  const bool odd = (end - seam_roots_.begin()) % 2 != 0;
  if (odd != seam.odd && seam.near_depth > job_.near_depth)
    roots->Add({seam.near_depth, seam.s, seam.t, INFINITY}, kDoubtTrim, true);
  return 0;
}

std::uint8_t TileTracer::SolveUncertified(std::uint32_t id, double x, double y, double limit,
                                          RootSink* roots) {
  if (KindOf(id) == LeafKind::kSeam) return SolveSeam(job_.leaves.seams[IndexWithin(id)], x, y, roots);
  const HardLeaf& leaf = job_.leaves.hard[IndexWithin(id)];
  RayWork& work = work_[SampleAt(x, y)];
  if (solver_.Misses(leaf, x, y, &work)) return 0;
  const LeafSite& site = SiteOf(id);
  roots_.clear();
  const std::uint8_t result = solver_.Solve(leaf, site.rect, x, y, limit, &work, &roots_);
  for (const FallbackRoot& root : roots_) {
    if (!(root.hit.depth > job_.near_depth)) continue;
    const Root at = MakeRoot(root);
    std::uint8_t root_doubt = DoubtForRoot(id, root, x, y);
    TileHit hit = root.hit;
    if (shared_.check && root.proven && root_doubt == 0)
      root_doubt |= shared_.CheckRoot(site, {hit.s, hit.t, root.error_s, root.error_t}, x, y, hit.depth,
                                      hit.error, &check);
    if (root.on_border && !OwnsBorderRoot(site, at, x, y, &hit, &root_doubt)) continue;
    bool kept = true;
    if (IsTrimmed(id)) {
      ++counters.trim_tests;
      kept = IsInsideFace(site, nullptr, at, x, y, &root_doubt);
    }
    roots->Add(hit, root_doubt, kept);
  }
  return result;
}

// The reasons why a root of the fallback solver is not certified.
std::uint8_t TileTracer::DoubtForRoot(std::uint32_t id, const FallbackRoot& root, double x, double y) const {
  std::uint8_t result = 0;
  if (!root.proven) {
    const bool singular = shared_.HitAt(id, root.hit.s, root.hit.t, x, y).singular;
    result |= singular ? kDoubtPole : kDoubtSilhouette;
  }
  // Look for another root of the same leaf, which is not the same root found again at the border of two
  // pieces.
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
