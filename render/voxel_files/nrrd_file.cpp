#include <cmath>
#include <filesystem>
#include <map>

#include "render/voxel_files/byte_source.h"
#include "render/voxel_files/dense_slices.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                   const VoxelFileOptions& options) {
  if (auto room = CheckRoom(path, static_cast<double>(model.box().volume())); !room.ok()) return room;
  VoxelFileWriter out(path);
  const VoxelPoint n = model.size();
  const std::string p = PreciseText(grid.pitch);
  // The origin of NRRD is the centre of the first sample.
  const Vec3 first = grid.Center({0, 0, 0});
  out.Text(
      "NRRD0004\n# Facetless: 0 is empty, 1 to 255 are materials; lengths are millimetres\n"
      "type: uint8\ndimension: 3\nspace dimension: 3\nsizes: " +
      std::to_string(n.x) + " " + std::to_string(n.y) + " " + std::to_string(n.z) + "\nspace directions: (" +
      p + ",0,0) (0," + p + ",0) (0,0," + p + ")\nspace units: \"mm\" \"mm\" \"mm\"\nspace origin: (" +
      PreciseText(first.x) + "," + PreciseText(first.y) + "," + PreciseText(first.z) +
      ")\nkinds: domain domain domain\nencoding: raw\n\n");
  std::string bytes;
  auto visited = VisitSlices(model, 2, options.cancel, [&](int, std::span<const Voxel> slice) {
    bytes.clear();
    for (const Voxel& voxel : slice) bytes.push_back(static_cast<char>(voxel.material()));
    out.Text(bytes);
    return out.Checked();
  });
  if (!visited.ok()) return visited;
  return out.Finish();
}

class Header {
 public:
  static Result<Header> Of(const std::string& path, std::string_view text) {
    Header header;
    std::size_t at = 0;
    for (bool first = true;; first = false) {
      const std::size_t end = text.find('\n', at);
      // A file without data, such as one of a series, ends with its header.
      if (end == std::string_view::npos)
        return BrokenVoxelFile(path, "the header of the NRRD file has no end");
      std::string line(text.substr(at, end - at));
      at = end + 1;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (first) {
        if (!line.starts_with("NRRD000"))
          return Error{ErrorCode::kFormatUnknown, path + ": is not an NRRD file"};
        continue;
      }
      if (line.empty()) break;
      const std::size_t colon = line.find(": ");
      if (line[0] == '#' || colon == std::string::npos) continue;  // a comment, or a key with a value
      header.fields_[line.substr(0, colon)] = line.substr(colon + 2);
    }
    header.data_ = at;
    return header;
  }
  std::string operator[](const char* name) const {
    const auto found = fields_.find(name);
    return found == fields_.end() ? std::string() : found->second;
  }
  std::size_t data() const { return data_; }  // where the voxels begin

 private:
  std::map<std::string, std::string> fields_;
  std::size_t data_ = 0;
};

std::optional<NumberType> TypeOf(const std::string& name) {
  // All names that the definition of the format gives these types.
  static const std::map<std::string_view, NumberType> kTypes = {
      {"signed char", NumberType::kInt8},
      {"int8", NumberType::kInt8},
      {"int8_t", NumberType::kInt8},
      {"uchar", NumberType::kUint8},
      {"unsigned char", NumberType::kUint8},
      {"uint8", NumberType::kUint8},
      {"uint8_t", NumberType::kUint8},
      {"short", NumberType::kInt16},
      {"short int", NumberType::kInt16},
      {"signed short", NumberType::kInt16},
      {"signed short int", NumberType::kInt16},
      {"int16", NumberType::kInt16},
      {"int16_t", NumberType::kInt16},
      {"ushort", NumberType::kUint16},
      {"unsigned short", NumberType::kUint16},
      {"unsigned short int", NumberType::kUint16},
      {"uint16", NumberType::kUint16},
      {"uint16_t", NumberType::kUint16},
      {"int", NumberType::kInt32},
      {"signed int", NumberType::kInt32},
      {"int32", NumberType::kInt32},
      {"int32_t", NumberType::kInt32},
      {"uint", NumberType::kUint32},
      {"unsigned int", NumberType::kUint32},
      {"uint32", NumberType::kUint32},
      {"uint32_t", NumberType::kUint32},
      {"longlong", NumberType::kInt64},
      {"long long", NumberType::kInt64},
      {"long long int", NumberType::kInt64},
      {"signed long long", NumberType::kInt64},
      {"signed long long int", NumberType::kInt64},
      {"int64", NumberType::kInt64},
      {"int64_t", NumberType::kInt64},
      {"ulonglong", NumberType::kUint64},
      {"unsigned long long", NumberType::kUint64},
      {"unsigned long long int", NumberType::kUint64},
      {"uint64", NumberType::kUint64},
      {"uint64_t", NumberType::kUint64},
      {"float", NumberType::kFloat},
      {"double", NumberType::kDouble}};
  const auto found = kTypes.find(name);
  if (found == kTypes.end()) return std::nullopt;
  return found->second;
}

