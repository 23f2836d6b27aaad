#include "server/run/voxel_render.h"

#include <algorithm>
#include <filesystem>

#include "render/base/stopwatch.h"
#include "render/compare/report.h"
#include "render/image/io.h"
#include "render/view/refinement.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_file.h"
#include "render/voxel_walks/voxel_picture.h"
#include "render/voxels/octree_model.h"
#include "server/base/interrupt.h"
#include "server/base/version.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The options of render that voxel files take, and those that only they take.
constexpr std::string_view kTaken[] = {"view", "camera",  "size",       "projection",  "margin",
                                       "up",   "samples", "threads",    "timeout",     "max_view_memory",
                                       "walk", "ambient", "background", "point_light", "side_normals"},
                           kOwn[] = {"walk", "ambient", "point_light", "side_normals"};

bool Has(std::span<const std::string_view> names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Json CountersJson(const WalkCounters& counters) {
  return {{"rays", counters.rays}, {"steps", counters.steps}, {"nodes", counters.nodes}};
}

Json LightsJson(const VoxelPictureOptions& options) {
  Json points = Json::array();
  for (const PointLight& light : options.lights)
    points.push_back({{"at_mm", {light.at.x, light.at.y, light.at.z}},
                      {"color", {light.color.x, light.color.y, light.color.z}}});
  return {{"ambient", options.ambient}, {"points", points}};
}

// The model of a file in the encoding of a walk.
struct Loaded {
  std::unique_ptr<const VoxelModel> model;
  VoxelGrid grid;
  bool placed = false;  // whether the file says where the voxels are
  double read_ms = 0, convert_ms = 0;
};

Result<Loaded> Load(const std::string& file, std::string_view encoding, const VoxelFileOptions& options) {
  const std::uint64_t max_bytes = options.max_bytes;
  Loaded loaded;
  const Stopwatch reading;
  Result<VoxelFile> read = ReadVoxels(file, options);
  if (!read) return read.error();
  loaded.read_ms = reading.Milliseconds();
  const Stopwatch converting;
  loaded.model = std::move(read.value().model);
  loaded.placed = read.value().grid.has_value();
  loaded.grid = read.value().grid.value_or(VoxelGrid{{0, 0, 0}, 1, loaded.model->size()});
  if (loaded.model->encoding() != encoding) {
    // A conversion goes through the columns.
    const std::uint64_t columns =
        static_cast<std::uint64_t>(loaded.grid.size.x) * static_cast<std::uint64_t>(loaded.grid.size.y);
    if (columns > max_bytes / sizeof(std::uint32_t))
      return Error{ErrorCode::kLimitExceeded, file + ": " + std::to_string(columns) +
                                                  " columns of voxels need more memory than allowed; use "
                                                  "--max-view-memory to allow more, or a walk through " +
                                                  std::string(loaded.model->encoding())};
    auto converted = Converted(*loaded.model, encoding, max_bytes);
    if (!converted) return converted.error();
    loaded.model = std::move(converted).value();
  }
  loaded.convert_ms = converting.Milliseconds();
  return loaded;
}

// Grows a box by the filled leaves below a node of an octree.
void AddFilled(const OctreeModel& model, const OctreeNode& node, const VoxelCube& cube, VoxelBox* box) {
  const VoxelBox bounds = cube.box();
  const bool inside = !box->empty() && Intersection(bounds, *box).volume() == cube.volume();
  if (!node.voxel.filled() || inside) return;
  if (!node.leaf()) {
    for (int child = 0; child < 8; ++child)
      AddFilled(model, model.Children(node)[child], cube.Child(child), box);
    return;
  }
  if (box->empty()) *box = bounds;
  box->low = {std::min(box->low.x, bounds.low.x), std::min(box->low.y, bounds.low.y),
              std::min(box->low.z, bounds.low.z)};
  box->high = {std::max(box->high.x, bounds.high.x), std::max(box->high.y, bounds.high.y),
               std::max(box->high.z, bounds.high.z)};
}

// The box of the filled voxels; that of the grid, if there are none. An octree may have too many
// columns to visit each.
Box3 FilledBounds(const VoxelModel& model, const VoxelGrid& grid) {
  VoxelBox box;
  if (const auto* octree = dynamic_cast<const OctreeModel*>(&model)) {
    AddFilled(*octree, octree->root(), {{0, 0, 0}, octree->level()}, &box);
    return box.empty() ? grid.bounds() : Box3{grid.Corner(box.low), grid.Corner(box.high)};
  }
  Box3 bounds;
  for (int x = 0; x < grid.size.x; ++x)
    for (int y = 0; y < grid.size.y; ++y)
      model.VisitColumn(x, y, [&](const VoxelRun& run) {
        bounds.Add(grid.Corner({x, y, run.z_begin}));
        bounds.Add(grid.Corner({x + 1, y + 1, run.z_end}));
      });
  return bounds.empty() ? grid.bounds() : bounds;
}

Json VoxelsJson(const Loaded& loaded) {
  const VoxelGrid& grid = loaded.grid;
  return {{"encoding", loaded.model->encoding()},
          {"size", {grid.size.x, grid.size.y, grid.size.z}},
          {"pitch_mm", grid.pitch},
          {"origin_mm", {grid.origin.x, grid.origin.y, grid.origin.z}},
          {"placed", loaded.placed},
          {"filled", loaded.model->Count()},
          {"bytes", loaded.model->bytes()}};
}

}  // namespace

