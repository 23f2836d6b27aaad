#include "server/run/openvdb_format.h"

#include <charconv>

#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_file.h"
#include "server/base/files.h"
#include "server/importer/openvdb_process.h"

namespace facetless {
namespace {

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                   const VoxelFileOptions& options) {
  const auto directory = TempDir::Create();
  if (!directory) return directory.error();
  const std::string tree = directory.value().File("voxels.oct"), made = directory.value().File("voxels.vdb");
  if (auto written = WriteVoxels(tree, model, grid, options); !written) return written;
  const auto answer = RunOpenVdb({.input = tree,
                                  .arguments = {"--write", made},
                                  .max_bytes = options.max_bytes,
                                  .execution = {.cancel = options.cancel}},
                                 directory.value());
  if (!answer) return Error{answer.error().code, path + ": " + answer.error().message};
  return MoveFile(made, path);
}

Result<VoxelFile> Read(const std::string& path, const VoxelFileOptions& options) {
  const auto directory = TempDir::Create();
  if (!directory) return directory.error();
  const std::string tree = directory.value().File("voxels.oct");
  const auto answer =
      RunOpenVdb({.input = path,
                  .arguments = {"--read", tree, "--threshold", PreciseText(options.threshold)},
                  .max_bytes = options.max_bytes,
                  .execution = {.cancel = options.cancel}},
                 directory.value());
  if (!answer) {
    const std::string& message = answer.error().message;
    return Error{answer.error().code, message.find(path) == 0 ? message : path + ": " + message};
  }
  Result<VoxelFile> read = ReadVoxels(tree, options);
  if (!read)
    return Error{read.error().code, path + ": the answer of OpenVDB cannot be used: " + read.error().message};
  if (const auto warnings = answer.value().find("warnings");
      warnings != answer.value().end() && warnings->is_array())
    for (const nlohmann::json& warning : *warnings)
      if (warning.is_string()) read.value().warnings.push_back(warning.get<std::string>());
  return read;
}

}  // namespace

void AddOpenVdbFormat() {
  AddVoxelFormat({".vdb", "OpenVDB", "", Write, Read});
}

}  // namespace facetless
