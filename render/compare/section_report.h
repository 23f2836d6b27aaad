// What a run says of its section planes: the report's "sections".
#pragma once

#include <atomic>
#include <span>

#include <nlohmann/json.hpp>

#include "render/model/mesh.h"
#include "render/trace/direct.h"
#include "render/trace/section_area.h"

namespace facetless {

// One entry for each plane, as docs/sections.md has it: "area_mm2" and its error are null, and "no_area" says
// why, where nothing but faces of open shells is cut; with a mesh "mesh_area_mm2", null where several planes
// clip each other. Errors: those of MeasureSection.
Result<nlohmann::json> SectionsJson(const Scene& scene, const Mesh* mesh,
                                    std::span<const SectionPlane> planes, const SectionAreaOptions& options);

}  // namespace facetless
