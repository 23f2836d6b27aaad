#include <cstdlib>

#include "render/voxel_files/dense_slices.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid) {
  VoxelFileWriter out(path);
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
      "\">\n<Piece Extent=\"" + extent +
      "\">\n<CellData Scalars=\"material\">\n<DataArray type=\"UInt8\" Name=\"material\" format=\"appended\" "
      "offset=\"0\"/>\n<DataArray type=\"UInt8\" Name=\"color\" NumberOfComponents=\"3\" format=\"appended\" "
      "offset=\"" +
      std::to_string(count + sizeof(std::uint64_t)) +
      "\"/>\n</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_");
  std::string bytes;
  out.Number(count);
  VisitSlices(model, [&](int, std::span<const Voxel> slice) {
    bytes.clear();
    for (const Voxel& voxel : slice) bytes.push_back(static_cast<char>(voxel.material()));
    out.Text(bytes);
  });
  out.Number(3 * count);
  VisitSlices(model, [&](int, std::span<const Voxel> slice) {
    bytes.clear();
    for (const Voxel& voxel : slice)
      for (const std::uint8_t channel : {voxel.red(), voxel.green(), voxel.blue()})
        bytes.push_back(static_cast<char>(channel));
    out.Text(bytes);
  });
  out.Text("\n</AppendedData>\n</VTKFile>\n");
  return out.Finish();
}

// The value of an attribute in a tag, or nothing.
std::optional<std::string> Attribute(const std::string& tag, const std::string& name) {
  const std::string start = " " + name + "=\"";
  const std::size_t at = tag.find(start);
  if (at == std::string::npos) return std::nullopt;
  const std::size_t begin = at + start.size(), end = tag.find('"', begin);
  if (end == std::string::npos) return std::nullopt;
  return tag.substr(begin, end - begin);
}

