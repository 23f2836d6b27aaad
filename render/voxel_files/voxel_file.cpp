#include "render/voxel_files/voxel_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <vector>

#include "render/voxel_files/voxel_formats.h"

namespace facetless {

namespace {

std::vector<VoxelFormat>& AllFormats() {
  static std::vector<VoxelFormat> formats = {OctFormat(), VxlFormat(),  RawFormat(),        NrrdFormat(),
                                             VtiFormat(), TiffFormat(), SliceFolderFormat()};
  return formats;
}

constexpr std::string_view kFolder = "/";

}  // namespace

std::span<const VoxelFormat> VoxelFormats() {
  return AllFormats();
}

void AddVoxelFormat(const VoxelFormat& format) {
  AllFormats().push_back(format);
}

std::string VoxelSuffixes() {
  std::string suffixes;
  for (const VoxelFormat& format : VoxelFormats())
    if (format.suffix != kFolder) suffixes += std::string(format.suffix) + ", ";
  return suffixes + "or a folder of slices, whose name ends with /";
}

Result<const VoxelFormat*> VoxelFormatOf(const std::string& path) {
  std::error_code failed;
  std::string suffix = path.substr(std::min(path.rfind('.'), path.size()));
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool folder = path.ends_with('/') || std::filesystem::is_directory(path, failed);
  const std::string_view wanted = folder ? kFolder : std::string_view(suffix);
  for (const VoxelFormat& format : VoxelFormats())
    if (format.suffix == wanted || (!wanted.empty() && format.other_suffix == wanted)) return &format;
  return Error{ErrorCode::kBadUsage,
               path + ": no format of voxels has this suffix; the suffixes are " + VoxelSuffixes()};
}

Result<void> WriteVoxels(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                         const VoxelFileOptions& options) {
  const Result<const VoxelFormat*> format = VoxelFormatOf(path);
  if (!format.ok()) return format.error();
  return format.value()->write(path, model, grid, options);
}

Result<VoxelFile> ReadVoxels(const std::string& path, const VoxelFileOptions& options) {
  const Result<const VoxelFormat*> format = VoxelFormatOf(path);
  if (!format.ok()) return format.error();
  return format.value()->read(path, options);
}

Error BrokenVoxelFile(const std::string& path, const std::string& what) {
  return {ErrorCode::kFormatBroken, path + ": " + what};
}

Result<VoxelPoint> CheckVoxelSize(const std::string& path, std::int64_t x, std::int64_t y, std::int64_t z) {
  for (const std::int64_t n : {x, y, z})
    if (n < 1 || n > kMostVoxelsPerAxis)
      return BrokenVoxelFile(path, "the file claims " + std::to_string(n) + " voxels along an axis; 1 to " +
                                       std::to_string(kMostVoxelsPerAxis) + " are possible");
  return VoxelPoint{static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)};
}

Voxel VoxelOfNumber(double number, bool whole, double threshold) {
  // A number that is no number is empty.
  if (!(number > threshold)) return {};
  constexpr std::uint8_t kGrey = 178;
  const bool label = whole && number >= 1 && number <= 255;
  return Voxel::Of(kGrey, kGrey, kGrey, label ? static_cast<std::uint8_t>(number) : 1);
}

Result<void> CheckRoom(const std::string& path, double bytes) {
  std::error_code failed;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const std::filesystem::space_info space =
      std::filesystem::space(folder.empty() ? std::filesystem::path(".") : folder, failed);
  // The reason for a folder that cannot be written is found when it is written.
  if (failed || bytes <= static_cast<double>(space.available)) return {};
  constexpr double kMegabyte = 1 << 20;
  return Error{ErrorCode::kWriteFailed,
               path + ": the file would have " + std::to_string(std::llround(bytes / kMegabyte)) +
                   " MB, and its disk has room for " + std::to_string(space.available >> 20) +
                   " MB; write .oct, which is compressed, or fewer voxels"};
}

}  // namespace facetless
