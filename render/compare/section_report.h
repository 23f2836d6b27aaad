// What a run says of its section planes: the report's "sections".
#pragma once

#include <atomic>
#include <span>

#include <nlohmann/json.hpp>

#include "render/model/mesh.h"
#include "render/trace/direct.h"
#include "render/trace/section_area.h"

namespace facetless {

// One entry for each plane: {"point", "normal", "area_mm2", "area_error_mm2", "solids": [{"name", "area_mm2"}],
// "solid_count", "rows", "odd_rows", "coincident_faces", "moved_mm", "open_faces", "ms"}, and with a mesh "mesh_area_mm2", null where
// several planes clip each other. Errors: those of MeasureSection.
Result<nlohmann::json> SectionsJson(const Scene& scene, const Mesh* mesh,
                                    std::span<const SectionPlane> planes, const SectionAreaOptions& options);

}  // namespace facetless
