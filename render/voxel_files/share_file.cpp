#include "render/voxel_files/share_file.h"

#include <functional>
#include <span>
#include <vector>

#include "render/voxel_files/dense_slices.h"
#include "render/voxel_files/file_bytes.h"

namespace facetless {
namespace {

// Calls visit(slice) for each z, ascending; a slice has the runs of size.x·size.y voxels, x fastest.
void VisitShares(const VoxelShares& shares, const std::function<void(std::span<const ShareRun>)>& visit) {
  const VoxelPoint n = shares.grid.size;
  const auto columns = static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y);
  std::vector<std::uint32_t> next(columns, 0);  // the run of each column that ends above z
  std::vector<ShareRun> slice(columns);
  for (int z = 0; z < n.z; ++z) {
    std::size_t at = 0;
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x, ++at) {
        const std::span<const ShareRun> column = shares.Column(x, y);
        while (next[at] < column.size() && column[next[at]].z_end <= z) ++next[at];
        const bool found = next[at] < column.size() && column[next[at]].z_begin <= z;
        slice[at] = found ? column[next[at]] : ShareRun{};
      }
    visit(slice);
  }
}

void WriteNumbers(const VoxelShares& shares, VoxelFileWriter* out,
                  const std::function<void(const ShareRun&, VoxelFileWriter*)>& write) {
  VisitShares(shares, [&](std::span<const ShareRun> slice) {
    for (const ShareRun& run : slice) write(run, out);
  });
}

Result<void> WriteVti(const std::string& path, const VoxelModel& model, const VoxelShares& shares) {
  VoxelFileWriter out(path);
  const VoxelGrid& grid = shares.grid;
  const VoxelPoint n = model.size();
  const std::uint64_t count = model.box().volume();
  const std::string extent = "0 " + std::to_string(n.x) + " 0 " + std::to_string(n.y) + " 0 " +
                             std::to_string(n.z),
                    pitch = PreciseText(grid.pitch);
  out.Text(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<ImageData WholeExtent=\"" +
      extent + "\" Origin=\"" + PreciseText(grid.origin.x) + " " + PreciseText(grid.origin.y) + " " +
      PreciseText(grid.origin.z) + "\" Spacing=\"" + pitch + " " + pitch + " " + pitch +
      "\">\n<Piece Extent=\"" + extent + "\">\n<CellData Scalars=\"fraction\">\n");
  struct Array {
    const char *name, *type;
    int components;
    std::uint64_t bytes;  // of a voxel
  };
  std::uint64_t offset = 0;
  for (const Array& array : {Array{"material", "UInt8", 1, 1}, Array{"color", "UInt8", 3, 3},
                             Array{"fraction", "Float32", 1, 4}, Array{"fraction_bound", "Float32", 1, 4}}) {
    out.Text(std::string("<DataArray type=\"") + array.type + "\" Name=\"" + array.name +
             "\" NumberOfComponents=\"" + std::to_string(array.components) +
             "\" format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n");
    offset += sizeof(std::uint64_t) + array.bytes * count;
  }
  out.Text("</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_");
  out.Number(count);
  VisitSlices(model, [&](int, std::span<const Voxel> slice) {
    for (const Voxel& voxel : slice) out.Number(voxel.material());
  });
  out.Number(3 * count);
  VisitSlices(model, [&](int, std::span<const Voxel> slice) {
    for (const Voxel& voxel : slice)
      for (const std::uint8_t channel : {voxel.red(), voxel.green(), voxel.blue()}) out.Number(channel);
  });
  out.Number(sizeof(float) * count);
  WriteNumbers(shares, &out, [](const ShareRun& run, VoxelFileWriter* to) { to->Number(run.share); });
  out.Number(sizeof(float) * count);
  WriteNumbers(shares, &out, [](const ShareRun& run, VoxelFileWriter* to) { to->Number(run.bound); });
  out.Text("\n</AppendedData>\n</VTKFile>\n");
  return out.Finish();
}

Result<void> WriteNrrd(const std::string& path, const VoxelModel&, const VoxelShares& shares) {
  VoxelFileWriter out(path);
  const VoxelGrid& grid = shares.grid;
  const std::string p = PreciseText(grid.pitch);
  // The origin of NRRD is the centre of the first sample.
  const Vec3 first = grid.Center({0, 0, 0});
  out.Text(
      "NRRD0004\n# Facetless: the share of each voxel that is inside, and its bound; lengths are "
      "millimetres\n"
      "type: float\nendian: little\ndimension: 4\nspace dimension: 3\nsizes: 2 " +
      std::to_string(grid.size.x) + " " + std::to_string(grid.size.y) + " " + std::to_string(grid.size.z) +
      "\nspace directions: none (" + p + ",0,0) (0," + p + ",0) (0,0," + p +
      ")\nspace units: \"mm\" \"mm\" \"mm\"\nspace origin: (" + PreciseText(first.x) + "," +
      PreciseText(first.y) + "," + PreciseText(first.z) +
      ")\nkinds: 2-vector domain domain domain\nencoding: raw\n\n");
  WriteNumbers(shares, &out, [](const ShareRun& run, VoxelFileWriter* to) {
    to->Number(run.share);
    to->Number(run.bound);
  });
  return out.Finish();
}

using Write = Result<void> (*)(const std::string&, const VoxelModel&, const VoxelShares&);

Write WriterOf(const std::string& path) {
  return path.ends_with(".vti") ? WriteVti : path.ends_with(".nrrd") ? WriteNrrd : nullptr;
}

}  // namespace

Result<void> CheckShareFormat(const std::string& path) {
  if (WriterOf(path) != nullptr) return {};
  return Error{ErrorCode::kBadUsage, path + ": only .vti and .nrrd hold the shares of --fraction"};
}

Result<void> WriteShares(const std::string& path, const VoxelModel& model, const VoxelShares& shares) {
  if (auto known = CheckShareFormat(path); !known) return known;
  return WriterOf(path)(path, model, shares);
}

}  // namespace facetless
