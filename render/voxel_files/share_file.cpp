#include "render/voxel_files/share_file.h"

#include <array>
#include <span>
#include <vector>

#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

// Calls write(run) for the run of each voxel, x fastest and z slowest. Errors: kCancelled, kWriteFailed.
template <typename Write>
Result<void> WriteNumbers(const VoxelShares& shares, const std::atomic<bool>* cancel, VoxelFileWriter* out,
                          const Write& write) {
  const VoxelPoint n = shares.grid.size;
  std::vector<std::uint32_t> next(static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y),
                                  0);  // the run of each column that ends above z
  for (int z = 0; z < n.z; ++z) {
    if (cancel != nullptr && *cancel) return Error{ErrorCode::kCancelled, "cancelled while writing voxels"};
    std::size_t at = 0;
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x, ++at) {
        const std::span<const ShareRun> column = shares.Column(x, y);
        while (next[at] < column.size() && column[next[at]].z_end <= z) ++next[at];
        const bool found = next[at] < column.size() && column[next[at]].z_begin <= z;
        write(found ? column[next[at]] : ShareRun{});
      }
    if (auto checked = out->Checked(); !checked.ok()) return checked;
  }
  return {};
}

Result<void> WriteVti(const std::string& path, const VoxelModel& model, const VoxelShares& shares,
                      const std::atomic<bool>* cancel) {
  const std::uint64_t count = model.box().volume();
  constexpr VtiArray kShare = {"fraction", "Float32", 1, sizeof(float)},
                     kBound = {"fraction_bound", "Float32", 1, sizeof(float)};
  if (auto room = CheckRoom(path, 12 * static_cast<double>(count)); !room.ok()) return room;
  VoxelFileWriter out(path);
  out.Text(VtiBeginning(shares.grid, kShare.name, std::array{kVtiMaterial, kVtiColor, kShare, kBound}));
  if (auto written = WriteVtiColors(model, cancel, &out); !written.ok()) return written;
  for (const auto member : {&ShareRun::share, &ShareRun::bound}) {
    out.Number(sizeof(float) * count);
    auto written = WriteNumbers(shares, cancel, &out, [&](const ShareRun& run) { out.Number(run.*member); });
    if (!written.ok()) return written;
  }
  out.Text(kVtiEnd);
  return out.Finish();
}

Result<void> WriteNrrd(const std::string& path, const VoxelModel& model, const VoxelShares& shares,
                       const std::atomic<bool>* cancel) {
  if (auto room = CheckRoom(path, 8 * static_cast<double>(model.box().volume())); !room.ok()) return room;
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
  auto written = WriteNumbers(shares, cancel, &out, [&](const ShareRun& run) {
    out.Number(run.share);
    out.Number(run.bound);
  });
  if (!written.ok()) return written;
  return out.Finish();
}

using Write = Result<void> (*)(const std::string&, const VoxelModel&, const VoxelShares&,
                               const std::atomic<bool>*);

Write WriterOf(const std::string& path) {
  return path.ends_with(".vti") ? WriteVti : path.ends_with(".nrrd") ? WriteNrrd : nullptr;
}

}  // namespace

Result<void> CheckShareFormat(const std::string& path) {
  if (WriterOf(path) != nullptr) return {};
  return Error{ErrorCode::kBadUsage, path + ": only .vti and .nrrd hold the shares of --fraction"};
}

Result<void> WriteShares(const std::string& path, const VoxelModel& model, const VoxelShares& shares,
                         const std::atomic<bool>* cancel) {
  if (auto known = CheckShareFormat(path); !known) return known;
  return WriterOf(path)(path, model, shares, cancel);
}

}  // namespace facetless
