#include "render/compare/report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <unordered_set>

#include "render/model/walk.h"
#include "render/nurbs/open_edges.h"

namespace facetless {
namespace {

using nlohmann::json;

json Vector(Vec3 v) {
  return json::array({v.x, v.y, v.z});
}

// Returns null unless the number is finite: JSON has no other numbers.
json Finite(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

template <typename T>
json OrNull(const std::optional<T>& value) {
  return value ? json(*value) : json(nullptr);
}

json SpreadJson(const Spread& spread) {
  return {{"mean", spread.mean},
          {"mean_abs", spread.mean_abs},
          {"rms", spread.rms},
          {"p50", spread.p50},
          {"p95", spread.p95},
          {"p99", spread.p99},
          {"max", spread.max},
          {"pixels", spread.count},
          {"max_at", spread.count > 0 ? json::array({spread.max_x, spread.max_y}) : json(nullptr)}};
}

json LossJson(const Loss& loss) {
  return {{"id", loss.face == kNoIndex ? json(nullptr) : json(loss.face)},
          {"name", loss.name},
          {"entity", loss.entity},
          {"reason", loss.reason}};
}

json LossesJson(const std::vector<Loss>& losses) {
  json list = json::array();
  for (const Loss& loss : losses) list.push_back(LossJson(loss));
  return list;
}

json OpenEdgesJson(const Model& model) {
  const std::vector<OpenEdge> open = FindOpenEdges(model);
  json list = json::array();
  for (std::size_t i = 0; i < std::min(open.size(), kMostListedEdges); ++i) {
    json faces = json::array();
    for (const std::uint32_t face : open[i].faces)
      faces.push_back({{"id", face}, {"name", model.faces[face].name}, {"entity", model.faces[face].entity}});
    list.push_back({{"edge", open[i].edge},
                    {"cause", OpenCauseName(open[i].cause)},
                    {"faces", std::move(faces)},
                    {"gap_mm", open[i].gap_mm},
                    {"tolerance_mm", open[i].tolerance_mm},
                    {"length_mm", open[i].length_mm},
                    {"at", Vector(open[i].at)}});
  }
  return {{"count", open.size()}, {"worst", std::move(list)}};
}

json UnseenJson(const View& view) {
  json list = json::array();
  for (std::size_t i = 0; i < std::min(view.direct->unseen_faces.size(), kMostListedFaces); ++i)
    list.push_back({{"id", view.direct->unseen_faces[i]}, {"name", view.unseen_names[i]}});
  return list;
}

}  // namespace

json CameraJson(const Camera& camera) {
  json out = {{"eye", Vector(camera.eye)},
              {"target", Vector(camera.target)},
              {"up", Vector(camera.up)},
              {"width", camera.width_px},
              {"height_px", camera.height_px}};
  if (camera.projection == Projection::kOrthographic) {
    out["projection"] = "orthographic";
    out["height"] = camera.height;
  } else {
    out["projection"] = "perspective";
    out["fov_y_deg"] = camera.fov_y_deg;
  }
  return out;
}

// Counts the faces of the file in all placements. A face that the importer had to split counts once.
std::uint64_t PlacedFilesFaces(const Model& model) {
  std::vector<std::uint64_t> of_part;
  for (const Part& part : model.parts) {
    std::unordered_set<std::string_view> entities;
    std::uint64_t unnamed = 0;
    for (const Face& face : FacesOf(model, part)) {
      if (face.entity.empty()) {
        ++unnamed;
      } else {
        entities.insert(face.entity);
      }
    }
    of_part.push_back(entities.size() + unnamed);
  }
  std::uint64_t faces = 0;
  for (const Instance& instance : model.instances) faces += of_part[instance.part];
  return faces;
}

// Returns a sentence that says why the picture does not have as many faces as the file declares; null if it
// has.
json FacesNote(const Model& model) {
  const ImportInfo& info = model.info;
  const std::uint64_t faces = PlacedFilesFaces(model), pieces = model.PlacedFaceCount();
  std::string note;
  if (faces != info.faces_declared) {
    note = "The file declares " + std::to_string(info.faces_declared) + " faces; " +
           std::to_string(info.faces_imported) + " of them are shown";
    if (!info.faces_lost.empty()) note += ", " + std::to_string(info.faces_lost.size()) + " are skipped";
    if (faces != info.faces_imported)
      note += "; " + std::to_string(model.instances.size()) + " placements show " + std::to_string(faces);
    note += ".";
  }
  if (pieces != faces) {
    note += note.empty() ? "" : " ";
    note += "Some faces are split: each of the " + std::to_string(pieces) + " pieces has an id of its own.";
  }
  return note.empty() ? json(nullptr) : json(note);
}

json ModelJson(const Model& model) {
  const ImportInfo& info = model.info;
  std::uint64_t hidden_placements = 0, hidden_faces = 0;
  for (const Instance& instance : model.instances) {
    if (!instance.hidden) continue;
    ++hidden_placements;
    hidden_faces += model.parts[instance.part].faces.count;
  }
  std::map<std::string, std::uint64_t> surfaces;
  std::uint64_t patches = 0;
  for (const Surface& surface : model.surfaces) {
    ++surfaces[SurfaceKindName(surface.kind)];
    patches += surface.PatchCount();
  }
  std::uint64_t placed_solids = 0;
  for (const Instance& instance : model.instances) placed_solids += model.parts[instance.part].solids.count;
  json approximated = json::array();
  for (const Approximation& approximation : info.approximated) {
    const Face& face = model.faces[approximation.face];
    approximated.push_back({{"id", approximation.face},
                            {"name", face.name.empty() ? face.entity : face.name},
                            {"deviation_mm", approximation.deviation_mm}});
  }
  // Other formats are healed by OpenCASCADE's readers, which do not tell what they changed.
  json healed = info.format.starts_with("STEP") ? json::array() : json();
  for (const HealedBody& body : info.healed)
    healed.push_back({{"name", body.name},
                      {"entity", body.entity},
                      {"reason", body.reason},
                      {"faces", body.faces},
                      {"faces_changed", body.faces_changed},
                      {"edges_changed", body.edges_changed},
                      {"pcurves_changed", body.pcurves_changed},
                      {"moved_mm", body.moved_mm}});
  return {{"file", info.file},
          {"sha256", info.sha256},
          {"format", info.format},
          {"unit", info.unit},
          {"unit_mm", info.unit_mm},
          {"diagonal_mm", model.Diagonal()},
          {"bounds_mm", model.bounds.empty()
                            ? json(nullptr)
                            : json::array({Vector(model.bounds.low), Vector(model.bounds.high)})},
          {"solids", placed_solids},
          {"faces", PlacedFilesFaces(model)},
          {"prototypes",
           {{"parts", model.parts.size()}, {"faces", model.faces.size()}, {"solids", model.solids.size()}}},
          {"placements", model.instances.size()},
          {"hidden", {{"placements", hidden_placements}, {"faces", hidden_faces}}},
          {"faces_declared", info.faces_declared},
          {"faces_shown", info.faces_imported},
          {"faces_note", FacesNote(model)},
          {"faces_skipped", LossesJson(info.faces_lost)},
          {"loops_lost", LossesJson(info.loops_lost)},
          {"edges_lost", LossesJson(info.edges_lost)},
          {"faces_approximated", approximated},
          {"bodies_healed", std::move(healed)},
          {"surfaces", surfaces},
          {"patches", patches},
          {"warnings", info.warnings},
          {"edge_gap_mm_max", info.max_edge_gap_mm},
          {"edge_gap_entity", info.max_edge_gap_entity},
          {"open_edges", OpenEdgesJson(model)},
          {"import_ms", info.read_ms + info.transfer_ms + info.convert_ms},
          {"import_peak_bytes", info.peak_bytes}};
}

json DoubtsJson(const DirectStats& stats) {
  json doubts = json::object();
  for (std::size_t bit = 0; bit < kDoubtNames.size(); ++bit) doubts[kDoubtNames[bit]] = stats.doubts[bit];
  return doubts;
}

// Returns the result of the independent check of certificates; null if it was not requested.
json CheckJson(const CheckStats& check) {
  if (check.roots == 0 && check.rays == 0) return nullptr;
  return {{"roots", check.roots},
          {"roots_contradicted", check.roots_contradicted},
          {"rays", check.rays},
          {"rays_contradicted", check.rays_contradicted},
          {"rays_open", check.rays_open}};
}

json TraceCountersJson(const DirectStats& stats) {
  return {{"rays", stats.rays},
          {"hits", stats.hits},
          {"leaves", stats.leaves},
          {"hard_leaves", stats.hard_leaves},
          {"candidates", stats.candidates},
          {"solves", stats.solves},
          {"iterations", stats.iterations},
          {"fallbacks", stats.fallbacks},
          {"trim_tests", stats.trim_tests},
          {"certified", stats.certified},
          {"converged", stats.converged},
          {"unresolved", stats.unresolved},
          {"isa", stats.isa}};
}

// Returns "light" of a view of any representation; null if no secondary rays were cast.
json LightJson(const View& view) {
  if (!view.light) return nullptr;
  const ViewLight& light = *view.light;
  json doubts = json::object();
  for (std::size_t bit = 0; bit < kDoubtNames.size(); ++bit)
    doubts[kDoubtNames[bit]] = light.stats.doubts[bit];
  json materials = json::array();
  for (const MaterialRule& rule : light.options.materials) materials.push_back(FormatMaterial(rule));
  return {
      {"shadows", light.options.shadows},
      {"occlusion_rays", light.options.occlusion_rays},
      {"occlusion_radius_mm",
       light.options.occlusion_rays > 0 ? json(light.options.occlusion_radius_mm) : json(nullptr)},
      {"ground", light.options.ground},
      {"materials", std::move(materials)},
      {"bounces", light.options.materials.empty() ? json(nullptr) : json(light.options.bounces)},
      {"environment", light.options.environment.empty() ? json(nullptr) : json(light.options.environment)},
      {"structure", light.rays->structure()},
      {"lift_mm", light.rays->lift_mm()},
      {"samples", light.stats.samples},
      {"certified", light.stats.certified},
      {"doubts", std::move(doubts)},
      {"rays", light.stats.rays},
      {"rays_blocked", light.stats.blocked},
      {"rays_certified", light.stats.certified_rays},
      {"timing_ms", {{"build", light.build_ms}, {"cast", light.cast_ms}}},
      {"bytes", light.rays->bytes()}};
}

json LightDifferenceJson(const std::optional<LightComparison>& comparison) {
  if (!comparison) return nullptr;
  const LightDifference& light = comparison->difference;
  json out = {{"pixels", light.pixels}, {"shadow", nullptr}, {"occlusion", nullptr}};
  if (light.shadows)
    out["shadow"] = {{"share", light.OtherShadowShare()},
                     {"lit_only_reference", light.lit_only_reference},
                     {"lit_only_candidate", light.lit_only_candidate},
                     {"false_self_shadow", OrNull(light.false_self_shadow)}};
  if (light.occlusion)
    out["occlusion"] = {
        {"mean", light.occlusion_mean}, {"mean_abs", light.occlusion_mean_abs}, {"max", light.occlusion_max}};
  return out;
}

// The figures of a solver by name; null for the certified tracer.
json SolverJson(const View& view) {
  if (!view.solver) return nullptr;
  const SolverStats& stats = *view.solver;
  json stops = json::object();
  for (std::size_t i = 0; i < kSolverStopNames.size(); ++i)
    stops[kSolverStopNames[i]] = stats.counters.stops[i];
  const bool map = stats.starts != SolverStarts::kPieces;
  return {{"name", stats.name},
          {"starts", kSolverStartsNames[static_cast<std::size_t>(stats.starts)]},
          {"structure", map ? json(nullptr) : json(stats.structure)},
          {"pieces", stats.pieces},
          {"roots", stats.counters.roots},
          {"stops", std::move(stops)},
          {"rays_without_start", map ? json(stats.no_start) : json(nullptr)}};
}

json DirectJson(const View& view) {
  const DirectStats& stats = *view.direct;
  json direct = {{"timing_ms",
                  {{"prepare", stats.prepare_ms},
                   {"trace", stats.trace_ms},
                   {"color", view.color_ms},
                   {"lines", view.lines_ms},
                   {"shade", view.shade_ms},
                   {"total", view.total_ms}}},
                 {"certified_hits", stats.certified_hits},
                 {"cap_hits", stats.caps},
                 {"doubts", DoubtsJson(stats)},
                 {"check", CheckJson(stats.check)},
                 {"depth_error_mm_max", stats.depth_error_max},
                 {"odd_rays", OrNull(stats.odd_rays)},
                 {"reverse_mismatches", OrNull(stats.reverse_mismatches)},
                 {"unseen_faces", UnseenJson(view)},
                 {"unseen_face_count", stats.unseen_faces.size()},
                 {"bmssm", {{"bits", stats.bmssm_bits}, {"bytes", stats.bmssm_bytes}}},
                 {"samples_per_pixel", view.grid.count()},
                 {"refined_pixels", OrNull(view.refined_pixels)},
                 {"light", LightJson(view)},
                 {"method", SolverJson(view)},
                 {"peak_bytes", view.peak_bytes}};
  direct.update(TraceCountersJson(stats));
  return direct;
}

json BaselineJson(const View& view, const BaselineScene& scene) {
  const Mesh& mesh = scene.mesh();
  return {{"triangles", scene.triangles()},
          {"from_model", mesh.from_model},
          {"deflection_mm", mesh.deflection_mm > 0 ? json(mesh.deflection_mm) : json(nullptr)},
          {"angular_deg", mesh.angular_deg > 0 ? json(mesh.angular_deg) : json(nullptr)},
          {"faces_unmeshed", mesh.faces_unmeshed},
          {"timing_ms",
           {{"mesh", mesh.mesh_ms},
            {"build", scene.build_ms()},
            {"trace", view.counters.trace_ms},
            {"color", view.color_ms},
            {"shade", view.shade_ms},
            {"total", mesh.mesh_ms + scene.build_ms() + view.total_ms}}},
          {"rays", view.counters.rays},
          {"hits", view.counters.hits},
          {"refined_pixels", OrNull(view.refined_pixels)},
          {"light", LightJson(view)},
          {"bvh_bytes", scene.bvh_bytes()},
          {"peak_bytes", view.peak_bytes}};
}

json DifferenceJson(const Difference& difference, const DifferencePicture& picture) {
  const ColorMetrics& color = difference.color;
  const Silhouette& silhouette = difference.silhouette;
  json faces = json::array();
  for (std::size_t i = 0; i < std::min(difference.faces.size(), kMostListedFaces); ++i) {
    const FaceDifference& face = difference.faces[i];
    faces.push_back({{"id", face.id},
                     {"name", face.name},
                     {"depth_mm_max", face.depth_mm_max},
                     {"pixels", face.pixels},
                     {"deviation_mm_max", face.deviation_mm_max},
                     {"deviation_mm_mean", face.deviation_mm_mean},
                     {"normal_deg_max", face.normal_deg_max},
                     {"missed_pixels", face.missed_pixels},
                     {"other_face_pixels", face.other_face_pixels},
                     {"border_pixels", face.border_pixels}});
  }
  return {{"color",
           {{"max", color.max},
            {"mean", color.mean},
            {"rms", color.rms},
            {"psnr", Finite(color.psnr)},
            {"ssim", color.ssim},
            {"flip_mean", color.flip_mean},
            {"flip_p95", color.flip_p95},
            {"share_over_threshold", color.share_over_threshold},
            {"threshold", color.threshold},
            {"pixels_per_degree", color.pixels_per_degree}}},
          {"silhouette",
           {{"pixels", silhouette.pixels},
            {"max_distance_px", Finite(silhouette.max_distance_px)},
            {"only_direct", silhouette.only_direct},
            {"only_baseline", silhouette.only_baseline}}},
          {"depth_mm", SpreadJson(difference.depth_mm)},
          {"deviation_mm", SpreadJson(difference.deviation_mm)},
          {"noise_mm", difference.noise_mm},
          {"normal_deg", SpreadJson(difference.normal_deg)},
          {"both_hit", difference.both_hit},
          {"border", {{"pixels", difference.border_pixels}, {"share", difference.border_share}}},
          {"other_face", difference.faces_known ? json{{"pixels", difference.other_face_pixels},
                                                       {"share", difference.other_face_share}}
                                                : json(nullptr)},
          {"picture_range_mm", picture.range_mm},
          {"faces", faces},
          {"face_count", difference.faces.size()}};
}

json CandidateDifferenceJson(const CandidateView& candidate) {
  json difference = DifferenceJson(candidate.difference, candidate.picture);
  difference["light"] = LightDifferenceJson(candidate.light);
  return difference;
}

json CandidateJson(const CandidateView& candidate) {
  const View& view = candidate.view;
  json facts = json::object();
  for (const RepresentationFact& fact : candidate.facts) facts[fact.name] = fact.value;
  return {{"name", candidate.name},
          {"title", candidate.title},
          {"timing_ms",
           {{"make", candidate.make_ms},
            {"prepare", view.counters.prepare_ms},
            {"trace", view.counters.trace_ms},
            {"color", view.color_ms},
            {"shade", view.shade_ms},
            {"total", candidate.make_ms + view.total_ms},
            {"difference", candidate.difference_ms}}},
          {"rays", view.counters.rays},
          {"hits", view.counters.hits},
          {"refined_pixels", OrNull(view.refined_pixels)},
          {"light", LightJson(view)},
          {"method", SolverJson(view)},
          {"facts", std::move(facts)},
          {"peak_bytes", view.peak_bytes},
          {"difference", CandidateDifferenceJson(candidate)}};
}

json ComparisonJson(const ViewComparison& comparison, const BaselineScene* baseline) {
  json view = {{"name", comparison.camera.name},
               {"camera", CameraJson(comparison.camera)},
               {"direct", DirectJson(comparison.reference)}};
  std::size_t others = 0;
  if (baseline != nullptr) {
    const CandidateView& mesh = comparison.candidates[others++];
    view["baseline"] = BaselineJson(mesh.view, *baseline);
    view["difference"] = CandidateDifferenceJson(mesh);
    view["timing_ms"] = {{"difference", mesh.difference_ms}};
  }
  for (; others < comparison.candidates.size(); ++others)
    view["candidates"].push_back(CandidateJson(comparison.candidates[others]));
  return view;
}

}  // namespace facetless
