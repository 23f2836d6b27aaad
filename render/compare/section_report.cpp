#include "render/compare/section_report.h"

#include <algorithm>

#include "render/baseline/mesh_section.h"

namespace facetless {
namespace {

using nlohmann::json;

constexpr std::size_t kMostListed = 100;  // solids, and faces in the plane, per section

json Vector(Vec3 v) {
  return json::array({v.x, v.y, v.z});
}

}  // namespace

Result<json> SectionsJson(const Scene& scene, const Mesh* mesh, std::span<const SectionPlane> planes,
                          const SectionAreaOptions& options) {
  const SectionSolids solids(scene.model());
  json list = json::array();
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Result<SectionArea> measured = MeasureSection(scene, planes, i, options);
    if (!measured.ok()) return measured.error();
    const SectionArea& area = measured.value();
    // Sort the solids by area, the largest first.
    std::vector<SectionArea::OfSolid> cut = area.solids;
    std::stable_sort(cut.begin(), cut.end(),
                     [](const auto& a, const auto& b) { return a.area_mm2 > b.area_mm2; });
    json cuts = json::array();
    const auto named = [&](const std::vector<std::uint32_t>& faces) {
      json list = json::array();
      for (std::size_t k = 0; k < std::min(faces.size(), kMostListed); ++k)
        list.push_back({{"id", faces[k]}, {"name", scene.model().PlacedFaceName(faces[k])}});
      return list;
    };
    for (std::size_t k = 0; k < std::min(cut.size(), kMostListed); ++k)
      cuts.push_back({{"name", solids.Name(cut[k].solid)}, {"area_mm2", cut[k].area_mm2}});
    // A cut through open shells alone encloses no area.
    const bool no_area = !area.open_faces.empty() && area.solids.empty() && area.touching_faces.empty() &&
                         area.coincident_faces.empty();
    const SectionArea::ErrorParts& parts = area.error_parts;
    json section = {{"point", Vector(planes[i].point)},
                    {"normal", Vector(planes[i].normal)},
                    {"area_mm2", no_area ? json(nullptr) : json(area.area_mm2)},
                    {"area_error_mm2", no_area ? json(nullptr) : json(area.error_mm2)},
                    {"area_error_parts_mm2",
                     {{"rows", parts.rows},
                      {"doubtful_rows", parts.odd},
                      {"move", parts.move},
                      {"gaps", parts.gaps},
                      {"missed", parts.missed}}},
                    {"outline_mm", area.outline_mm},
                    {"solids", std::move(cuts)},
                    {"solid_count", area.solids.size()},
                    {"coincident_faces", named(area.coincident_faces)},
                    {"touching_faces", named(area.touching_faces)},
                    {"moved_mm", area.moved_mm},
                    {"open_faces", area.open_faces.size()},
                    {"open_faces_named", named(area.open_faces)},
                    {"rows", area.rows},
                    {"odd_rows", area.odd_rows},
                    {"undecided_rows", area.undecided_rows},
                    {"ms", area.ms}};
    if (no_area)
      section["no_area"] = "the plane cuts " + std::to_string(area.open_faces.size()) +
                           " face(s) of open shells and no closed solid: the cut encloses no area";
    if (mesh != nullptr)
      section["mesh_area_mm2"] = planes.size() == 1 ? json(MeshSectionArea(*mesh, planes[i])) : json(nullptr);
    list.push_back(std::move(section));
  }
  return list;
}

}  // namespace facetless
