// VTK's image data. An array of numbers is text between its tags, base64 between its tags, or bytes or base64 after the
// underscore of AppendedData, at an offset. Except in text, a header comes first: the length in bytes; or, with a
// compressor, the number of blocks, the length of a block, that of the last one, and the compressed length of each. The
// compressed blocks are streams of zlib that follow one another.
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>

#include "render/voxel_files/byte_source.h"
#include "render/voxel_files/dense_slices.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

Result<void> Write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                   const VoxelFileOptions& options) {
  if (auto room = CheckRoom(path, 4 * static_cast<double>(model.box().volume())); !room.ok()) return room;
  VoxelFileWriter out(path);
  out.Text(VtiBeginning(grid, kVtiMaterial.name, std::array{kVtiMaterial, kVtiColor}));
  if (auto written = WriteVtiColors(model, options.cancel, &out); !written.ok()) return written;
  out.Text(kVtiEnd);
  return out.Finish();
}

// A tag: its text between the brackets, and where its content begins in the file.
struct Tag {
  std::string text;
  std::uint64_t content = 0;

  bool Is(std::string_view name) const {
    return text.starts_with(name) &&
           (text.size() == name.size() || text[name.size()] == ' ' || text[name.size()] == '\n' ||
            text[name.size()] == '/' || text[name.size()] == '\t' || text[name.size()] == '\r');
  }
  // The value of an attribute, or "".
  std::string operator[](const std::string& name) const {
    for (std::size_t at = text.find(name + "="); at != std::string::npos;
         at = text.find(name + "=", at + 1)) {
      const std::size_t quote = at + name.size() + 1;
      const bool whole = at > 0 && std::isspace(static_cast<unsigned char>(text[at - 1])) != 0;
      if (!whole || quote >= text.size() || (text[quote] != '"' && text[quote] != '\'')) continue;
      const std::size_t end = text.find(text[quote], quote + 1);
      if (end != std::string::npos) return text.substr(quote + 1, end - quote - 1);
    }
    return "";
  }
};

// The tags of a file, up to that of its appended data.
class Tags {
 public:
  // Errors: kFileUnreadable, kFormatUnknown, kFormatBroken.
  static Result<Tags> Of(const std::string& path) {
    const Result<std::uint64_t> size = VoxelFileSize(path);
    if (!size.ok()) return size.error();
    constexpr std::size_t kMostTags = 10000, kLongestTag = 1 << 16;
    Tags tags;
    const std::unique_ptr<ByteSource> source = FileRange(path, 0);
    std::vector<unsigned char> buffer(1 << 16);
    std::string tag;
    bool inside = false;
    std::uint64_t at = 0;
    for (std::size_t count = source->Read(buffer); count > 0; count = source->Read(buffer))
      for (std::size_t i = 0; i < count; ++i) {
        ++at;
        const char c = static_cast<char>(buffer[i]);
        if (!inside) {
          inside = c == '<';
        } else if (c == '>') {
          tags.all_.push_back({tag, at});
          inside = false;
          if (tags.all_.back().Is("AppendedData")) return tags;
          tag.clear();
        } else if (tag.push_back(c); tag.size() > kLongestTag || tags.all_.size() > kMostTags) {
          return BrokenVoxelFile(path, "the file is no XML with a header of common size");
        }
        if (at == kLongestTag && tags.First("VTKFile").text.empty())
          return Error{ErrorCode::kFormatUnknown, path + ": is not a file of VTK"};
      }
    if (tags.First("VTKFile").text.empty())
      return Error{ErrorCode::kFormatUnknown, path + ": is not a file of VTK"};
    return tags;
  }

  // The first tag of a name; one without text if there is none.
  const Tag& First(std::string_view name) const {
    static const Tag kNone;
    for (const Tag& tag : all_)
      if (tag.Is(name)) return tag;
    return kNone;
  }
  std::size_t Count(std::string_view name) const {
    std::size_t count = 0;
    for (const Tag& tag : all_) count += tag.Is(name) ? 1 : 0;
    return count;
  }
  // The arrays between a tag and its end.
  std::vector<Tag> ArraysIn(const std::string& name) const {
    std::vector<Tag> arrays;
    bool inside = false;
    for (const Tag& tag : all_) {
      if (tag.Is(name)) inside = !tag.text.ends_with('/');
      if (tag.Is("/" + name)) inside = false;
      if (inside && tag.Is("DataArray")) arrays.push_back(tag);
    }
    return arrays;
  }

