#include "server/run/bench_openvdb.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "render/base/stopwatch.h"

#include "render/view/camera.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_file.h"
#include "render/voxel_walks/voxel_camera.h"
#include "render/voxels/voxelize.h"
#include "server/base/files.h"
#include "server/importer/openvdb_process.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr double kDeflection = 1e-3;
constexpr int kPixels = 512, kPasses = 3;

// Our side: the voxels, and the times of making them.
struct Ours {
  VoxelGrid grid;
  RunModel runs{VoxelPoint{1, 1, 1}};
  std::unique_ptr<VoxelModel> octree;
  VoxelStats stats;
  double runs_ms = 0, octree_ms = 0;
};

double MedianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Result<Ours> MakeOurs(const Model& model, const RunOptions& options, int repeats, int resolution,
                      const Execution& execution) {
  const Result<VoxelGrid> grid = GridOfResolution(model.bounds, resolution);
  if (!grid) return grid.error();
  Ours ours;
  ours.grid = grid.value();
  std::vector<double> runs_ms, octree_ms;
  for (int i = 0; i < repeats + 1; ++i) {
    const Stopwatch voxelizing;
    const Scene scene(model);
    Result<Voxels> voxels = Voxelize(scene, grid.value(), {.accuracy = options.accuracy}, execution);
    if (!voxels) return voxels.error();
    runs_ms.push_back(voxelizing.Milliseconds());
    const Stopwatch compiling;
    Result<std::unique_ptr<VoxelModel>> octree = Converted(voxels.value().model, "octree");
    if (!octree) return octree.error();
    octree_ms.push_back(compiling.Milliseconds());
    ours.stats = voxels.value().stats;
    ours.runs = std::move(voxels.value().model);
    ours.octree = std::move(octree).value();
  }
  // The first run warms up.
  ours.runs_ms = MedianOf({runs_ms.begin() + 1, runs_ms.end()});
  ours.octree_ms = MedianOf({octree_ms.begin() + 1, octree_ms.end()});
  return ours;
}

// Writes the triangles of all placements, as openvdb/measure.h describes. Returns how many there are.
Result<std::uint64_t> WriteTriangles(const std::string& path, const Mesh& mesh) {
  std::uint64_t points = 0, triangles = 0;
  for (const MeshNode& node : mesh.nodes) {
    points += mesh.parts[node.part].positions.size();
    triangles += mesh.parts[node.part].triangles.size();
  }
  VoxelFileWriter out(path);
  out.Number(points);
  out.Number(triangles);
  for (const MeshNode& node : mesh.nodes)
    for (const auto& p : mesh.parts[node.part].positions) {
      const Vec3 at = node.placement.Point({p[0], p[1], p[2]});
      for (const double number : {at.x, at.y, at.z}) out.Number(static_cast<float>(number));
    }
  std::uint32_t first = 0;
  for (const MeshNode& node : mesh.nodes) {
    for (const auto& corners : mesh.parts[node.part].triangles)
      for (const std::uint32_t corner : corners) out.Number(first + corner);
    first += static_cast<std::uint32_t>(mesh.parts[node.part].positions.size());
  }
  if (auto written = out.Finish(); !written) return written.error();
  return triangles;
}

struct BenchRays {
  std::vector<std::array<double, 6>> rays;  // in the coordinates of the voxels, of length 1
};

Result<BenchRays> RaysOf(const Model& model, const VoxelGrid& grid) {
  const Result<Camera> camera = NamedView("iso", model.bounds, Projection::kOrthographic, kPixels, kPixels);
  if (!camera) return camera.error();
  const Result<CameraFrame> frame = MakeFrame(camera.value(), model.Diagonal());
  if (!frame) return frame.error();
  const VoxelCamera voxel_camera(frame.value(), grid, kPixels, kPixels);
  BenchRays made;
  for (int row = 0; row < kPixels; ++row)
    for (int column = 0; column < kPixels; ++column) {
      const Ray line = PixelRay(frame.value(), column + 0.5, row + 0.5);
      const Vec3 origin =
                     (1 / grid.pitch) * (line.origin + voxel_camera.before * line.direction - grid.origin),
                 direction = (1 / Length(line.direction)) * line.direction;
      made.rays.push_back({origin.x, origin.y, origin.z, direction.x, direction.y, direction.z});
    }
  return made;
}

Result<void> WriteRays(const std::string& path, const BenchRays& rays) {
  VoxelFileWriter out(path);
  out.Number(std::uint64_t{rays.rays.size()});
  for (const auto& ray : rays.rays)
    for (const double number : ray) out.Number(number);
  return out.Finish();
}

