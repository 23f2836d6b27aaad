#include "render/voxel_files/grid_header.h"

#include <algorithm>
#include <cmath>

#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

bool IsThree(const Json& json, bool whole) {
  return json.is_array() && json.size() == 3 && std::all_of(json.begin(), json.end(), [&](const Json& n) {
           return whole ? n.is_number_integer() : n.is_number();
         });
}

}  // namespace

Json GridHeader(const std::string& format, VoxelPoint size, const VoxelGrid& grid) {
  return {{"format", format},
          {"version", 1},
          {"size", {size.x, size.y, size.z}},
          {"pitch_mm", grid.pitch},
          {"origin_mm", {grid.origin.x, grid.origin.y, grid.origin.z}}};
}

Result<Json> ReadGridHeader(const std::string& path, const std::string& format) {
  constexpr std::uint64_t kMostHeader = 1 << 16;
  const Result<std::vector<unsigned char>> text = ReadVoxelBytes(path, kMostHeader);
  if (!text.ok()) return text.error();
  Json header = Json::parse(text.value().begin(), text.value().end(), nullptr, false);
  if (!header.is_object() || header.value("format", Json()) != format || header.value("version", Json()) != 1)
    return BrokenVoxelFile(path, "the file is not a header of the format " + format + ", version 1");
  return header;
}

Result<VoxelPoint> SizeOfHeader(const std::string& path, const Json& header) {
  const Json size = header.value("size", Json());
  if (!IsThree(size, true)) return BrokenVoxelFile(path, "the size must be three whole numbers");
  return CheckVoxelSize(path, size[0].get<std::int64_t>(), size[1].get<std::int64_t>(),
                        size[2].get<std::int64_t>());
}

std::optional<VoxelGrid> GridOfHeader(const Json& header, VoxelPoint size) {
  if (!header.is_object()) return std::nullopt;
  const Json origin = header.value("origin_mm", Json()), pitch = header.value("pitch_mm", Json());
  if (!IsThree(origin, false) || !pitch.is_number() || !(pitch.get<double>() > 0)) return std::nullopt;
  const VoxelGrid grid{{origin[0], origin[1], origin[2]}, pitch, size};
  if (!std::isfinite(grid.pitch + grid.origin.x + grid.origin.y + grid.origin.z)) return std::nullopt;
  return grid;
}

}  // namespace facetless
