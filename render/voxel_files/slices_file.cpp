// Slices as the pages of a TIFF file, and as a folder of PNG or TIFF files.
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "render/image/io.h"
#include "render/image/slice_pictures.h"
#include "render/voxel_files/dense_slices.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/grid_header.h"
#include "render/voxel_files/natural_names.h"
#include "render/voxel_files/voxel_formats.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kFormat = "facetless-slices";
constexpr const char* kFolderHeader = "slices.json";
constexpr const char* kAxes = "xyz";

std::string HeaderText(VoxelPoint size, const VoxelGrid& grid, int axis) {
  Json json = GridHeader(kFormat, size, grid);
  json["axis"] = std::string(1, kAxes[axis]);
  json["order"] = "the earlier axis to the right, the later one downwards";
  return json.dump(1) + "\n";
}

// Makes the picture of a slice.
void Draw(std::span<const Voxel> slice, Image8& image) {
  std::uint8_t* to = image.bytes.data();
  for (const Voxel& voxel : slice)
    for (const std::uint8_t channel :
         {voxel.red(), voxel.green(), voxel.blue(), std::uint8_t(voxel.filled() ? 255 : 0)})
      *to++ = channel;
}

Image8 PictureOf(const SliceShape& shape) {
  return {shape.width, shape.height, 4, std::vector<std::uint8_t>(4 * shape.area())};
}

// The axis and the grid of slices, from the header beside them and the options.
struct Layout {
  int axis = 2;
  Json header;  // null: there is none

  static Result<Layout> Of(const std::string& header_path, const VoxelFileOptions& options) {
    Layout layout;
    std::error_code failed;
    if (fs::exists(header_path, failed)) {
      Result<Json> header = ReadGridHeader(header_path, kFormat);
      if (!header.ok()) return header.error();
      const Json axis = header.value().value("axis", Json());
      const std::size_t found = axis.is_string() && axis.get<std::string>().size() == 1
                                    ? std::string_view(kAxes).find(axis.get<std::string>())
                                    : std::string_view::npos;
      if (found == std::string_view::npos) return BrokenVoxelFile(header_path, "the axis must be x, y or z");
      layout = {static_cast<int>(found), std::move(header).value()};
    } else if (options.slice_axis) {
      // Only without a header: a conversion between slices across two axes needs both.
      layout.axis = *options.slice_axis;
    }
    return layout;
  }

  // Compares the size of the slices with that in the header.
  Result<void> Check(const std::string& header_path, VoxelPoint size) const {
    if (header.is_null()) return {};
    const Result<VoxelPoint> stated = SizeOfHeader(header_path, header);
    if (!stated.ok()) return stated.error();
    if (stated.value() == size) return {};
    return Error{ErrorCode::kSizeMismatch,
                 header_path + ": the header is that of " + std::to_string(stated.value().x) + " × " +
                     std::to_string(stated.value().y) + " × " + std::to_string(stated.value().z) +
                     " voxels, but the slices make " + std::to_string(size.x) + " × " +
                     std::to_string(size.y) + " × " + std::to_string(size.z) +
                     "; remove the header if the slices were changed, or add the missing slices"};
  }
};

// Makes a model of `count` slices, which next(index) returns one after the other, with the names that name(index) gives.
template <typename Next, typename Name>
Result<VoxelFile> Collect(const std::string& path, const std::string& header_path, int count,
                          const Next& next, const Name& name, const VoxelFileOptions& options) {
  const Result<Layout> layout = Layout::Of(header_path, options);
  if (!layout.ok()) return layout.error();
  std::optional<SliceCollector> slices;
  std::vector<Voxel> voxels;
  VoxelPoint size;
  for (int index = 0; index < count; ++index) {
    const Result<Image8> image = next(index);
    if (!image.ok()) return image.error();
    const SliceShape shape{image.value().width, image.value().height, count};
    if (index == 0) {
      size = SizeOfSlices(shape, layout.value().axis);
      if (auto checked = layout.value().Check(header_path, size); !checked.ok()) return checked.error();
      Result<SliceCollector> made = SliceCollector::Of(path, size, layout.value().axis, options);
      if (!made.ok()) return made.error();
      slices = std::move(made).value();
      voxels.resize(shape.area());
    } else if (shape.width != slices->shape().width || shape.height != slices->shape().height) {
      return Error{ErrorCode::kSizeMismatch,
                   name(index) + ": has " + std::to_string(shape.width) + " × " +
                       std::to_string(shape.height) + " pixels, but the slices before it have " +
                       std::to_string(slices->shape().width) + " × " +
                       std::to_string(slices->shape().height) + "; all slices must have the same size"};
    }
    const std::uint8_t* from = image.value().bytes.data();
    for (Voxel& voxel : voxels) {
      voxel = from[3] == 0 ? Voxel{} : Voxel::Of(from[0], from[1], from[2]);
      from += 4;
    }
    if (auto added = slices->Add(voxels); !added.ok()) return added.error();
  }
  return VoxelFile{std::make_unique<RunModel>(slices->Take()), GridOfHeader(layout.value().header, size)};
}

