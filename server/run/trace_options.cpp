#include "server/run/trace_options.h"

#include <algorithm>

namespace facetless {

ViewOptions ToViewOptions(const RunOptions& options, const std::vector<SectionPlane>& sections,
                          const Execution& execution) {
  ViewOptions view;
  view.execution = execution;
  view.sections = sections;
  view.samples = options.samples;
  view.uniform_samples = options.uniform_samples;
  view.edges = options.edges;
  view.lines = options.lines;
  view.find_lines = options.svg;
  view.background = options.background;
  view.light = options.light;
  view.up = options.picture.up;
  view.inspection = options.inspection;
  view.inspection.orient = options.orient;
  view.coloring = options.picture.coloring;
  view.uv = options.WantsAov("uv");
  view.depth_error = options.WantsAov("certificate");
  view.audit = options.audit;
  return view;
}

DirectOptions ToDirectOptions(const RunOptions& options, const std::vector<SectionPlane>& sections,
                              std::uint64_t taken_bytes) {
  DirectOptions direct;
  direct.accuracy = options.accuracy;
  direct.accuracy.max_bytes -= std::min(direct.accuracy.max_bytes, taken_bytes);
  direct.sections = sections;
  return direct;
}

Result<void> CheckMethodOptions(const RunOptions& options) {
  const auto iterates = [](const MethodChoice& choice) { return choice.method->solver != nullptr; };
  const std::vector<MethodChoice> beside = options.MethodsBeside();
  const auto shows_voxels = [](const MethodChoice& choice) { return choice.method->name == "voxels"; };
  if (options.voxel_normals && std::none_of(beside.begin(), beside.end(), shows_voxels))
    return Error{
        ErrorCode::kBadUsage,
        "voxel_normals applies to voxels; give their number with voxels, or leave out voxel_normals"};
  if (!options.solver.starts || iterates(options.method) ||
      std::any_of(beside.begin(), beside.end(), iterates) ||
      std::any_of(options.trade.methods.begin(), options.trade.methods.end(), iterates))
    return {};
  return Error{ErrorCode::kBadUsage,
               "starts applies to methods that iterate; give one of them as method, or leave out starts"};
}

Result<std::unique_ptr<const Representation>> MakeExactSide(const RunOptions& options, const Scene& scene,
                                                            const DirectOptions& direct,
                                                            const Execution& execution) {
  const Method& method = *options.method.method;
  if (auto used = CheckMethodOptions(options); !used) return used.error();
  const bool certified = &method == &CertifiedMethod();
  return method.make({.scene = scene,
                      .direct = direct,
                      .name = "direct",
                      .title = certified ? "Direct" : "Direct, " + method.title,
                      .execution = execution,
                      .max_bytes = direct.accuracy.max_bytes,
                      .solver = options.solver},
                     options.method.setting);
}

}  // namespace facetless
