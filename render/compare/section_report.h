// The object "sections" of the report, which describes the section planes of a run.
#pragma once

#include <atomic>
#include <span>

#include <nlohmann/json.hpp>

#include "render/model/mesh.h"
#include "render/trace/direct.h"
#include "render/trace/section_area.h"

namespace facetless {

// One entry for each plane, as documented in docs/sections.md. If only faces of open shells are cut,
// "area_mm2" and its error are null, and "no_area" has the reason. With a mesh there is also "mesh_area_mm2",
// which is null if several planes clip each other. Errors: the errors of MeasureSection.
Result<nlohmann::json> SectionsJson(const Scene& scene, const Mesh* mesh,
                                    std::span<const SectionPlane> planes, const SectionAreaOptions& options);

}  // namespace facetless
