// Converts the options of a run to those of the renderer, in one place, so that all commands that show exact
// surfaces obey the same options.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/base/execution.h"
#include "render/compare/compare_view.h"
#include "render/compare/method.h"
#include "render/trace/direct.h"
#include "server/options/options.h"

namespace facetless {

ViewOptions ToViewOptions(const RunOptions& options, const std::vector<SectionPlane>& sections,
                          const Execution& execution);

// Returns the options with which exact surfaces are traced. `taken_bytes` of the memory limit of a view are
// in use already.
DirectOptions ToDirectOptions(const RunOptions& options, const std::vector<SectionPlane>& sections,
                              std::uint64_t taken_bytes = 0);

// Error: kBadUsage (`starts` is given, but no method of the run iterates; `voxel_normals`, but the run shows no voxels).
Result<void> CheckMethodOptions(const RunOptions& options);

// Makes what shows the exact surfaces of a run: --method. Errors: those of the method; that of CheckMethodOptions.
Result<std::unique_ptr<const Representation>> MakeExactSide(const RunOptions& options, const Scene& scene,
                                                            const DirectOptions& direct,
                                                            const Execution& execution);

}  // namespace facetless