Result<void> CheckRenderOptions(const std::vector<std::string>& given, bool voxels) {
  for (const std::string& name : given) {
    if (voxels ? Has(kTaken, name) : !Has(kOwn, name)) continue;
    return Error{ErrorCode::kBadUsage, name + (voxels ? ": pictures of voxel files do not have this option; "
                                                        "docs/cli.md lists those that they have"
                                                      : ": only pictures of voxel files have this option")};
  }
  return {};
}

Result<Json> RunVoxelRender(const std::string& file, const RunOptions& options, const std::string& path,
                            const RunContext& context) {
  if (std::filesystem::path(path).extension() != ".png")
    return Error{
        ErrorCode::kBadUsage,
        "--out " + path + ": the picture of a voxel file is a .png file; name one, such as picture.png"};
  const VoxelPictureRunOptions& asked = options.voxel_picture;
  std::string_view encoding = "octree";
  if (!asked.walk.empty()) {
    const auto walk = FindVoxelWalk(std::string_view(asked.walk).substr(0, asked.walk.find(':')));
    if (!walk) return walk.error();
    encoding = walk.value()->encoding;
  }
  const double timeout_s = options.timeout_s.value_or(kRunTimeoutS);
  const Deadline deadline(timeout_s, context.execution.cancel);
  const Execution execution = context.execution.WithFlag(deadline.flag());
  if (context.progress) context.progress("read", 0);
  const auto failed = [&](const Error& error) {
    if (error.code != ErrorCode::kCancelled || !deadline.expired()) return error;
    return Error{ErrorCode::kLimitExceeded, file + ": the picture took longer than " +
                                                PreciseText(timeout_s) +
                                                " s; use --timeout to allow more time"};
  };
  const Result<Loaded> loaded =
      Load(file, encoding, {.max_bytes = options.accuracy.max_bytes, .cancel = deadline.flag()});
  if (!loaded) return failed(loaded.error());
  const VoxelModel& model = *loaded.value().model;
  const VoxelGrid& grid = loaded.value().grid;
  const auto cameras = ResolveCameras(options, FilledBounds(model, grid));
  if (!cameras) return cameras.error();
  if (cameras.value().size() != 1)
    return Error{
        ErrorCode::kBadUsage,
        "view: a voxel file is rendered to one picture, from one view; give one --view or one --camera"};
  const Camera& camera = cameras.value().front();
  const auto frame = MakeFrame(camera, grid.bounds().diagonal());
  if (!frame) return frame.error();

  const SampleGrid samples = EvenSampleGrid(options.samples);
  VoxelPictureOptions look;
  look.walk = asked.walk;
  look.ambient = asked.ambient.value_or(look.ambient);
  look.lights = asked.lights;
  if (look.lights.empty()) look.lights.push_back(LightBesideEye(frame.value(), grid));
  look.grid_normals = !asked.side_normals;
  look.background = options.background;
  look.samples_x = samples.x;
  look.samples_y = samples.y;
  if (context.progress) context.progress("trace", 0);
  const Result<VoxelPicture> picture = RenderVoxelPicture(model, grid, camera, look, execution);
  if (!picture) return failed(picture.error());
  const Stopwatch writing;
  const Result<Image8> image = Encode(picture.value().film);
  if (!image) return image.error();
  if (const auto written = WritePng(path, image.value()); !written) return written.error();

  const VoxelPicture& made = picture.value();
  Json primary = CountersJson(made.primary);
  primary["hits"] = made.hits;
  return Json{{"facetless", ProgramJson(execution.threads)},
              {"command", "render"},
              {"file", file},
              {"picture", path},
              {"camera", CameraJson(camera)},
              {"samples", options.samples},
              {"voxels", VoxelsJson(loaded.value())},
              {"walk", asked.walk.empty() ? "octree, tile by tile" : asked.walk},
              {"side_bytes", made.side_bytes},
              {"light", LightsJson(look)},
              {"normals", look.grid_normals ? "grid" : "side"},
              {"rays", {{"primary", primary}, {"shadow", CountersJson(made.shadow)}}},
              {"timing_ms",
               {{"read", loaded.value().read_ms},
                {"convert", loaded.value().convert_ms},
                {"bind", made.bind_ms},
                {"trace", made.trace_ms},
                {"write", writing.Milliseconds()}}}};
}

}  // namespace facetless