Result<void> WriteTiff(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                       const VoxelFileOptions& options) {
  const int axis = options.slice_axis.value_or(2);
  Result<TiffPageWriter> pages = TiffPageWriter::Open(path, static_cast<double>(model.box().volume()));
  if (!pages.ok()) return pages.error();
  VoxelFileWriter header(path + ".json");
  header.Text(HeaderText(model.size(), grid, axis));
  Image8 image = PictureOf(ShapeOfSlices(model.size(), axis));
  auto visited = VisitSlices(model, axis, options.cancel, [&](int, std::span<const Voxel> slice) {
    Draw(slice, image);
    return pages.value().Add(image);
  });
  if (!visited.ok()) return visited;
  if (auto written = pages.value().Finish(); !written.ok()) return written;
  return header.Finish();
}

Result<VoxelFile> ReadTiff(const std::string& path, const VoxelFileOptions& options) {
  Result<TiffPages> pages = TiffPages::Open(path, options.max_bytes);
  if (!pages.ok()) return pages.error();
  return Collect(
      path, path + ".json", pages.value().count(),
      [&](int) { return pages.value().Next(options.threshold, options.max_bytes); },
      [&](int page) { return path + ": page " + std::to_string(page + 1); }, options);
}

// A folder that is made under another name, and gets its own when it is complete.
class FolderInTheMaking {
 public:
  explicit FolderInTheMaking(const std::string& path)
      : path_(path), partial_(path + ".partial-" + std::to_string(::getpid())) {}
  ~FolderInTheMaking() {
    std::error_code failed;
    if (!finished_) fs::remove_all(partial_, failed);
  }
  FolderInTheMaking(const FolderInTheMaking&) = delete;
  FolderInTheMaking& operator=(const FolderInTheMaking&) = delete;

  Result<void> Make() {
    std::error_code failed;
    if (fs::exists(path_, failed) && (!fs::is_directory(path_, failed) || !fs::is_empty(path_, failed)))
      return Error{ErrorCode::kBadUsage, path_ +
                                             "/: the folder is not empty; name a new one, so that the slices "
                                             "in it are those of one model"};
    if (!fs::create_directory(partial_, failed)) return Failed(failed);
    return {};
  }
  Result<void> Finish() {
    std::error_code failed;
    fs::rename(partial_, path_, failed);
    if (failed) return Failed(failed);
    finished_ = true;
    return {};
  }
  std::string File(const std::string& name) const { return partial_ + "/" + name; }

 private:
  Error Failed(const std::error_code& reason) const {
    return {ErrorCode::kWriteFailed, path_ + "/: cannot be written: " + reason.message()};
  }

  const std::string path_, partial_;
  bool finished_ = false;
};

// The path of a folder without the slashes at its end.
std::string Trimmed(std::string path) {
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path;
}

