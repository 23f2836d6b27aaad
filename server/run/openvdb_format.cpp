#include "server/run/openvdb_format.h"

#include <filesystem>
#include <string>

#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_file.h"
#include "server/base/files.h"
#include "server/importer/openvdb_process.h"

namespace facetless {
namespace {

// An error of facetless-openvdb about the file `inner`. The message names the file as the command line does, by `path`.
Error About(const std::string& path, const std::string& inner, const Error& error) {
  std::string message = error.message;
  std::error_code failed;
  for (const std::string& name : {std::filesystem::absolute(inner, failed).string(), path,
                                  std::filesystem::path(inner).filename().string()})
    if (message.starts_with(name + ": ")) message = message.substr(name.size() + 2);
  return {error.code, path + ": " + message};
}

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
  if (!answer) return About(path, tree, answer.error());
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
  if (!answer) return About(path, path, answer.error());
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
