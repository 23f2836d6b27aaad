// The columns of a .vxl file, as K. Silverman's Voxlap stores them: z runs downwards, and everything below the last visible
// floor is solid down to the bottom. A span has a header of four bytes: the number of 4-byte words to the next span (0: it is
// the last), the first and the last voxel of its floor, and the first voxel of the air above it. The colours of the floor
// follow. The words that are left are the colours of the ceiling below: the visible voxels just above the next span's air.
#include <array>

#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"
#include "render/voxels/run_model.h"

namespace facetless {
namespace {

constexpr std::uint32_t kMagic = 0x09072000;
// Voxlap's camera: a position and three axes of doubles.
constexpr std::size_t kCameraBytes = 12 * sizeof(double);
// The bytes of a span's header hold heights up to this; the lowest layer is solid everywhere.
constexpr int kMostHeight = 255;

// Whether all voxels of the lowest layer are filled.
bool HasGround(const RunModel& model) {
  for (int x = 0; x < model.size().x; ++x)
    for (int y = 0; y < model.size().y; ++y) {
      const std::span<const VoxelRun> column = model.Column(x, y);
      if (column.empty() || column[0].z_begin > 0) return false;
    }
  return true;
}

std::uint32_t ColorOf(Voxel voxel) {
  // Blue is the lowest byte; the highest is the brightness, of which 128 is the usual.
  return std::uint32_t{voxel.blue()} | std::uint32_t{voxel.green()} << 8 | std::uint32_t{voxel.red()} << 16 |
         0x80000000u;
}
Voxel VoxelOf(std::uint32_t color) {
  return Voxel::Of(static_cast<std::uint8_t>(color >> 16), static_cast<std::uint8_t>(color >> 8),
                   static_cast<std::uint8_t>(color));
}

// Which voxels of a column, from the top down, are filled, and which of them have an empty neighbour.
struct Column {
  std::vector<Voxel> voxels;
  std::vector<bool> visible;
};

class VxlWriter {
 public:
  // Adds a solid layer below unless the model has one.
  VxlWriter(const RunModel& model, bool has_ground)
      : model_(model), height_(model.size().z + (has_ground ? 0 : 1)) {}

  // Appends the spans of a column.
  void AppendColumn(int x, int y, std::string& bytes) {
    LoadColumn(x, y);
    int z = 0;
    for (;;) {
      const int air = z;
      while (!column_.voxels[Index(z)].filled()) ++z;  // the bottom is solid
      const int floor = z;
      while (z < height_ && column_.voxels[Index(z)].filled() && column_.visible[Index(z)]) ++z;
      const int floor_end = z;
      // The voxels that cannot be seen have no colours. What can be seen below them begins a span without air.
      while (z < height_ && column_.voxels[Index(z)].filled() && !column_.visible[Index(z)]) ++z;
      const bool last = z >= height_;
      bytes.push_back(static_cast<char>(last ? 0 : 1 + floor_end - floor));
      bytes.push_back(static_cast<char>(floor));
      bytes.push_back(static_cast<char>(floor_end - 1));
      bytes.push_back(static_cast<char>(air));
      for (int at = floor; at < floor_end; ++at) AppendColor(at, bytes);
      if (last) return;
    }
  }

 private:
  static std::size_t Index(int z) { return static_cast<std::size_t>(z); }

  void AppendColor(int z, std::string& bytes) const {
    const std::uint32_t color = ColorOf(column_.voxels[Index(z)]);
    bytes.append(reinterpret_cast<const char*>(&color), sizeof color);
  }

  void LoadColumn(int x, int y) {
    const int n = model_.size().z;
    const auto load = [&](int at_x, int at_y, std::vector<Voxel>& voxels) {
      voxels.assign(Index(height_), {});
      if (at_x >= 0 && at_y >= 0 && at_x < model_.size().x && at_y < model_.size().y)
        for (const VoxelRun& run : model_.Column(at_x, at_y))
          for (int z = run.z_begin; z < run.z_end; ++z) voxels[Index(n - 1 - z)] = run.voxel;
      constexpr std::uint8_t kGround = 96;
      if (!voxels.back().filled()) voxels.back() = Voxel::Of(kGround, kGround, kGround);
    };
    load(x, y, column_.voxels);
    column_.visible.assign(Index(height_), false);
    for (int z = 0; z < height_; ++z) {
      const bool above = z == 0 || !column_.voxels[Index(z - 1)].filled(),
                 below = z + 1 < height_ && !column_.voxels[Index(z + 1)].filled();
      column_.visible[Index(z)] = above || below;
    }
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      load(x + dx, y + dy, neighbour_);
      for (int z = 0; z < height_; ++z)
        if (!neighbour_[Index(z)].filled()) column_.visible[Index(z)] = true;
    }
  }

  const RunModel& model_;
  const int height_;
  Column column_;
  std::vector<Voxel> neighbour_;
};

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid&,
                   const VoxelFileOptions&) {
  const VoxelPoint n = model.size();
  const auto too_high = [&] {
    return Error{ErrorCode::kBadUsage, path + ": .vxl files are at most " + std::to_string(kMostHeight - 1) +
                                           " voxels high, not " + std::to_string(n.z) +
                                           "; use fewer voxels, or another format"};
  };
  if (n.z > kMostHeight + 1) return too_high();
  const RunModel runs = RunsOf(model);
  const bool has_ground = HasGround(runs);
  if (n.z >= kMostHeight && !has_ground) return too_high();
  VoxelFileWriter out(path);
  out.Number(kMagic);
  out.Number(static_cast<std::uint32_t>(n.x));
  out.Number(static_cast<std::uint32_t>(n.y));
  // A camera above the middle, which looks down.
  for (const double number : {n.x / 2.0, n.y / 2.0, -1.0 * n.z, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0})
    out.Number(number);
  VxlWriter writer(runs, has_ground);
  std::string bytes;
  for (int y = 0; y < n.y; ++y) {
    bytes.clear();
    for (int x = 0; x < n.x; ++x) writer.AppendColumn(x, y, bytes);
    out.Text(bytes);
  }
  return out.Finish();
}

