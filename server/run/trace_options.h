// What the options of a run mean for the renderer: one place, so that every command that shows exact surfaces
// follows the same options.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/execution.h"
#include "render/compare/compare_view.h"
#include "render/trace/direct.h"
#include "server/options/options.h"

namespace facetless {

ViewOptions ToViewOptions(const RunOptions& options, const std::vector<SectionPlane>& sections,
                          const Execution& execution);

// How the exact surfaces are traced, where `taken_bytes` of the memory of a view are taken already.
DirectOptions ToDirectOptions(const RunOptions& options, const std::vector<SectionPlane>& sections,
                              std::uint64_t taken_bytes = 0);

}  // namespace facetless
