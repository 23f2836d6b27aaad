#include "render/trace/trace_shared.h"

#include "render/model/walk.h"

namespace facetless {
namespace {

// Returns how far outside a leaf its own roots may lie.
double OverlapOf(const PreparedView& view, std::uint32_t leaf) {
  if (KindOf(leaf) != LeafKind::kCertified) return kBorderOverlap;
  return Overlap(view.tiles->leaves().certified[leaf].RootError(view.arithmetic));
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

TraceShared::LeafSite TraceShared::SiteOf(std::uint32_t leaf) const {
  const LeafSpans leaves = view.tiles->leaves();
  const LeafPlace place = leaves.Place(leaf);
  LeafSite site;
  site.leaf = leaf;
  site.placed_face = leaves.Header(leaf).placed_face;
  site.patch = place.patch;
  site.placed = Placed(site.placed_face);
  site.overlap = OverlapOf(view, leaf);
  const Surface& surface = scene.model->surfaces[scene.model->faces[site.placed.face].surface];
  const FaceData& data = scene.faces[site.placed.face];
  const std::uint32_t i = place.patch / surface.v_spans.count, j = place.patch % surface.v_spans.count;
  // The parameters of a seam leaf are those of the whole patch.
  const bool is_seam = KindOf(leaf) == LeafKind::kSeam;
  site.rect = RectOf(place, is_seam ? PatchBounds{} : SetBoxBounds(data, surface, i, j));
  site.u_map = &scene.spans[surface.u_spans.first + i];
  site.v_map = &scene.spans[surface.v_spans.first + j];
  site.u_low_continued = i == 0 && data.u_low_continued;
  site.u_high_continued = i + 1 == surface.u_spans.count && data.u_high_continued;
  site.v_low_continued = j == 0 && data.v_low_continued;
  site.v_high_continued = j + 1 == surface.v_spans.count && data.v_high_continued;
  return site;
}

HitGeometry TraceShared::HitAt(std::uint32_t leaf, double s, double t, double x, double y) const {
  const LeafSpans leaves = view.tiles->leaves();
  const std::uint32_t index = IndexWithin(leaf);
  switch (KindOf(leaf)) {
    case LeafKind::kHard:
      return EvaluateHit(leaves.hard[index], s, t, x, y, frame);
    case LeafKind::kSeam:
      return EvaluateHit(leaves.seams[index], s, t, x, y, frame);
    default:
      return EvaluateHit(leaves.certified[index], view.arithmetic, s, t, x, y, frame);
  }
}

std::uint8_t TraceShared::CheckRoot(const LeafSite& site, const LeafRoot& root, double x, double y,
                                    double depth, double error, CheckStats* stats) const {
  ++stats->roots;
  const bool holds =
      check->RootHolds({site.placed.instance, site.placed.face, site.patch, site.rect.U(root.s),
                        site.rect.V(root.t), root.error_s * site.rect.u_half, root.error_t * site.rect.v_half,
                        x + frame.center_x, y + frame.center_y, depth, error});
  if (holds) return 0;
  ++stats->roots_contradicted;
  return kDoubtContradicted;
}

RootTwin::RootTwin(const PreparedView& view, std::uint32_t leaf, const TileHit& hit) : depth(hit.depth) {
  const double overlap = OverlapOf(view, leaf), border = 1 - 2 * overlap;
  const LeafKind kind = KindOf(leaf);
  on_border = kind == LeafKind::kHard ||
              (kind == LeafKind::kCertified && (std::fabs(hit.s) >= border || std::fabs(hit.t) >= border));
  // An error of the root changes the depth by at most that error times the leaf's depth range; in a hard
  // leaf, by the depth range of a piece of the smallest size.
  const double near_depth = view.tiles->leaves().Header(leaf).near_depth;
  error = std::fabs(hit.depth) * 0x1p-44 + std::fabs(hit.depth - near_depth) * 2 * overlap;
}

}  // namespace facetless