 private:
  std::vector<Tag> all_;
};

std::optional<NumberType> TypeOf(const std::string& name) {
  static const std::map<std::string_view, NumberType> kTypes = {
      {"UInt8", NumberType::kUint8},   {"Int8", NumberType::kInt8},     {"UInt16", NumberType::kUint16},
      {"Int16", NumberType::kInt16},   {"UInt32", NumberType::kUint32}, {"Int32", NumberType::kInt32},
      {"UInt64", NumberType::kUint64}, {"Int64", NumberType::kInt64},   {"Float32", NumberType::kFloat},
      {"Float64", NumberType::kDouble}};
  const auto found = kTypes.find(name);
  if (found == kTypes.end()) return std::nullopt;
  return found->second;
}

// The arrays of a file.
class ImageReader {
 public:
  ImageReader(const std::string& path, Tags tags) : path_(path), tags_(std::move(tags)) {}

  // Chooses the arrays. Returns what is wrong, or nothing.
  std::optional<Error> Open() {
    const Tag& file = tags_.First("VTKFile");
    const std::string compressor = file["compressor"], order = file["byte_order"];
    if (file["type"] != "ImageData")
      return BrokenVoxelFile(path_,
                             "only VTK files of the type ImageData are read, not '" + file["type"] + "'");
    compressor_ = compressor;
    order_ = order == "BigEndian" ? std::endian::big : std::endian::little;
    length_type_ = file["header_type"] == "UInt64" ? NumberType::kUint64 : NumberType::kUint32;
    if (tags_.Count("Piece") != 1)
      return BrokenVoxelFile(
          path_, "only image data of one piece are read, not of " + std::to_string(tags_.Count("Piece")));
    const Tag& piece = tags_.First("Piece");
    if (std::sscanf(piece["Extent"].c_str(), " %lld %lld %lld %lld %lld %lld", extent_, extent_ + 1,
                    extent_ + 2, extent_ + 3, extent_ + 4, extent_ + 5) != 6)
      return BrokenVoxelFile(path_, "the image data have no extent");
    constexpr long long kMost = 1LL << 40;
    for (const long long end : extent_)
      if (end < -kMost || end > kMost) return BrokenVoxelFile(path_, "the extent is out of range");
    // Cells come first: points are samples between which there are cells.
    if (!Choose("CellData") && !Choose("PointData"))
      return BrokenVoxelFile(path_,
                             "the file has no array of numbers with one component for cells or points");
    return std::nullopt;
  }

  // The size in voxels: of cells, or of points as the centres of voxels.
  Result<VoxelPoint> Size() const {
    const long long more = points_ ? 1 : 0;
    return CheckVoxelSize(path_, extent_[1] - extent_[0] + more, extent_[3] - extent_[2] + more,
                          extent_[5] - extent_[4] + more);
  }
  const Tag& material() const { return material_; }
  const std::optional<Tag>& color() const { return color_; }
  NumberType material_type() const { return *TypeOf(material_["type"]); }

  // The numbers of an array.
  Result<NumberSource> Numbers(const Tag& array, std::uint64_t count) const {
    const std::string format = array["format"];
    if (format == "ascii") return NumberSource::FromText(FileRange(path_, array.content));
    if (!compressor_.empty() && compressor_ != "vtkZLibDataCompressor")
      return BrokenVoxelFile(path_, "VTK files with the compressor '" + compressor_ +
                                        "' are not read; vtkZLibDataCompressor is, and none");
    const NumberType type = *TypeOf(array["type"]);
    const std::uint64_t expected = count * BytesOf(type);
    Result<std::unique_ptr<ByteSource>> bytes = Bytes(array);
    if (!bytes.ok()) return bytes.error();
    NumberSource lengths(std::move(bytes).value(), length_type_, order_);
    const auto broken = [&] {
      return BrokenVoxelFile(path_, "the array '" + array["Name"] +
                                        "' is not in the file with a value for each of its " +
                                        std::to_string(count) + " voxels");
    };
    if (compressor_.empty()) {
      if (lengths.ReadLength() != expected) return broken();
      return NumberSource(std::move(lengths).Rest(), type, order_);
    }
    const auto blocks = lengths.ReadLength(), block = lengths.ReadLength(), last = lengths.ReadLength();
    if (!blocks || !block || !last || *blocks > expected + 1) return broken();
    for (std::uint64_t i = 0; i < *blocks; ++i)
      if (!lengths.ReadLength()) return broken();
    return NumberSource(Inflated(std::move(lengths).Rest()), type, order_);
  }