// The length in mm of the unit of all axes; nothing if there is none, or if it is no length that is known here.
std::optional<double> UnitOf(const std::string& units) {
  if (units.empty()) return 1;
  static const std::map<std::string_view, double> kUnits = {
      {"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 1e-3}, {"\u00b5m", 1e-3}, {"nm", 1e-6}, {"in", 25.4}};
  const std::size_t end = units.find('"', 1);
  if (units[0] != '"' || end == std::string::npos) return std::nullopt;
  const auto found = kUnits.find(std::string_view(units).substr(1, end - 1));
  if (found == kUnits.end()) return std::nullopt;
  return found->second;
}

// Sets the grid of a file, or says why there is none.
void SetGrid(const Header& header, VoxelPoint size, VoxelFile& file) {
  double d[9] = {}, o[3] = {};
  const bool has_origin = std::sscanf(header["space origin"].c_str(), " (%lf,%lf,%lf)", o, o + 1, o + 2) == 3;
  std::string units = header["space units"];
  if (std::sscanf(header["space directions"].c_str(), " (%lf,%lf,%lf) (%lf,%lf,%lf) (%lf,%lf,%lf)", d, d + 1,
                  d + 2, d + 3, d + 4, d + 5, d + 6, d + 7, d + 8) != 9) {
    if (std::sscanf(header["spacings"].c_str(), " %lf %lf %lf", d, d + 4, d + 8) != 3) return;
    units = header["units"];
  }
  const bool cubes = d[0] > 0 && d[0] == d[4] && d[4] == d[8] && d[1] == 0 && d[2] == 0 && d[3] == 0 &&
                     d[5] == 0 && d[6] == 0 && d[7] == 0;
  const std::optional<double> unit = UnitOf(units);
  if (!cubes || !unit) {
    file.warnings.push_back(
        cubes ? "the unit of the file is no length that is known (" + units + "), so the grid is not used"
              : "the samples of the file are not cubes along the axes, so they are read as if they were "
                "(space directions: " +
                    header["space directions"] + ", spacings: " + header["spacings"] + ")");
    return;
  }
  const double pitch = *unit * d[0];
  const Vec3 first = has_origin ? *unit * Vec3{o[0], o[1], o[2]} : Vec3{};
  if (!std::isfinite(pitch + first.x + first.y + first.z)) return;
  file.grid = VoxelGrid{first - 0.5 * pitch * Vec3{1, 1, 1}, pitch, size};
}

// The numbers of a file, from its encoding. Errors: kFormatBroken (encodings that are not read; a raw file of another
// length than its voxels need).
Result<NumberSource> NumbersOf(const std::string& path, const Header& header, NumberType type,
                               std::uint64_t count) {
  const std::string encoding = header["encoding"], endian = header["endian"];
  if (encoding == "ascii" || encoding == "text" || encoding == "txt")
    return NumberSource::FromText(FileRange(path, header.data()));
  const std::size_t width = BytesOf(type);
  if (width > 1 && endian != "little" && endian != "big")
    return BrokenVoxelFile(path, "the header does not say whether numbers are little or big endian");
  const std::endian order = endian == "big" ? std::endian::big : std::endian::little;
  if (encoding == "gzip" || encoding == "gz")
    return NumberSource(Inflated(FileRange(path, header.data())), type, order);
  if (encoding != "raw")
    return BrokenVoxelFile(
        path, "NRRD files with the encoding '" + encoding + "' are not read; raw, gzip and ascii are");
  std::error_code failed;
  const std::uint64_t expected = count * width,
                      found = std::filesystem::file_size(path, failed) - header.data();
  if (found != expected)
    return BrokenVoxelFile(path, "the file should have " + std::to_string(expected) +
                                     " bytes of voxels, but has " + std::to_string(found));
  return NumberSource(FileRange(path, header.data()), type, order);
}

Result<VoxelFile> Read(const std::string& path, const VoxelFileOptions& options) {
  constexpr std::size_t kMostHeader = 1 << 16;
  const Result<std::string> start = ReadVoxelStart(path, kMostHeader);
  if (!start.ok()) return start.error();
  const Result<Header> read = Header::Of(path, start.value());
  if (!read.ok()) return read.error();
  const Header& header = read.value();
  const std::optional<NumberType> type = TypeOf(header["type"]);
  if (!type)
    return BrokenVoxelFile(path, "NRRD samples of type '" + header["type"] +
                                     "' are not read; whole numbers, float and double are");
  for (const char* field : {"data file", "datafile", "byte skip", "byteskip", "line skip", "lineskip"})
    if (!header[field].empty() && header[field] != "0")
      return BrokenVoxelFile(path, "only NRRD files whose data follow the header are read, without '" +
                                       std::string(field) + "'");
  long long n[3];
  if (header["dimension"] != "3" ||
      std::sscanf(header["sizes"].c_str(), " %lld %lld %lld", n, n + 1, n + 2) != 3)
    return BrokenVoxelFile(path, "only NRRD files of three dimensions are read");
  const Result<VoxelPoint> size = CheckVoxelSize(path, n[0], n[1], n[2]);
  if (!size.ok()) return size.error();
  Result<NumberSource> numbers = NumbersOf(path, header, *type, VoxelBox{{0, 0, 0}, size.value()}.volume());
  if (!numbers.ok()) return numbers.error();
  Result<SliceCollector> slices = SliceCollector::Of(path, size.value(), 2, options);
  if (!slices.ok()) return slices.error();
  std::vector<double> values(slices.value().shape().area());
  std::vector<Voxel> slice(values.size());
  const bool whole = IsWhole(*type);
  for (int z = 0; z < size.value().z; ++z) {
    if (!numbers.value().Read(values))
      return BrokenVoxelFile(path, "the voxels end too early, or are damaged, in slice " + std::to_string(z) +
                                       " of " + std::to_string(size.value().z));
    for (std::size_t i = 0; i < values.size(); ++i)
      slice[i] = VoxelOfNumber(values[i], whole, options.threshold);
    if (auto added = slices.value().Add(slice); !added.ok()) return added.error();
  }
  VoxelFile file{std::make_unique<RunModel>(slices.value().Take()), std::nullopt};
  SetGrid(header, size.value(), file);
  return file;
}

}  // namespace

VoxelFormat NrrdFormat() {
  return {".nrrd", "NRRD", "NRRD files hold the materials of voxels, but no colours.", Write, Read};
}

}  // namespace facetless
