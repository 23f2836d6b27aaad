#include <cmath>
#include <map>

#include "render/voxel_files/dense_slices.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid) {
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
  VisitSlices(model, [&](int, std::span<const Voxel> slice) {
    bytes.clear();
    for (const Voxel& voxel : slice) bytes.push_back(static_cast<char>(voxel.material()));
    out.Text(bytes);
  });
  return out.Finish();
}

struct Header {
  std::map<std::string, std::string> fields;
  std::size_t data = 0;  // where the voxels begin
};

Result<Header> ReadHeader(const std::string& path, std::span<const unsigned char> bytes) {
  Header header;
  std::size_t at = 0;
  bool first = true;
  for (;;) {
    std::string line;
    while (at < bytes.size() && bytes[at] != '\n') line.push_back(static_cast<char>(bytes[at++]));
    if (at == bytes.size()) return BrokenVoxelFile(path, "the header of the NRRD file has no end");
    ++at;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (first) {
      if (!line.starts_with("NRRD000")) return Error{ErrorCode::kFormatUnknown, path + ": is no NRRD file"};
      first = false;
      continue;
    }
    if (line.empty()) break;
    const std::size_t colon = line.find(": ");
    if (line[0] == '#' || colon == std::string::npos) continue;  // a comment, or a key with a value
    header.fields[line.substr(0, colon)] = line.substr(colon + 2);
  }
  header.data = at;
  return header;
}

enum class Sample { kUint8, kInt8, kUint16, kInt16, kFloat };

// Reads the sample at `from` as a material.
Voxel VoxelOf(const unsigned char* from, Sample type) {
  double value = 0;
  const auto load = [&]<typename T>(T number) {
    std::memcpy(&number, from, sizeof(T));
    value = static_cast<double>(number);
  };
  switch (type) {
    case Sample::kUint8:
      load(std::uint8_t{});
      break;
    case Sample::kInt8:
      load(std::int8_t{});
      break;
    case Sample::kUint16:
      load(std::uint16_t{});
      break;
    case Sample::kInt16:
      load(std::int16_t{});
      break;
    case Sample::kFloat:
      load(float{});
      break;
  }
  if (!(value > 0)) return {};
  constexpr std::uint8_t kGrey = 178;
  const bool label = type != Sample::kFloat && value <= 255;
  return Voxel::Of(kGrey, kGrey, kGrey, label ? static_cast<std::uint8_t>(value) : 1);
}

std::optional<VoxelGrid> GridOf(const Header& header, VoxelPoint size) {
  const auto field = [&](const char* name) {
    const auto found = header.fields.find(name);
    return found == header.fields.end() ? std::string() : found->second;
  };
  double d[9], o[3];
  if (std::sscanf(field("space directions").c_str(), " (%lf,%lf,%lf) (%lf,%lf,%lf) (%lf,%lf,%lf)", d, d + 1,
                  d + 2, d + 3, d + 4, d + 5, d + 6, d + 7, d + 8) != 9 ||
      std::sscanf(field("space origin").c_str(), " (%lf,%lf,%lf)", o, o + 1, o + 2) != 3)
    return std::nullopt;
  // Only cubes along the axes are voxels here.
  const bool cubes = d[0] > 0 && d[0] == d[4] && d[4] == d[8] && d[1] == 0 && d[2] == 0 && d[3] == 0 &&
                     d[5] == 0 && d[6] == 0 && d[7] == 0;
  if (!cubes || !std::isfinite(d[0] + o[0] + o[1] + o[2])) return std::nullopt;
  return VoxelGrid{Vec3{o[0], o[1], o[2]} - 0.5 * d[0] * Vec3{1, 1, 1}, d[0], size};
}

Result<VoxelFile> Read(const std::string& path, std::uint64_t max_bytes) {
  Result<std::vector<unsigned char>> bytes = ReadVoxelBytes(path, max_bytes);
  if (!bytes.ok()) return bytes.error();
  const Result<Header> header = ReadHeader(path, bytes.value());
  if (!header.ok()) return header.error();
  const auto field = [&](const char* name) {
    const auto found = header.value().fields.find(name);
    return found == header.value().fields.end() ? std::string() : found->second;
  };
  static const std::map<std::string, std::pair<Sample, std::size_t>> kTypes = {
      {"uint8", {Sample::kUint8, 1}},
      {"uchar", {Sample::kUint8, 1}},
      {"unsigned char", {Sample::kUint8, 1}},
      {"int8", {Sample::kInt8, 1}},
      {"char", {Sample::kInt8, 1}},
      {"signed char", {Sample::kInt8, 1}},
      {"uint16", {Sample::kUint16, 2}},
      {"ushort", {Sample::kUint16, 2}},
      {"unsigned short", {Sample::kUint16, 2}},
      {"int16", {Sample::kInt16, 2}},
      {"short", {Sample::kInt16, 2}},
      {"float", {Sample::kFloat, 4}}};
  const auto type = kTypes.find(field("type"));
  if (type == kTypes.end())
    return BrokenVoxelFile(path, "NRRD samples of type '" + field("type") +
                                     "' are not read; 8- and 16-bit integers and float are");
  if (field("encoding") != "raw" || !field("data file").empty() || !field("datafile").empty())
    return BrokenVoxelFile(path,
                           "only NRRD files with the encoding raw and the data in the same file are read");
  const auto [sample, width] = type->second;
  if (width > 1 && field("endian") != "little")
    return BrokenVoxelFile(path, "only little-endian NRRD files are read");
  long long n[3];
  if (field("dimension") != "3" ||
      std::sscanf(field("sizes").c_str(), " %lld %lld %lld", n, n + 1, n + 2) != 3)
    return BrokenVoxelFile(path, "only NRRD files of three dimensions are read");
  const Result<VoxelPoint> size =
      CheckVoxelSize(path, n[0], n[1], n[2], static_cast<double>(width), max_bytes);
  if (!size.ok()) return size.error();
  const std::uint64_t expected = VoxelBox{{0, 0, 0}, size.value()}.volume() * width,
                      found = bytes.value().size() - header.value().data;
  if (found != expected)
    return BrokenVoxelFile(path, "the file should have " + std::to_string(expected) +
                                     " bytes of voxels, but has " + std::to_string(found));
  SliceCollector slices(size.value());
  std::vector<Voxel> slice(static_cast<std::size_t>(size.value().x) *
                           static_cast<std::size_t>(size.value().y));
  const unsigned char* from = bytes.value().data() + header.value().data;
  for (int z = 0; z < size.value().z; ++z) {
    for (Voxel& voxel : slice) {
      voxel = VoxelOf(from, sample);
      from += width;
    }
    slices.Add(slice);
  }
  return VoxelFile{std::make_unique<RunModel>(slices.Take()), GridOf(header.value(), size.value())};
}

}  // namespace

VoxelFormat NrrdFormat() {
  return {".nrrd", "NRRD", "NRRD files hold the materials of voxels, but no colours.", Write, Read};
}

}  // namespace facetless