// Our walk through the octree on one thread: the best time of some passes, and where the rays enter the first voxel.
double WalkMs(const BoundWalk& walk, VoxelPoint size, const BenchRays& rays, std::vector<double>& depths) {
  double best = INFINITY;
  depths.assign(rays.rays.size(), INFINITY);
  for (int pass = 0; pass < kPasses; ++pass) {
    const Stopwatch stopwatch;
    WalkCounters counters;
    for (std::size_t i = 0; i < rays.rays.size(); ++i) {
      const auto& r = rays.rays[i];
      VoxelRay ray;
      if (ray.Enter({r[0], r[1], r[2]}, {r[3], r[4], r[5]}, 0, size))
        depths[i] = walk.Walk(ray, {}, &counters).t;
    }
    best = std::min(best, stopwatch.Milliseconds());
  }
  return best;
}

// Voxels that only one of two models fills.
struct VoxelDifference {
  std::uint64_t only_ours = 0, only_theirs = 0;
  std::uint64_t all() const { return only_ours + only_theirs; }
};

VoxelDifference CompareVoxels(const RunModel& ours, const VoxelModel& theirs) {
  VoxelDifference difference;
  const VoxelPoint n = ours.size();
  std::vector<bool> filled(static_cast<std::size_t>(n.z));
  for (int x = 0; x < n.x; ++x)
    for (int y = 0; y < n.y; ++y) {
      std::fill(filled.begin(), filled.end(), false);
      std::uint64_t in_ours = 0, in_both = 0, in_theirs = 0;
      for (const VoxelRun& run : ours.Column(x, y))
        for (int z = run.z_begin; z < run.z_end; ++z, ++in_ours) filled[static_cast<std::size_t>(z)] = true;
      theirs.VisitColumn(x, y, [&](const VoxelRun& run) {
        for (int z = run.z_begin; z < run.z_end; ++z, ++in_theirs)
          in_both += filled[static_cast<std::size_t>(z)] ? 1 : 0;
      });
      difference.only_ours += in_ours - in_both;
      difference.only_theirs += in_theirs - in_both;
    }
  return difference;
}

// The rays whose hits differ by more than rounding.
std::uint64_t DifferentHits(const std::vector<double>& a, const std::string& b) {
  constexpr double kSame = 1e-5;  // of a voxel
  std::uint64_t different = 0;
  for (std::size_t i = 0; i < a.size() && (i + 1) * sizeof(double) <= b.size(); ++i) {
    double t = 0;
    std::memcpy(&t, b.data() + i * sizeof t, sizeof t);
    if (std::isfinite(a[i]) != std::isfinite(t) || (std::isfinite(t) && !(std::abs(a[i] - t) <= kSame)))
      ++different;
  }
  return different;
}

std::string Count(std::uint64_t n) {
  return std::to_string(n);
}

Table MakingTable(const std::string& name, const Ours& ours, const Mesh& mesh, std::uint64_t triangles,
                  const Json& answer, const VoxelDifference& difference, std::uint64_t wrong) {
  Table table{"Voxels of " + name + ", " +
                  std::to_string(std::max({ours.grid.size.x, ours.grid.size.y, ours.grid.size.z})) +
                  " along the longest side",
              {"", "time", "memory", "voxels inside"},
              {},
              {}};
  table.rows.push_back({"exact solid to runs", MillisecondsText(ours.runs_ms),
                        BytesText(static_cast<double>(ours.stats.peak_bytes + ours.runs.bytes())),
                        Count(ours.runs.Count())});
  table.rows.push_back({"runs to octree", MillisecondsText(ours.octree_ms),
                        BytesText(static_cast<double>(ours.octree->bytes())), Count(ours.octree->Count())});
  table.rows.push_back(
      {"tessellation at 1e-3, " + Count(triangles) + " triangles", MillisecondsText(mesh.mesh_ms), "", ""});
  double narrowest = INFINITY;
  for (const Json& band : answer.at("bands")) {
    const double ms = band.at("convert_ms").get<double>(), runs_ms = band.at("runs_ms").get<double>();
    const std::string width = ThreeDigits(band.at("half_width").get<double>());
    table.rows.push_back({"meshToVolume, band of " + width + " voxels", MillisecondsText(ms),
                          BytesText(band.at("peak_bytes").get<double>()),
                          Count(band.at("inside").get<std::uint64_t>())});
    table.rows.push_back({"its voxels below 0 to runs", MillisecondsText(runs_ms), "", ""});
    narrowest = std::min(narrowest, mesh.mesh_ms + ms + runs_ms);
  }
  table.rows.push_back({"mesh, then OpenVDB, in all", MillisecondsText(narrowest), "", ""});
  table.notes.push_back("The mesh and OpenVDB fill " + Count(difference.only_theirs) +
                        " voxels that ours leave empty, and leave " + Count(difference.only_ours) +
                        " empty that ours fill. Of all our voxels, " + Count(ours.stats.not_certified) +
                        " centres are not proven, so at least " + Count(wrong) +
                        " of the differences are errors of the mesh or of OpenVDB.");
  return table;
}

