#include "render/voxel_files/voxel_file.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "render/voxel_files/voxel_formats.h"

namespace facetless {

std::span<const VoxelFormat> VoxelFormats() {
  static const std::array formats = {OctFormat(), VxlFormat(), RawFormat(), NrrdFormat(), VtiFormat()};
  return formats;
}

Result<const VoxelFormat*> VoxelFormatOf(const std::string& path) {
  std::string suffix = path.substr(std::min(path.rfind('.'), path.size()));
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::string suffixes;
  for (const VoxelFormat& format : VoxelFormats()) {
    if (format.suffix == suffix) return &format;
    suffixes += (suffixes.empty() ? "" : ", ") + std::string(format.suffix);
  }
  return Error{ErrorCode::kBadUsage,
               path + ": no format of voxels has this suffix; the suffixes are " + suffixes};
}

Result<void> WriteVoxels(const std::string& path, const VoxelModel& model, const VoxelGrid& grid) {
  const Result<const VoxelFormat*> format = VoxelFormatOf(path);
  if (!format.ok()) return format.error();
  return format.value()->write(path, model, grid);
}

Result<VoxelFile> ReadVoxels(const std::string& path, std::uint64_t max_bytes) {
  const Result<const VoxelFormat*> format = VoxelFormatOf(path);
  if (!format.ok()) return format.error();
  return format.value()->read(path, max_bytes);
}

Error BrokenVoxelFile(const std::string& path, const std::string& what) {
  return {ErrorCode::kFormatBroken, path + ": " + what};
}

Result<VoxelPoint> CheckVoxelSize(const std::string& path, std::int64_t x, std::int64_t y, std::int64_t z,
                                  double bytes_per_voxel, std::uint64_t max_bytes) {
  for (const std::int64_t n : {x, y, z})
    if (n < 1 || n > kMostVoxelsPerAxis)
      return BrokenVoxelFile(path, "the file claims " + std::to_string(n) + " voxels along an axis; 1 to " +
                                       std::to_string(kMostVoxelsPerAxis) + " are possible");
  const double bytes =
      bytes_per_voxel * static_cast<double>(x) * static_cast<double>(y) * static_cast<double>(z);
  if (bytes > static_cast<double>(max_bytes))
    return Error{ErrorCode::kLimitExceeded, path + ": " + std::to_string(x) + " × " + std::to_string(y) +
                                                " × " + std::to_string(z) + " voxels need more than " +
                                                std::to_string(max_bytes >> 20) +
                                                " MB; raise --max-view-memory"};
  return VoxelPoint{static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)};
}

}  // namespace facetless
