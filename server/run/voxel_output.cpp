#include "server/run/voxel_output.h"

#include <optional>
#include <utility>

#include "render/base/stopwatch.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/share_file.h"
#include "render/voxels/voxel_shares.h"
#include "render/voxels/voxelize.h"
#include "server/base/interrupt.h"
#include "server/base/version.h"
#include "server/run/shown_model.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

Json VectorJson(Vec3 v) {
  return {v.x, v.y, v.z};
}

Json DoubtsJson(const VoxelStats& stats) {
  Json doubts = Json::object();
  for (std::size_t bit = 0; bit < stats.doubts.size(); ++bit)
    if (stats.doubts[bit] > 0) doubts[kDoubtNames[bit]] = stats.doubts[bit];
  return doubts;
}

std::vector<std::string> WarningsOf(const VoxelStats& stats, const VoxelFormat& format, VoxelFill fill,
                                    bool shares) {
  std::vector<std::string> warnings;
  if (shares && format.suffix == ".nrrd") {
    warnings.emplace_back("NRRD files of shares hold neither materials nor colours.");
  } else if (!format.loses.empty()) {
    warnings.emplace_back(format.loses);
  }
  if (stats.open_faces > 0) {
    std::string names;
    for (const std::string& name : stats.open_face_names) names += (names.empty() ? "" : ", ") + name;
    warnings.push_back("these faces (" + std::to_string(stats.open_faces) +
                       " in all) belong to no closed solid, so that nothing is inside them" +
                       (fill == VoxelFill::kSolid ? " and they fill no voxel" : "") + ": " + names +
                       (stats.open_faces > stats.open_face_names.size() ? " and others" : ""));
  }
  if (stats.columns_in_doubt > 0)
    warnings.push_back(std::to_string(stats.columns_in_doubt) + " of " + std::to_string(stats.columns) +
                       " columns are not proven; voxels.doubts and voxels.columns_odd have the reasons");
  return warnings;
}

Json SharesJson(const VoxelShares& shares) {
  return {{"divisions", shares.divisions},
          {"volume_mm3", shares.volume_mm3},
          {"volume_bound_mm3", shares.volume_bound_mm3},
          {"partial", shares.partial},
          {"greatest_bound", shares.greatest_bound},
          {"rays", shares.rays},
          {"rays_in_doubt", shares.rays_in_doubt},
          {"bytes", shares.bytes()},
          {"peak_bytes", shares.peak_bytes},
          {"trace_ms", shares.trace_ms},
          {"touch_ms", shares.touch_ms}};
}

// The error of voxels that could not be made. Calls that took too long say so.
Error Explained(const Error& error, const Deadline& deadline, const std::string& file, double timeout_s) {
  if (error.code != ErrorCode::kCancelled || !deadline.expired()) return error;
  return {ErrorCode::kLimitExceeded, file + ": the voxels took longer than " + PreciseText(timeout_s) +
                                         " s; use --timeout to allow more time, or make fewer voxels"};
}

}  // namespace

Result<VoxelizeResult> RunVoxelize(const ImportedModel& imported, const RunOptions& options,
                                   const std::string& path, const RunContext& context) {
  const Result<const VoxelFormat*> format = VoxelFormatOf(path);
  if (!format) return format.error();
  if (options.voxels.fraction)
    if (auto known = CheckShareFormat(path); !known) return known.error();
  const auto shown = ShownModel::Of(imported, nullptr, options.picture.arrangement);
  if (!shown) return shown.error();
  const Model& model = *shown.value().imported().model;
  const VoxelRunOptions& request = options.voxels;
  const Result<VoxelGrid> grid = request.pitch_mm ? GridOfPitch(model.bounds, *request.pitch_mm)
                                                  : GridOfResolution(model.bounds, request.resolution);
  if (!grid) return grid.error();
  if (request.fraction)
    if (auto known = CheckDivisions(grid.value(), *request.fraction); !known) return known.error();
  const double timeout_s = options.timeout_s.value_or(kRunTimeoutS);
  const Deadline deadline(timeout_s, context.execution.cancel);
  const Execution execution = context.execution.WithFlag(deadline.flag());
  if (context.progress) context.progress("voxels", 0);
  const Stopwatch stopwatch;
  const Scene scene(model);
  Result<Voxels> voxels =
      Voxelize(scene, grid.value(), {.fill = request.fill, .accuracy = options.accuracy}, execution);
  if (!voxels) return Explained(voxels.error(), deadline, model.info.file, timeout_s);
  const double voxelize_ms = stopwatch.Milliseconds();
  if (context.progress) context.progress("voxels", 0.5);
  std::optional<VoxelShares> shares;
  if (request.fraction) {
    Result<VoxelShares> made = MeasureShares(
        scene, grid.value(), {.divisions = *request.fraction, .accuracy = options.accuracy}, execution);
    if (!made) return Explained(made.error(), deadline, model.info.file, timeout_s);
    shares = std::move(made).value();
  }
  const Stopwatch writing;
  VoxelFileOptions file_options{.max_bytes = options.accuracy.max_bytes, .cancel = deadline.flag()};
  if (request.slice_axis != SliceAxis::kAuto)
    file_options.slice_axis = static_cast<int>(request.slice_axis) - 1;
  const RunModel& filled_model = voxels.value().model;
  if (auto written = shares ? WriteShares(path, filled_model, *shares, execution.cancel)
                            : format.value()->write(path, filled_model, grid.value(), file_options);
      !written)
    return Explained(written.error(), deadline, model.info.file, timeout_s);
  if (context.progress) context.progress("voxels", 1);

  const VoxelStats& stats = voxels.value().stats;
  const VoxelGrid& g = grid.value();
  const std::uint64_t filled = voxels.value().model.Count();
  VoxelizeResult result;
  result.json = {{"facetless", ProgramJson(context.execution.threads)},
                 {"command", "voxelize"},
                 {"model", ImportedModelJson(imported)},
                 {"file", path},
                 {"voxels",
                  {{"size", {g.size.x, g.size.y, g.size.z}},
                   {"pitch_mm", g.pitch},
                   {"origin_mm", VectorJson(g.origin)},
                   {"fill", kVoxelFillNames[static_cast<std::size_t>(request.fill)]},
                   {"filled", filled},
                   {"volume_mm3", static_cast<double>(filled) * g.voxel_mm3()},
                   {"touched", request.fill == VoxelFill::kSolid ? Json(nullptr) : Json(stats.touched)},
                   {"certified", stats.certified},
                   {"not_certified", stats.not_certified},
                   {"columns", stats.columns},
                   {"columns_in_doubt", stats.columns_in_doubt},
                   {"columns_odd", stats.columns_odd},
                   {"doubts", DoubtsJson(stats)},
                   {"crossings", stats.crossings},
                   {"solids", stats.solids},
                   {"open_faces", stats.open_faces},
                   {"runs_bytes", voxels.value().model.bytes()},
                   {"peak_bytes", stats.peak_bytes + voxels.value().model.bytes()}}},
                 {"timing_ms",
                  {{"voxelize", voxelize_ms},
                   {"trace", stats.trace_ms},
                   {"touch", stats.touch_ms},
                   {"write", writing.Milliseconds()}}}};
  if (shares) result.json["voxels"]["fraction"] = SharesJson(*shares);
  if (!shown.value().report().is_null()) result.json["arrangement"] = shown.value().report();
  result.warnings = WarningsOf(stats, *format.value(), request.fill, shares.has_value());
  return result;
}

}  // namespace facetless
