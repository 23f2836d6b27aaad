#include <nlohmann/json.hpp>

#include "render/voxel_files/dense_slices.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

std::string HeaderPath(const std::string& path) {
  return path + ".json";
}

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid) {
  VoxelFileWriter out(path), header(HeaderPath(path));
  VisitSlices(model, [&](int, std::span<const Voxel> slice) {
    for (const Voxel& voxel : slice) out.Number(voxel.bits);
  });
  const VoxelPoint n = model.size();
  header.Text(Json{{"format", "facetless-raw-voxels"},
                   {"version", 1},
                   {"size", {n.x, n.y, n.z}},
                   {"order", "x fastest, z slowest"},
                   {"voxel", "4 bytes: red, green, blue, material; material 0 is empty"},
                   {"pitch_mm", grid.pitch},
                   {"origin_mm", {grid.origin.x, grid.origin.y, grid.origin.z}}}
                  .dump(1) +
              "\n");
  if (auto written = out.Finish(); !written.ok()) return written;
  return header.Finish();
}

Result<VoxelFile> Read(const std::string& path, std::uint64_t max_bytes) {
  constexpr std::uint64_t kMostHeader = 1 << 16;
  const Result<std::vector<unsigned char>> text = ReadVoxelBytes(HeaderPath(path), kMostHeader);
  if (!text.ok())
    return Error{text.error().code,
                 text.error().message + "; a file of raw voxels needs the header beside it"};
  const Json header = Json::parse(text.value().begin(), text.value().end(), nullptr, false);
  const auto broken = [&](const std::string& what) { return BrokenVoxelFile(HeaderPath(path), what); };
  if (!header.is_object() || header.value("format", Json()) != "facetless-raw-voxels" ||
      header.value("version", Json()) != 1)
    return broken("the header is not one of raw voxels of version 1");
  const Json size_json = header.value("size", Json());
  const auto three = [](const Json& json, bool integers) {
    return json.is_array() && json.size() == 3 && std::all_of(json.begin(), json.end(), [&](const Json& n) {
             return integers ? n.is_number_integer() : n.is_number();
           });
  };
  if (!three(size_json, true)) return broken("the size must be three whole numbers");
  const Result<VoxelPoint> size =
      CheckVoxelSize(path, size_json[0].get<std::int64_t>(), size_json[1].get<std::int64_t>(),
                     size_json[2].get<std::int64_t>(), sizeof(Voxel), max_bytes);
  if (!size.ok()) return size.error();
  const Result<std::vector<unsigned char>> bytes = ReadVoxelBytes(path, max_bytes);
  if (!bytes.ok()) return bytes.error();
  const std::uint64_t expected = VoxelBox{{0, 0, 0}, size.value()}.volume() * sizeof(Voxel);
  if (bytes.value().size() != expected)
    return BrokenVoxelFile(path, "the header needs " + std::to_string(expected) +
                                     " bytes of voxels, but the file has " +
                                     std::to_string(bytes.value().size()));
  VoxelFileReader reader(bytes.value());
  SliceCollector slices(size.value());
  std::vector<Voxel> slice(static_cast<std::size_t>(size.value().x) *
                           static_cast<std::size_t>(size.value().y));
  for (int z = 0; z < size.value().z; ++z) {
    for (Voxel& voxel : slice) {
      reader.Number(&voxel.bits);
      // A voxel without a material is empty, whatever its colour.
      if (voxel.material() == 0) voxel = {};
    }
    slices.Add(slice);
  }
  VoxelFile file{std::make_unique<RunModel>(slices.Take()), std::nullopt};
  const Json origin = header.value("origin_mm", Json()), pitch = header.value("pitch_mm", Json());
  if (three(origin, false) && pitch.is_number() && pitch.get<double>() > 0)
    file.grid = VoxelGrid{{origin[0], origin[1], origin[2]}, pitch, size.value()};
  return file;
}

}  // namespace

VoxelFormat RawFormat() {
  return {".raw", "raw voxels", "", Write, Read};
}

}  // namespace facetless