Result<void> WriteFolder(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                         const VoxelFileOptions& options) {
  const int axis = options.slice_axis.value_or(2);
  FolderInTheMaking folder(Trimmed(path));
  if (auto made = folder.Make(); !made.ok()) return made;
  const SliceShape shape = ShapeOfSlices(model.size(), axis);
  constexpr std::size_t kDigits = 4;
  const std::size_t digits = std::max(kDigits, std::to_string(shape.count).size());
  Image8 image = PictureOf(shape);
  auto visited = VisitSlices(model, axis, options.cancel, [&](int index, std::span<const Voxel> slice) {
    Draw(slice, image);
    const std::string number = std::to_string(index + 1);
    return WritePng(folder.File("slice_" + std::string(digits - number.size(), '0') + number + ".png"),
                    image);
  });
  if (!visited.ok()) return visited;
  VoxelFileWriter header(folder.File(kFolderHeader));
  header.Text(HeaderText(model.size(), grid, axis));
  if (auto written = header.Finish(); !written.ok()) return written;
  return folder.Finish();
}

// The names of the slices in a folder, in order. Errors: kFileUnreadable, kNothingUsable, kFormatBroken.
Result<std::vector<std::string>> SlicesIn(const std::string& folder) {
  std::error_code failed;
  std::vector<std::string> names, others;
  bool png = false, tiff = false;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    std::string name = at->path().filename().string(), suffix = at->path().extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (name.starts_with('.')) continue;
    png = png || suffix == ".png";
    tiff = tiff || suffix == ".tif" || suffix == ".tiff";
    if (suffix == ".png" || suffix == ".tif" || suffix == ".tiff") {
      names.push_back(std::move(name));
    } else if (suffix == ".jpg" || suffix == ".jpeg" || suffix == ".bmp" || suffix == ".dcm" ||
               suffix == ".gif") {
      others.push_back(std::move(name));
    }
    if (names.size() > static_cast<std::size_t>(kMostVoxelsPerAxis))
      return Error{ErrorCode::kLimitExceeded, folder + "/: has more than 65536 slices; use fewer"};
  }
  if (failed) return Error{ErrorCode::kFileUnreadable, folder + "/: " + failed.message()};
  if (!others.empty())
    return Error{ErrorCode::kFormatUnknown,
                 folder + "/" + *std::min_element(others.begin(), others.end()) +
                     ": slices are read from PNG and TIFF files only; convert the others, or remove them"};
  if (names.empty())
    return Error{ErrorCode::kNothingUsable,
                 folder + "/: the folder has no slices, which would be PNG or TIFF files"};
  if (png && tiff)
    return BrokenVoxelFile(folder + "/",
                           "the folder has both PNG and TIFF files; slices must be of one kind");
  std::sort(names.begin(), names.end(), NaturallyBefore);
  if (const std::string missing = MissingName(names); !missing.empty())
    return BrokenVoxelFile(folder + "/" + missing,
                           "the slice is missing; add it, or rename the slices so that their numbers follow "
                           "one another");
  return names;
}

Result<VoxelFile> ReadFolder(const std::string& path, const VoxelFileOptions& options) {
  const std::string folder = Trimmed(path);
  const Result<std::vector<std::string>> names = SlicesIn(folder);
  if (!names.ok()) return names.error();
  const auto name = [&](int index) { return folder + "/" + names.value()[static_cast<std::size_t>(index)]; };
  return Collect(
      folder + "/", folder + "/" + kFolderHeader, static_cast<int>(names.value().size()),
      [&](int index) -> Result<Image8> {
        const std::string file = name(index);
        const char last = static_cast<char>(std::tolower(static_cast<unsigned char>(file.back())));
        if (last == 'g') return ReadPngSlice(file, options.threshold, options.max_bytes);
        Result<TiffPages> pages = TiffPages::Open(file, options.max_bytes);
        if (!pages.ok()) return pages.error();
        if (pages.value().count() != 1)
          return BrokenVoxelFile(file, "has " + std::to_string(pages.value().count()) +
                                           " pages; the slices of a folder have one each");
        return pages.value().Next(options.threshold, options.max_bytes);
      },
      name, options);
}

constexpr const char* kLoses =
    "Slices hold the colours of voxels, but no materials; their grid is in a header beside them, which other "
    "programs do not read.";

}  // namespace

VoxelFormat TiffFormat() {
  return {".tif", "TIFF slices", kLoses, WriteTiff, ReadTiff, ".tiff"};
}

VoxelFormat SliceFolderFormat() {
  return {"/", "folder of slices", kLoses, WriteFolder, ReadFolder};
}

}  // namespace facetless