  void SetGrid(VoxelPoint size, VoxelFile& file) const {
    const Tag& image = tags_.First("ImageData");
    double o[3], s[3];
    if (std::sscanf(image["Origin"].c_str(), " %lf %lf %lf", o, o + 1, o + 2) != 3 ||
        std::sscanf(image["Spacing"].c_str(), " %lf %lf %lf", s, s + 1, s + 2) != 3)
      return;
    double d[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::sscanf(image["Direction"].c_str(), " %lf %lf %lf %lf %lf %lf %lf %lf %lf", d, d + 1, d + 2, d + 3,
                d + 4, d + 5, d + 6, d + 7, d + 8);
    const bool along_axes = d[0] == 1 && d[4] == 1 && d[8] == 1 && d[1] == 0 && d[2] == 0 && d[3] == 0 &&
                            d[5] == 0 && d[6] == 0 && d[7] == 0;
    if (!(s[0] > 0 && s[0] == s[1] && s[1] == s[2]) || !along_axes) {
      file.warnings.push_back(
          "the voxels of the file are not cubes along the axes, so they are read as if they were (Spacing: " +
          image["Spacing"] + ", Direction: " + image["Direction"] + ")");
      return;
    }
    if (!std::isfinite(s[0] + o[0] + o[1] + o[2])) return;
    const double half = points_ ? 0.5 : 0;
    const Vec3 low{double(extent_[0]) - half, double(extent_[2]) - half, double(extent_[4]) - half};
    file.grid = VoxelGrid{Vec3{o[0], o[1], o[2]} + s[0] * low, s[0], size};
  }

 private:
  bool Choose(const std::string& data) {
    const std::vector<Tag> arrays = tags_.ArraysIn(data);
    const auto components = [](const Tag& array) {
      return array["NumberOfComponents"].empty() ? "1" : array["NumberOfComponents"];
    };
    const std::string scalars = tags_.First(data)["Scalars"];
    int best = -1;
    for (const Tag& array : arrays) {
      if (components(array) == "3" && array["type"] == "UInt8" && !color_) color_ = array;
      if (components(array) != "1" || !TypeOf(array["type"])) continue;
      const int rank = array["Name"] == "material" ? 2 : !scalars.empty() && array["Name"] == scalars ? 1 : 0;
      if (rank > best) material_ = array;
      best = std::max(best, rank);
    }
    points_ = data == "PointData";
    if (best < 0) color_.reset();
    return best >= 0;
  }

  // The bytes of an array, its header first.
  Result<std::unique_ptr<ByteSource>> Bytes(const Tag& array) const {
    const std::string format = array["format"];
    if (format == "binary") return FromBase64(FileRange(path_, array.content));
    const Tag& appended = tags_.First("AppendedData");
    if (format != "appended" || appended.text.empty())
      return BrokenVoxelFile(
          path_, "the format '" + format + "' of an array is not read; ascii, binary and appended are");
    // The data begin behind an underscore.
    const std::unique_ptr<ByteSource> before = FileRange(path_, appended.content);
    std::uint64_t begin = appended.content;
    for (unsigned char c = ' '; c != '_'; ++begin)
      if (before->Read({&c, 1}) == 0 || (c != '_' && std::isspace(c) == 0))
        return BrokenVoxelFile(path_, "the appended data do not begin with an underscore");
    begin += std::strtoull(array["offset"].c_str(), nullptr, 10);
    const std::string encoding = appended["encoding"];
    if (encoding == "raw") return FileRange(path_, begin);
    if (encoding == "base64") return FromBase64(FileRange(path_, begin));
    return BrokenVoxelFile(
        path_, "the encoding '" + encoding + "' of appended data is not read; raw and base64 are");
  }

  const std::string path_;
  Tags tags_;
  std::string compressor_;
  bool points_ = false;
  std::endian order_ = std::endian::little;
  NumberType length_type_ = NumberType::kUint32;
  long long extent_[6] = {};
  Tag material_;
  std::optional<Tag> color_;
};

Result<VoxelFile> Read(const std::string& path, const VoxelFileOptions& options) {
  Result<Tags> tags = Tags::Of(path);
  if (!tags.ok()) return tags.error();
  ImageReader image(path, std::move(tags).value());
  if (const auto wrong = image.Open()) return *wrong;
  const Result<VoxelPoint> size = image.Size();
  if (!size.ok()) return size.error();
  Result<SliceCollector> slices = SliceCollector::Of(path, size.value(), 2, options);
  if (!slices.ok()) return slices.error();
  const std::uint64_t count = VoxelBox{{0, 0, 0}, size.value()}.volume();
  Result<NumberSource> material = image.Numbers(image.material(), count);
  if (!material.ok()) return material.error();
  std::optional<NumberSource> color;
  if (image.color()) {
    Result<NumberSource> source = image.Numbers(*image.color(), 3 * count);
    if (!source.ok()) return source.error();
    color = std::move(source).value();
  }
  std::vector<double> values(slices.value().shape().area()), colors(color ? 3 * values.size() : 0);
  std::vector<Voxel> slice(values.size());
  const bool whole = IsWhole(image.material_type());
  for (int z = 0; z < size.value().z; ++z) {
    if (!material.value().Read(values) || (color && !color->Read(colors)))
      return BrokenVoxelFile(path, "the voxels end too early, or are damaged, in slice " + std::to_string(z) +
                                       " of " + std::to_string(size.value().z));
    for (std::size_t i = 0; i < values.size(); ++i) {
      slice[i] = VoxelOfNumber(values[i], whole, options.threshold);
      const auto channel = [&](std::size_t k) { return static_cast<std::uint8_t>(colors[3 * i + k]); };
      if (slice[i].filled() && color)
        slice[i] = Voxel::Of(channel(0), channel(1), channel(2), slice[i].material());
    }
    if (auto added = slices.value().Add(slice); !added.ok()) return added.error();
  }
  VoxelFile file{std::make_unique<RunModel>(slices.value().Take()), std::nullopt};
  image.SetGrid(size.value(), file);
  return file;
}

}  // namespace

