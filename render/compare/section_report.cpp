#include "render/compare/section_report.h"

#include <algorithm>

#include "render/baseline/mesh_section.h"

namespace facetless {
namespace {

using nlohmann::json;

constexpr std::size_t kMostListed = 100;  // solids, and faces in the plane, of one section

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
    // The largest first.
    std::vector<SectionArea::OfSolid> cut = area.solids;
    std::stable_sort(cut.begin(), cut.end(),
                     [](const auto& a, const auto& b) { return a.area_mm2 > b.area_mm2; });
    json cuts = json::array(), coincident = json::array();
    for (std::size_t k = 0; k < std::min(cut.size(), kMostListed); ++k)
      cuts.push_back({{"name", solids.Name(cut[k].solid)}, {"area_mm2", cut[k].area_mm2}});
    for (std::size_t k = 0; k < std::min(area.coincident_faces.size(), kMostListed); ++k)
      coincident.push_back({{"id", area.coincident_faces[k]},
                            {"name", scene.model().PlacedFaceName(area.coincident_faces[k])}});
    json section = {{"point", Vector(planes[i].point)},
                    {"normal", Vector(planes[i].normal)},
                    {"area_mm2", area.area_mm2},
                    {"area_error_mm2", area.error_mm2},
                    {"solids", std::move(cuts)},
                    {"solid_count", area.solids.size()},
                    {"coincident_faces", std::move(coincident)},
                    {"moved_mm", area.moved_mm},
                    {"open_faces", area.open_faces},
                    {"rows", area.rows},
                    {"odd_rows", area.odd_rows},
                    {"ms", area.ms}};
    if (mesh != nullptr)
      section["mesh_area_mm2"] = planes.size() == 1 ? json(MeshSectionArea(*mesh, planes[i])) : json(nullptr);
    list.push_back(std::move(section));
  }
  return list;
}

}  // namespace facetless
