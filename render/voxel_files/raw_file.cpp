#include <filesystem>

#include "render/voxel_files/byte_source.h"
#include "render/voxel_files/dense_slices.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/grid_header.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

constexpr const char* kFormat = "facetless-raw-voxels";

std::string HeaderPath(const std::string& path) {
  return path + ".json";
}

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                   const VoxelFileOptions& options) {
  const double bytes = static_cast<double>(model.box().volume()) * sizeof(Voxel);
  if (auto room = CheckRoom(path, bytes); !room.ok()) return room;
  VoxelFileWriter out(path), header(HeaderPath(path));
  auto visited = VisitSlices(model, 2, options.cancel, [&](int, std::span<const Voxel> slice) {
    out.Text({reinterpret_cast<const char*>(slice.data()), slice.size_bytes()});
    return out.Checked();
  });
  if (!visited.ok()) return visited;
  nlohmann::json json = GridHeader(kFormat, model.size(), grid);
  json["order"] = "x fastest, z slowest";
  json["voxel"] = "4 bytes: red, green, blue, material; material 0 is empty";
  header.Text(json.dump(1) + "\n");
  if (auto written = out.Finish(); !written.ok()) return written;
  return header.Finish();
}

Result<VoxelFile> Read(const std::string& path, const VoxelFileOptions& options) {
  const Result<nlohmann::json> header = ReadGridHeader(HeaderPath(path), kFormat);
  if (!header.ok()) {
    const std::string remedy = header.error().code == ErrorCode::kFileUnreadable
                                   ? "; a file of raw voxels needs the header beside it"
                                   : "";
    return Error{header.error().code, header.error().message + remedy};
  }
  const Result<VoxelPoint> size = SizeOfHeader(HeaderPath(path), header.value());
  if (!size.ok()) return size.error();
  const Result<std::uint64_t> found = VoxelFileSize(path);
  if (!found.ok()) return found.error();
  const std::uint64_t expected = VoxelBox{{0, 0, 0}, size.value()}.volume() * sizeof(Voxel);
  if (found.value() != expected)
    return BrokenVoxelFile(path, "the header needs " + std::to_string(expected) +
                                     " bytes of voxels, but the file has " + std::to_string(found.value()));
  Result<SliceCollector> slices = SliceCollector::Of(path, size.value(), 2, options);
  if (!slices.ok()) return slices.error();
  const std::unique_ptr<ByteSource> bytes = FileRange(path, 0);
  std::vector<Voxel> slice(slices.value().shape().area());
  const std::span<unsigned char> slice_bytes(reinterpret_cast<unsigned char*>(slice.data()),
                                             slice.size() * sizeof(Voxel));
  for (int z = 0; z < size.value().z; ++z) {
    if (bytes->Read(slice_bytes) < slice_bytes.size())
      return Error{ErrorCode::kFileUnreadable, path + ": cannot be read to its end"};
    // A voxel without a material is empty, whatever its colour.
    for (Voxel& voxel : slice)
      if (voxel.material() == 0) voxel = {};
    if (auto added = slices.value().Add(slice); !added.ok()) return added.error();
  }
  return VoxelFile{std::make_unique<RunModel>(slices.value().Take()),
                   GridOfHeader(header.value(), size.value())};
}

}  // namespace

VoxelFormat RawFormat() {
  return {".raw", "raw voxels", "", Write, Read};
}

}  // namespace facetless