std::string VtiBeginning(const VoxelGrid& grid, const char* scalars, std::span<const VtiArray> arrays) {
  const VoxelPoint n = grid.size;
  const std::string extent = "0 " + std::to_string(n.x) + " 0 " + std::to_string(n.y) + " 0 " +
                             std::to_string(n.z),
                    pitch = PreciseText(grid.pitch);
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<ImageData WholeExtent=\"" +
      extent + "\" Origin=\"" + PreciseText(grid.origin.x) + " " + PreciseText(grid.origin.y) + " " +
      PreciseText(grid.origin.z) + "\" Spacing=\"" + pitch + " " + pitch + " " + pitch +
      "\">\n<Piece Extent=\"" + extent + "\">\n<CellData Scalars=\"" + scalars + "\">\n";
  const std::uint64_t count = VoxelBox{{0, 0, 0}, n}.volume();
  std::uint64_t offset = 0;
  for (const VtiArray& array : arrays) {
    text += std::string("<DataArray type=\"") + array.type + "\" Name=\"" + array.name +
            "\" NumberOfComponents=\"" + std::to_string(array.components) +
            "\" format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
    offset += sizeof(std::uint64_t) + array.voxel_bytes * count;
  }
  return text + "</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_";
}

Result<void> WriteVtiColors(const VoxelModel& model, const std::atomic<bool>* cancel, VoxelFileWriter* out) {
  const std::uint64_t count = model.box().volume();
  std::string bytes;
  out->Number(kVtiMaterial.voxel_bytes * count);
  auto visited = VisitSlices(model, 2, cancel, [&](int, std::span<const Voxel> slice) {
    bytes.clear();
    for (const Voxel& voxel : slice) bytes.push_back(static_cast<char>(voxel.material()));
    out->Text(bytes);
    return out->Checked();
  });
  if (!visited.ok()) return visited;
  out->Number(kVtiColor.voxel_bytes * count);
  return VisitSlices(model, 2, cancel, [&](int, std::span<const Voxel> slice) {
    bytes.clear();
    for (const Voxel& voxel : slice)
      for (const std::uint8_t channel : {voxel.red(), voxel.green(), voxel.blue()})
        bytes.push_back(static_cast<char>(channel));
    out->Text(bytes);
    return out->Checked();
  });
}

VoxelFormat VtiFormat() {
  return {".vti", "VTK image data", "", Write, Read};
}

}  // namespace facetless