// Reads the spans of a column. Voxels without a colour have that of the last coloured one above them.
class ColumnReader {
 public:
  // Returns what is wrong; empty if the column is sound. `voxels` runs from the top down.
  std::string Read(VoxelFileReader& reader, std::vector<Voxel>* voxels) {
    voxels->assign(kMostHeight + 1, {});
    int below = 0;  // everything above has been read
    for (;;) {
      std::array<std::uint8_t, 4> head{};
      if (!reader.Number(&head)) return "a column ends too early";
      const int words = head[0], floor = head[1], floor_end = head[2] + 1;
      const bool last = words == 0;
      const int floor_count = floor_end - floor;
      if (floor < below || floor_count < 0 || (!last && words < 1 + floor_count))
        return "the spans of a column do not follow one another";
      for (int z = floor; z < floor_end; ++z)
        if (!ReadColor(reader, (*voxels)[static_cast<std::size_t>(z)])) return "a column ends too early";
      Voxel hidden =
          floor_count > 0 ? (*voxels)[static_cast<std::size_t>(floor_end - 1)] : Voxel::Of(128, 128, 128);
      if (last) {
        for (int z = floor_end; z <= kMostHeight; ++z) (*voxels)[static_cast<std::size_t>(z)] = hidden;
        return "";
      }
      const int ceiling_count = words - 1 - floor_count;
      std::vector<Voxel> ceiling(static_cast<std::size_t>(ceiling_count));
      for (Voxel& voxel : ceiling)
        if (!ReadColor(reader, voxel)) return "a column ends too early";
      // The next span's air begins where the solid ends.
      VoxelFileReader peek = reader;
      std::array<std::uint8_t, 4> next{};
      if (!peek.Number(&next)) return "a column ends too early";
      const int solid_end = next[3];
      if (solid_end < floor_end + ceiling_count) return "the spans of a column do not follow one another";
      for (int z = floor_end; z < solid_end; ++z) {
        const int of_ceiling = z - (solid_end - ceiling_count);
        (*voxels)[static_cast<std::size_t>(z)] =
            of_ceiling >= 0 ? ceiling[static_cast<std::size_t>(of_ceiling)] : hidden;
      }
      below = solid_end;
    }
  }

 private:
  static bool ReadColor(VoxelFileReader& reader, Voxel& voxel) {
    std::uint32_t color = 0;
    if (!reader.Number(&color)) return false;
    voxel = VoxelOf(color);
    return true;
  }
};

Result<VoxelFile> Read(const std::string& path, const VoxelFileOptions& options) {
  const Result<std::vector<unsigned char>> bytes = ReadVoxelBytes(path, options.max_bytes);
  if (!bytes.ok()) return bytes.error();
  VoxelFileReader reader(bytes.value());
  std::uint32_t magic = 0, x_size = 0, y_size = 0;
  if (!reader.Number(&magic) || magic != kMagic)
    return Error{ErrorCode::kFormatUnknown, path + ": is not a .vxl file of Voxlap"};
  if (!reader.Number(&x_size) || !reader.Number(&y_size) || !reader.Skip(kCameraBytes))
    return BrokenVoxelFile(path, "the header ends too early");
  // A column takes at least the header of a span.
  constexpr std::uint64_t kLeast = 4;
  if (std::uint64_t{x_size} * y_size > reader.left() / kLeast)
    return BrokenVoxelFile(path, "the file is too short for the " + std::to_string(x_size) + " × " +
                                     std::to_string(y_size) + " columns that it claims");
  const Result<VoxelPoint> size = CheckVoxelSize(path, x_size, y_size, kMostHeight + 1);
  if (!size.ok()) return size.error();
  auto model = std::make_unique<RunModel>(size.value());
  ColumnReader columns;
  std::vector<Voxel> voxels;
  std::vector<VoxelRun> runs;
  for (int y = 0; y < size.value().y; ++y)
    for (int x = 0; x < size.value().x; ++x) {
      if (const std::string wrong = columns.Read(reader, &voxels); !wrong.empty())
        return BrokenVoxelFile(path, wrong);
      runs.clear();
      for (int z = 0; z <= kMostHeight; ++z)
        if (const Voxel voxel = voxels[static_cast<std::size_t>(kMostHeight - z)]; voxel.filled())
          runs.push_back({z, z + 1, voxel});
      model->SetColumn(x, y, runs);
    }
  if (reader.left() > 0) return BrokenVoxelFile(path, "bytes follow the last column");
  return VoxelFile{std::move(model), std::nullopt};
}

}  // namespace

VoxelFormat VxlFormat() {
  return {".vxl", "Voxlap",
          "Files of Voxlap hold no materials, no colours of hidden voxels, and not where the voxels are; a "
          "solid layer is added below a model that has none.",
          Write, Read};
}

}  // namespace facetless
