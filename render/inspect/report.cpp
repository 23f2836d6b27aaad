#include "render/inspect/report.h"

#include <cmath>
#include <cstdio>
#include <string>

namespace facetless {
namespace {

using nlohmann::json;

json Vector(Vec3 v) {
  return json::array({v.x, v.y, v.z});
}

std::string HexColor(const Color& color) {
  const auto byte = [](float channel) { return static_cast<unsigned>(channel * 255 + 0.5f); };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(color.r), byte(color.g), byte(color.b));
  return text;
}

// The faces that the view shows at too few pixel centres, those without any first.
json HardlyVisibleFaces(const InspectionView& view, const Model& model) {
  json list = json::array();
  for (int pixels = 0; pixels < view.inspection.few_pixels && list.size() < kMostListedBreaks; ++pixels)
    for (std::uint32_t id = 0; id < view.face_pixels.size() && list.size() < kMostListedBreaks; ++id)
      if (view.face_pixels[id] == static_cast<std::uint32_t>(pixels))
        list.push_back({{"id", id}, {"name", model.PlacedFaceName(id)}, {"pixels", pixels}});
  return list;
}

json FaceJson(const Model& model, std::uint32_t face) {
  return {{"id", face}, {"name", model.faces[face].name}, {"entity", model.faces[face].entity}};
}

json EdgeJson(const EdgeContinuity& edge, const Model& model) {
  json out = {{"edge", edge.edge},
              {"entity", model.edges[edge.edge].entity},
              {"grade", kGradeNames[static_cast<std::size_t>(edge.grade)]},
              {"faces", {FaceJson(model, edge.faces[0]), FaceJson(model, edge.faces[1])}},
              {"length_mm", edge.length_mm},
              {"gap_mm", edge.gap_mm.value},
              {"gap_at", Vector(edge.gap_mm.at)},
              {"tolerance_mm", edge.tolerance_mm},
              {"angle_deg", edge.angle_deg.value},
              {"angle_at", Vector(edge.angle_deg.at)}};
  // A curvature jump across a sharp edge is meaningless.
  if (edge.angle_deg.value <= kAngleDeg) {
    out["curvature_jump"] = edge.curvature_jump.value;
    out["relative_jump"] = edge.relative_jump;
    out["curvatures"] = {edge.curvatures[0], edge.curvatures[1]};
    out["curvature_at"] = Vector(edge.curvature_jump.at);
  }
  return out;
}

}  // namespace

std::string SideNote(const InspectionView& view) {
  const std::uint64_t hits = view.statistics.count + view.statistics.none;
  if (!HasValues(view.inspection.kind) || view.inspection.orient != Orient::kFile ||
      2 * view.back_pixels <= hits)
    return "";
  return std::to_string(view.back_pixels) + " of " + std::to_string(hits) +
         " pixels show what the file calls the inside of a surface, but " + view.quantity.name +
         " is measured from the outside; --orient viewer takes the visible side as the outside";
}

json InspectionJson(const InspectionView& view, const Model& model) {
  json out = {{"shade", FormatInspection(view.inspection)},
              {"orient", view.inspection.orient == Orient::kViewer ? "viewer" : "file"},
              {"back_pixels", view.back_pixels}};
  if (HasValues(view.inspection.kind)) {
    if (const std::string note = SideNote(view); !note.empty()) out["note"] = note;
    const ValueStatistics& s = view.statistics;
    out["quantity"] = view.quantity.name;
    out["unit"] = view.quantity.unit;
    if (NeedsExactSurface(view.inspection.kind)) out["range"] = {view.range.low, view.range.high};
    json values = {{"count", s.count}, {"none", s.none}};
    const std::pair<const char*, double> numbers[] = {{"min", s.min}, {"p2", s.p2},   {"p50", s.p50},
                                                      {"p98", s.p98}, {"max", s.max}, {"mean", s.mean}};
    for (const auto& [name, number] : numbers) values[name] = s.count > 0 ? json(number) : json(nullptr);
    out["values"] = values;
  }
  json classes = json::array();
  for (const InspectionClass& one : view.classes)
    classes.push_back({{"name", one.name}, {"pixels", one.pixels}, {"color", HexColor(one.color)}});
  if (!classes.empty()) out["classes"] = classes;
  if (view.inspection.kind == InspectionKind::kUnseen)
    out["faces_hardly_seen"] = HardlyVisibleFaces(view, model);
  return out;
}

json ContinuityJson(const Continuity& continuity, const Model& model) {
  json counts = json::object(), worst = json::object();
  for (std::size_t grade = 0; grade < kGradeNames.size(); ++grade) {
    counts[kGradeNames[grade]] = continuity.counts[grade];
    if (static_cast<Grade>(grade) != Grade::kG2) worst[kGradeNames[grade]] = json::array();
  }
  for (const EdgeContinuity& edge : continuity.edges) {
    if (edge.grade == Grade::kG2) continue;
    json& list = worst[kGradeNames[static_cast<std::size_t>(edge.grade)]];
    if (list.size() < kMostListedBreaks) list.push_back(EdgeJson(edge, model));
  }
  return {{"tolerances",
           {{"position_share_of_diagonal", kPositionShare},
            {"angle_deg", kAngleDeg},
            {"curvature_share", kCurvatureShare},
            {"flat_per_mm", kFlatShare / model.Diagonal()}}},
          {"counts", counts},
          {"border_edges", continuity.border_edges},
          {"crowded_edges", continuity.crowded_edges},
          {"unmeasured_edges", continuity.unmeasured_edges},
          {"worst", worst}};
}

}  // namespace facetless
