#include "server/run/voxel_convert.h"

#include <filesystem>

#include "render/base/stopwatch.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_file.h"
#include "server/base/interrupt.h"
#include "server/base/version.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The bytes of a file, or of the files in a folder.
std::uint64_t BytesOf(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code failed;
  if (!fs::is_directory(path, failed)) {
    const std::uintmax_t size = fs::file_size(path, failed);
    return failed ? 0 : size;
  }
  std::uint64_t sum = 0;
  for (fs::directory_iterator at(path, failed), end; !failed && at != end; at.increment(failed)) {
    std::error_code gone;
    const std::uintmax_t size = at->file_size(gone);
    sum += gone ? 0 : size;
  }
  return sum;
}

// The grid of the result, and what has to be said about it.
VoxelGrid GridOf(const VoxelFile& file, const RunOptions& options, std::vector<std::string>& warnings) {
  const std::optional<double>& pitch = options.voxels.pitch_mm;
  if (file.grid) {
    if (pitch && *pitch != file.grid->pitch)
      warnings.push_back("the file says that its voxels have a side of " + Json(file.grid->pitch).dump() +
                         " mm; --pitch-mm is for files that do not, and is ignored");
    return *file.grid;
  }
  if (!pitch)
    warnings.push_back(
        "the file does not say how large its voxels are; a side of 1 mm is assumed, and --pitch-mm sets "
        "another");
  return {{}, pitch.value_or(1), file.model->size()};
}

}  // namespace

Result<ConvertResult> RunConvert(const std::string& source, const std::string& target,
                                 const RunOptions& options, const RunContext& context) {
  const Result<const VoxelFormat*> from = VoxelFormatOf(source), to = VoxelFormatOf(target);
  if (!from) return from.error();
  if (!to) return to.error();
  const double timeout_s = options.timeout_s.value_or(kRunTimeoutS);
  const Deadline deadline(timeout_s, context.execution.cancel);
  VoxelFileOptions request{.max_bytes = options.accuracy.max_bytes,
                           .threshold = options.voxels.threshold,
                           .cancel = deadline.flag()};
  if (options.voxels.slice_axis != SliceAxis::kAuto)
    request.slice_axis = static_cast<int>(options.voxels.slice_axis) - 1;
  const auto failed = [&](const Error& error) {
    if (error.code != ErrorCode::kCancelled || !deadline.expired()) return error;
    return Error{ErrorCode::kLimitExceeded, source + ": the conversion took longer than " +
                                                PreciseText(timeout_s) +
                                                " s; use --timeout to allow more time"};
  };
  if (context.progress) context.progress("read", 0);
  const Stopwatch reading;
  const Result<VoxelFile> read = from.value()->read(source, request);
  if (!read) return failed(read.error());
  const double read_ms = reading.Milliseconds();
  const VoxelModel& model = *read.value().model;
  ConvertResult result;
  result.warnings = read.value().warnings;
  const VoxelGrid grid = GridOf(read.value(), options, result.warnings);
  // Other formats are written from runs, whose columns may need much more memory than a tree of few nodes.
  std::unique_ptr<VoxelModel> runs;
  if (model.encoding() != "runs" && to.value() != from.value()) {
    Result<std::unique_ptr<VoxelModel>> converted = Converted(model, "runs", request.max_bytes);
    if (!converted)
      return Error{converted.error().code,
                   source + ": " + converted.error().message + ", or raise --max-view-memory"};
    runs = std::move(converted).value();
  }
  const VoxelModel& written_model = runs ? *runs : model;
  if (context.progress) context.progress("write", 0.5);
  const Stopwatch writing;
  if (auto written = to.value()->write(target, written_model, grid, request); !written)
    return failed(written.error());
  if (context.progress) context.progress("write", 1);
  if (!to.value()->loses.empty()) result.warnings.emplace_back(to.value()->loses);

  const VoxelPoint n = model.size();
  const std::uint64_t filled = written_model.Count();
  result.json = {{"facetless", ProgramJson(context.execution.threads)},
                 {"command", "convert"},
                 {"source",
                  {{"file", source},
                   {"format", from.value()->name},
                   {"bytes", BytesOf(source)},
                   {"has_grid", read.value().grid.has_value()}}},
                 {"file", target},
                 {"format", to.value()->name},
                 {"bytes", BytesOf(target)},
                 {"lost", to.value()->loses},
                 {"warnings", result.warnings},
                 {"voxels",
                  {{"size", {n.x, n.y, n.z}},
                   {"pitch_mm", grid.pitch},
                   {"origin_mm", {grid.origin.x, grid.origin.y, grid.origin.z}},
                   {"filled", filled},
                   {"volume_mm3", static_cast<double>(filled) * grid.voxel_mm3()},
                   {"model_bytes", written_model.bytes()}}},
                 {"timing_ms", {{"read", read_ms}, {"write", writing.Milliseconds()}}}};
  return result;
}

}  // namespace facetless