Table RaysTable(const std::string& name, std::string_view walk, double walk_ms,
                const std::vector<double>& depths, const Json& answer, std::uint64_t different) {
  Table table{"Rays into " + name + ", 512 × 512 pixels, one thread", {"", "rays", "hits"}, {}, {}};
  const auto rays = static_cast<double>(depths.size());
  const auto hits = std::count_if(depths.begin(), depths.end(), [](double t) { return std::isfinite(t); });
  table.rows.push_back({"octree, " + std::string(walk), RateText(1000 * rays / walk_ms),
                        Count(static_cast<std::uint64_t>(hits))});
  for (const auto& [key, title] : {std::pair{"volume", "OpenVDB's VolumeRayIntersector, the same voxels"},
                                   {"level_set", "OpenVDB's LevelSetRayIntersector, the mesh"}}) {
    const Json& side = answer.at(key);
    table.rows.push_back({title, RateText(1e6 * side.at("mrays_per_s").get<double>()),
                          Count(side.at("hits").get<std::uint64_t>())});
  }
  table.notes.push_back(Count(different) +
                        " rays enter another voxel with VolumeRayIntersector than in the octree.");
  return table;
}

}  // namespace

Result<OpenVdbBench> MeasureOpenVdb(const std::string& file, const ImportRequest& request,
                                    const RunOptions& options, int repeats, const RunContext& context,
                                    int resolution) {
  if (!HasOpenVdb())
    return Error{
        ErrorCode::kBadUsage,
        "--openvdb: this build has no OpenVDB; install libopenvdb-dev and libboost-dev and build again"};
  ImportRequest import = request;
  import.input = file;
  import.meshes = {{.deflection = kDeflection }};
  const auto imported = Import(import);
  if (!imported) return imported.error();
  const Model& model = *imported.value().model;
  const Mesh& mesh = imported.value().meshes.at(0);
  const std::string name = std::filesystem::path(file).filename().string();
  const Result<Ours> ours = MakeOurs(model, options, repeats, resolution, context.execution);
  if (!ours) return ours.error();
  const VoxelGrid& grid = ours.value().grid;
  const Result<BenchRays> rays = RaysOf(model, grid);
  if (!rays) return rays.error();
  const auto walk = BindVoxelWalk(*ours.value().octree, "");
  if (!walk) return walk.error();
  std::vector<double> depths;
  const double walk_ms = WalkMs(*walk.value(), grid.size, rays.value(), depths);

  // Let OpenVDB do the same.
  const auto directory = TempDir::Create();
  if (!directory) return directory.error();
  const std::string voxels = directory.value().File("voxels.oct"), triangles = directory.value().File("mesh"),
                    ray_file = directory.value().File("rays"), out = directory.value().File("out");
  if (auto written = WriteVoxels(voxels, *ours.value().octree, grid); !written) return written.error();
  const Result<std::uint64_t> triangle_count = WriteTriangles(triangles, mesh);
  if (!triangle_count) return triangle_count.error();
  if (auto written = WriteRays(ray_file, rays.value()); !written) return written.error();
  const auto answer = RunOpenVdb({.input = voxels,
                                  .arguments = {"--measure", triangles, ray_file, out},
                                  .max_bytes = std::uint64_t{16} << 30,
                                  .execution = context.execution},
                                 directory.value());
  if (!answer) return answer.error();
  const Result<VoxelFile> theirs = ReadVoxels(out + ".oct", std::uint64_t{16} << 30);
  if (!theirs) return theirs.error();
  const Result<std::string> their_depths = ReadFile(out + ".depths", depths.size() * sizeof(double));
  if (!their_depths) return their_depths.error();

  const VoxelDifference difference = CompareVoxels(ours.value().runs, *theirs.value().model);
  const std::uint64_t unproven = ours.value().stats.not_certified,
                      wrong = difference.all() - std::min(difference.all(), unproven);
  const std::uint64_t different = DifferentHits(depths, their_depths.value());
  const std::string_view walk_name = UsualVoxelWalk("octree").name;
  OpenVdbBench bench;
  bench.tables = {
      MakingTable(name, ours.value(), mesh, triangle_count.value(), answer.value(), difference, wrong),
      RaysTable(name, walk_name, walk_ms, depths, answer.value(), different)};
  bench.json = {
      {"file", name},
      {"voxels", resolution},
      {"ours",
       {{"runs_ms", ours.value().runs_ms},
        {"octree_ms", ours.value().octree_ms},
        {"runs_bytes", ours.value().runs.bytes()},
        {"octree_bytes", ours.value().octree->bytes()},
        {"peak_bytes", ours.value().stats.peak_bytes + ours.value().runs.bytes()},
        {"inside", ours.value().runs.Count()},
        {"not_certified", unproven},
        {"walk", walk_name},
        {"walk_ms", walk_ms}}},
      {"mesh", {{"ms", mesh.mesh_ms}, {"triangles", triangle_count.value()}, {"deflection", kDeflection}}},
      {"openvdb", answer.value()},
      {"only_ours", difference.only_ours},
      {"only_theirs", difference.only_theirs},
      {"at_least_wrong", wrong},
      {"rays_that_differ", different}};
  return bench;
}

}  // namespace facetless