// The text of the first tag of a name that `accepts` takes; empty if there is none.
template <typename Accepts>
std::string FindTag(const std::string& xml, const std::string& name, const Accepts& accepts) {
  for (std::size_t at = xml.find("<" + name); at != std::string::npos; at = xml.find("<" + name, at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return "";
    const std::string tag = xml.substr(at, end - at);
    if (accepts(tag)) return tag;
  }
  return "";
}
std::string FindTag(const std::string& xml, const std::string& name) {
  return FindTag(xml, name, [](const std::string&) { return true; });
}

// The bytes of an appended array, without its length; nothing if they are not in the file.
std::optional<std::span<const unsigned char>> Appended(std::span<const unsigned char> data,
                                                       const std::string& tag, std::uint64_t expected) {
  const auto offset = Attribute(tag, "offset");
  if (!offset) return std::nullopt;
  const std::uint64_t at = std::strtoull(offset->c_str(), nullptr, 10);
  std::uint64_t length = 0;
  if (at > data.size() || data.size() - at < sizeof length) return std::nullopt;
  std::memcpy(&length, data.data() + at, sizeof length);
  if (length != expected || data.size() - at - sizeof length < length) return std::nullopt;
  return data.subspan(at + sizeof length, length);
}

Result<VoxelFile> Read(const std::string& path, std::uint64_t max_bytes) {
  const Result<std::vector<unsigned char>> bytes = ReadVoxelBytes(path, max_bytes);
  if (!bytes.ok()) return bytes.error();
  // The header ends with the underscore before the appended bytes.
  constexpr std::size_t kMostHeader = 1 << 16;
  const std::string head(
      bytes.value().begin(),
      bytes.value().begin() + static_cast<std::ptrdiff_t>(std::min(bytes.value().size(), kMostHeader)));
  const std::size_t appended = head.find("<AppendedData");
  const std::size_t data_at =
      appended == std::string::npos ? appended : head.find('_', head.find('>', appended));
  if (data_at == std::string::npos)
    return BrokenVoxelFile(path, "only VTK image data with appended raw bytes are read");
  const std::string xml = head.substr(0, data_at);
  const std::string file_tag = FindTag(xml, "VTKFile"), image = FindTag(xml, "ImageData"),
                    data_tag = FindTag(xml, "AppendedData");
  if (Attribute(file_tag, "type") != "ImageData" || Attribute(file_tag, "byte_order") != "LittleEndian" ||
      Attribute(file_tag, "header_type") != "UInt64" || Attribute(data_tag, "encoding") != "raw" ||
      Attribute(file_tag, "compressor"))
    return BrokenVoxelFile(
        path, "only uncompressed little-endian image data with 64-bit lengths and raw bytes are read");
  long long e[6];
  if (std::sscanf(Attribute(image, "WholeExtent").value_or("").c_str(), " %lld %lld %lld %lld %lld %lld", e,
                  e + 1, e + 2, e + 3, e + 4, e + 5) != 6)
    return BrokenVoxelFile(path, "the image data have no extent");
  constexpr long long kMost = 1LL << 40;
  for (const long long end : e)
    if (end < -kMost || end > kMost) return BrokenVoxelFile(path, "the extent is out of range");
  const Result<VoxelPoint> size = CheckVoxelSize(path, e[1] - e[0], e[3] - e[2], e[5] - e[4], 1, max_bytes);
  if (!size.ok()) return size.error();
  const std::uint64_t count = VoxelBox{{0, 0, 0}, size.value()}.volume();
  const std::span<const unsigned char> data = std::span(bytes.value()).subspan(data_at + 1);
  const auto is_bytes = [](const std::string& tag, const char* components) {
    return Attribute(tag, "type") == "UInt8" &&
           Attribute(tag, "NumberOfComponents").value_or("1") == components;
  };
  const std::string material_tag =
                        FindTag(xml, "DataArray", [&](const std::string&tag) { return is_bytes(tag, "1"); }),
                    color_tag =
                        FindTag(xml, "DataArray", [&](const std::string&tag) { return is_bytes(tag, "3"); });
  const auto material = Appended(data, material_tag, count);
  if (!material)
    return BrokenVoxelFile(path, "the file has no array of 8-bit labels with a value for each of its " +
                                     std::to_string(count) + " cells");
  const auto color = Appended(data, color_tag, 3 * count);
  if (!color_tag.empty() && !color)
    return BrokenVoxelFile(path,
                           "the file has no colour for each of its " + std::to_string(count) + " cells");
  SliceCollector slices(size.value());
  std::vector<Voxel> slice(static_cast<std::size_t>(size.value().x) *
                           static_cast<std::size_t>(size.value().y));
  constexpr std::uint8_t kGrey = 178;
  std::size_t at = 0;
  for (int z = 0; z < size.value().z; ++z) {
    for (Voxel& voxel : slice) {
      voxel = (*material)[at] == 0 ? Voxel{}
              : color
                  ? Voxel::Of((*color)[3 * at], (*color)[3 * at + 1], (*color)[3 * at + 2], (*material)[at])
                  : Voxel::Of(kGrey, kGrey, kGrey, (*material)[at]);
      ++at;
    }
    slices.Add(slice);
  }
  VoxelFile file{std::make_unique<RunModel>(slices.Take()), std::nullopt};
  double o[3], s[3];
  if (std::sscanf(Attribute(image, "Origin").value_or("").c_str(), " %lf %lf %lf", o, o + 1, o + 2) == 3 &&
      std::sscanf(Attribute(image, "Spacing").value_or("").c_str(), " %lf %lf %lf", s, s + 1, s + 2) == 3 &&
      s[0] > 0 && s[0] == s[1] && s[1] == s[2] && std::isfinite(s[0] + o[0] + o[1] + o[2]))
    file.grid = VoxelGrid{Vec3{o[0], o[1], o[2]} + s[0] * Vec3{double(e[0]), double(e[2]), double(e[4])},
                          s[0], size.value()};
  return file;
}

}  // namespace

VoxelFormat VtiFormat() {
  return {".vti", "VTK image data", "", Write, Read};
}

}  // namespace facetless
