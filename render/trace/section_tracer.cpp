#include "render/trace/section_tracer.h"

#include <cmath>

#include "render/trace/crossings.h"
#include "render/trace/hit_geometry.h"

namespace facetless {

SectionTracer::Found SectionTracer::ResolveSample(int column, int row, std::span<const Crossing> crossings,
                                                  std::uint8_t doubt) {
  const LeafSpans leaves = shared_.view.tiles->leaves();
  const CameraFrame& frame = shared_.frame;
  const bool perspective = frame.projection == Projection::kPerspective;
  const KeptInterval kept = ClipRayToSections(PixelRay(frame, column + 0.5, row + 0.5), planes_,
                                              perspective ? frame.near_mm : -INFINITY);
  solid_crossings_.clear();
  for (const Crossing& crossing : crossings) {
    doubt |= crossing.doubt;
    solid_crossings_.push_back({crossing.hit.depth, ErrorOf(crossing),
                                solids_.ClosedSolidOfFace(leaves.Header(crossing.leaf).placed_face)});
  }
  const SectionAnswer answer = decision_.Decide(solid_crossings_, kept);

  Found found;
  found.doubt = doubt;
  if (answer.uncertain) found.doubt |= kDoubtCoincident;
  if (answer.odd) found.doubt |= kDoubtTrim;
  if (answer.kind == SectionAnswer::Kind::kCap) {
    found.depth = kept.begin;
    found.error = kept.begin_error;
    found.face = solids_.CapId(kept.plane, answer.index);
    found.normal = planes_[kept.plane].normal;
  } else if (answer.kind == SectionAnswer::Kind::kCrossing) {
    const Crossing& nearest = crossings[answer.index];
    const std::uint32_t placed_face = leaves.Header(nearest.leaf).placed_face;
    const double x = column + 0.5 - 0.5 * shared_.camera.width_px,
                 y = row + 0.5 - 0.5 * shared_.camera.height_px;
    found.depth = nearest.hit.depth;
    found.error = nearest.hit.error;
    found.face = placed_face;
    found.normal = shared_.Placed(placed_face).outward *
                   shared_.HitAt(nearest.leaf, nearest.hit.s, nearest.hit.t, x, y).normal;
    found.crossing = &nearest;
    // Another crossing within the error of the depth may be the nearest one.
    for (const Crossing& other : crossings.subspan(answer.index + 1)) {
      const double least = other.hit.depth - ErrorOf(other);
      if (least > nearest.hit.depth + ErrorOf(nearest)) continue;
      if (certify_ && leaves.Header(other.leaf).placed_face != placed_face) found.doubt |= kDoubtCoincident;
      found.error = std::fmax(found.error, nearest.hit.depth - least);
    }
  }
  return found;
}

void SectionTracer::Trace(int index, TileTracer* tracer, SampleBuffer* samples, Tally* tally) {
  crossings_.clear();
  tracer->Trace(index, &crossings_);
  SortCrossings(shared_.view, &crossings_);

  // The samples of a tile are not consecutive in the image, so find the crossings of each sample.
  const auto run_of = [&](std::uint32_t sample) -> std::span<const Crossing> {
    const auto begin = std::lower_bound(crossings_.begin(), crossings_.end(), sample,
                                        [](const Crossing& c, std::uint32_t s) { return c.sample < s; });
    auto end = begin;
    while (end != crossings_.end() && end->sample == sample) ++end;
    return {begin, end};
  };
  for (int i = 0; i < tracer->rows(); ++i) {
    for (int j = 0; j < tracer->columns(); ++j) {
      const int column = tracer->column() + j, row = tracer->row() + i;
      const std::size_t out = std::size_t(row) * samples->width + column;
      const std::uint8_t doubt = tracer->empty() ? 0 : tracer->doubt[i * kTileSize + j];
      Found found = ResolveSample(column, row, run_of(static_cast<std::uint32_t>(out)), doubt);
      // Roots of hard leaves have already been verified. Rays are not verified here, because whether a ray is
      // clear depends on what the planes remove.
      if (shared_.check && found.crossing && found.doubt == 0) {
        const std::uint32_t leaf = found.crossing->leaf;
        const TileHit& hit = found.crossing->hit;
        if (KindOf(leaf) == LeafKind::kCertified && shared_.IsRootChecked(column, row)) {
          const double error =
              shared_.view.tiles->leaves().certified[leaf].RootError(shared_.view.arithmetic);
          found.doubt = shared_.CheckRoot(
              shared_.SiteOf(leaf), {hit.s, hit.t, error, error}, column + 0.5 - shared_.frame.center_x,
              row + 0.5 - shared_.frame.center_y, found.depth, found.error, &tally->check);
        }
      }
      const Certificate certificate = CertificateForDoubt(found.doubt);
      samples->depth[out] = found.depth;
      samples->face[out] = found.face;
      samples->normal[out] = {float(found.normal.x), float(found.normal.y), float(found.normal.z)};
      samples->certificate[out] = certificate;
      samples->doubt[out] = found.doubt;
      if (!samples->depth_error.empty())
        samples->depth_error[out] = found.face == kNoIndex ? 0.0f : RoundedUp(found.error);
      if (!samples->uv.empty()) {
        samples->uv[out] = {0, 0};
        if (found.crossing) {
          const TraceShared::LeafSite site = shared_.SiteOf(found.crossing->leaf);
          samples->uv[out] = {site.u_map->ToNative(site.U(found.crossing->hit.s)),
                              site.v_map->ToNative(site.V(found.crossing->hit.t))};
        }
      }
      tally->AddDoubts(found.doubt);
      tally->certified += certificate == Certificate::kCertified;
      if (found.face == kNoIndex) continue;
      ++tally->hits;
      tally->caps += found.crossing == nullptr;
      if (certificate != Certificate::kCertified) continue;
      ++tally->certified_hits;
      tally->depth_error_max = std::max(tally->depth_error_max, found.error);
    }
  }
}

}  // namespace facetless
