#include "openvdb/measure.h"

#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/RayIntersector.h>
#include <sys/resource.h>

#include <cstring>
#include <limits>
#include <optional>

#include "openvdb/grid_runs.h"
#include "render/base/stopwatch.h"
#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_file.h"
#include "render/voxels/octree_model.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using Ray = openvdb::math::Ray<double>;

std::uint64_t PeakBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

struct Triangles {
  std::vector<openvdb::Vec3s> points;  // in the coordinates of the grid's indices
  std::vector<openvdb::Vec3I> triangles;
};

Result<Triangles> ReadTriangles(const std::string& path, const VoxelGrid& grid, std::uint64_t max_bytes) {
  const Result<std::vector<unsigned char>> bytes = ReadVoxelBytes(path, max_bytes);
  if (!bytes.ok()) return bytes.error();
  VoxelFileReader reader(bytes.value());
  std::uint64_t points = 0, triangles = 0;
  if (!reader.Number(&points) || !reader.Number(&triangles) || reader.left() != 12 * (points + triangles))
    return Error{ErrorCode::kFormatBroken, path + ": is no mesh of the bench"};
  Triangles mesh;
  for (std::uint64_t i = 0; i < points; ++i) {
    float p[3] = {};
    for (float& number : p) reader.Number(&number);
    const Vec3 at = (1 / grid.pitch) * (Vec3{p[0], p[1], p[2]} - grid.Center({0, 0, 0}));
    mesh.points.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z));
  }
  for (std::uint64_t i = 0; i < triangles; ++i) {
    std::uint32_t corners[3] = {};
    for (std::uint32_t& corner : corners) reader.Number(&corner);
    mesh.triangles.emplace_back(corners[0], corners[1], corners[2]);
  }
  return mesh;
}

Result<std::vector<Ray>> ReadRays(const std::string& path, std::uint64_t max_bytes) {
  const Result<std::vector<unsigned char>> bytes = ReadVoxelBytes(path, max_bytes);
  if (!bytes.ok()) return bytes.error();
  VoxelFileReader reader(bytes.value());
  std::uint64_t count = 0;
  if (!reader.Number(&count) || reader.left() != 48 * count)
    return Error{ErrorCode::kFormatBroken, path + ": has no rays of the bench"};
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < count; ++i) {
    double n[6] = {};
    for (double& number : n) reader.Number(&number);
    rays.emplace_back(openvdb::Vec3d(n[0], n[1], n[2]), openvdb::Vec3d(n[3], n[4], n[5]));
  }
  return rays;
}

// The voxels of a tree as an active volume.
openvdb::FloatGrid::Ptr VolumeOf(const OctreeModel& model) {
  auto grid = openvdb::FloatGrid::create(0);
  const auto fill = [&](const auto& self, const OctreeNode& node, const VoxelCube& cube) -> void {
    if (!node.leaf()) {
      for (int child = 0; child < 8; ++child) self(self, model.Children(node)[child], cube.Child(child));
    } else if (node.voxel.filled()) {
      const openvdb::Coord low(cube.low.x, cube.low.y, cube.low.z);
      grid->tree().fill(openvdb::CoordBBox::createCube(low, cube.edge()), 1);
    }
  };
  fill(fill, model.root(), {{0, 0, 0}, model.level()});
  // Leaves of equal voxels become tiles, through which rays go in one step.
  grid->tree().prune();
  return grid;
}

// Where a ray enters the first active voxel; infinity if it enters none.
class VolumeRays {
 public:
  explicit VolumeRays(const openvdb::FloatGrid& grid)
      : intersector_(grid), values_(grid.getConstAccessor()) {}

  double operator()(const Ray& ray) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    if (!intersector_.setIndexRay(ray)) return kNone;
    for (double t0 = 0, t1 = 0; intersector_.march(t0, t1);) {
      Ray part = ray;
      part.setTimes(t0, t1);
      openvdb::math::DDA<Ray, 0> dda(part);
      do {
        if (values_.isValueOn(dda.voxel())) return dda.time();
      } while (dda.step());
    }
    return kNone;
  }

 private:
  openvdb::tools::VolumeRayIntersector<openvdb::FloatGrid> intersector_;
  openvdb::FloatGrid::ConstAccessor values_;
};

constexpr int kPasses = 3;

// Traces the rays several times; the best time counts.
template <typename Trace>
double BestMs(const std::vector<Ray>& rays, const Trace& trace, std::vector<double>& times) {
  double best = std::numeric_limits<double>::infinity();
  times.assign(rays.size(), 0);
  for (int pass = 0; pass < kPasses; ++pass) {
    const Stopwatch stopwatch;
    for (std::size_t i = 0; i < rays.size(); ++i) times[i] = trace(rays[i]);
    best = std::min(best, stopwatch.Milliseconds());
  }
  return best;
}

Json RaysJson(const std::vector<double>& times, double ms) {
  const auto hits = std::count_if(times.begin(), times.end(), [](double t) { return std::isfinite(t); });
  return {{"ms", ms}, {"hits", hits}, {"mrays_per_s", static_cast<double>(times.size()) / ms / 1000}};
}

// Makes a level set, and the runs of the voxels inside it.
struct Made {
  openvdb::FloatGrid::Ptr level_set;
  std::optional<RunModel> runs;
  double convert_ms = 0, runs_ms = 0;
};

Made LevelSetOf(const Triangles& mesh, float band, VoxelPoint size, std::uint64_t max_bytes) {
  Made made;
  const Stopwatch converting;
  // The points are in indices already.
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> data(mesh.points,
                                                                                        mesh.triangles);
  made.level_set = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      data, *openvdb::math::Transform::createLinearTransform(), band, band);
  made.convert_ms = converting.Milliseconds();
  const Stopwatch extracting;
  const openvdb::CoordBBox whole(openvdb::Coord(0), openvdb::Coord(size.x - 1, size.y - 1, size.z - 1));
  RunsOfGrid runs(openvdb::Coord(0), size, max_bytes);
  VisitInside(
      made.level_set->tree(), [](float value, bool) { return value < 0; },
      [&](openvdb::CoordBBox box) {
        box.intersect(whole);
        return box.empty() || runs.Add(box);
      });
  const Voxel voxel = Voxel::Of(178, 178, 178);
  made.runs.emplace(runs.Take([&](int, int, int) { return voxel; }));
  made.runs_ms = extracting.Milliseconds();
  return made;
}

}  // namespace

Result<Json> Measure(const std::string& voxels, const std::string& mesh_path, const std::string& rays_path,
                     const std::string& out, std::uint64_t max_bytes) {
  const Result<VoxelFile> file = ReadVoxels(voxels, max_bytes);
  if (!file.ok()) return file.error();
  if (!file.value().grid) return Error{ErrorCode::kFormatBroken, voxels + ": has no grid"};
  const VoxelGrid grid = *file.value().grid;
  const auto& model = dynamic_cast<const OctreeModel&>(*file.value().model);
  Result<Triangles> mesh = ReadTriangles(mesh_path, grid, max_bytes);
  if (!mesh.ok()) return mesh.error();
  const Result<std::vector<Ray>> rays = ReadRays(rays_path, max_bytes);
  if (!rays.ok()) return rays.error();
  const std::uint64_t before = PeakBytes();
  Json json{{"ok", true}, {"library", openvdb::getLibraryVersionString()}, {"bands", Json::array()}};
  std::optional<Made> usual;
  for (const float band : {1.0f, 3.0f}) {
    usual.emplace(LevelSetOf(mesh.value(), band, model.size(), max_bytes));
    json["bands"].push_back({{"half_width", band},
                             {"convert_ms", usual->convert_ms},
                             {"runs_ms", usual->runs_ms},
                             {"grid_bytes", usual->level_set->memUsage()},
                             {"peak_bytes", PeakBytes() - before},
                             {"inside", usual->runs->Count()}});
  }
  if (auto written = WriteVoxels(out + ".oct", *usual->runs, grid); !written.ok()) return written.error();
  // The nodes and voxels of a volume have their corners at whole indices; a level set has its samples there.
  const Stopwatch filling;
  const openvdb::FloatGrid::Ptr volume = VolumeOf(model);
  json["volume"] = {{"fill_ms", filling.Milliseconds()}, {"grid_bytes", volume->memUsage()}};
  std::vector<double> times;
  VolumeRays volume_rays(*volume);
  const double volume_ms = BestMs(
      rays.value(), [&](const Ray& ray) { return volume_rays(ray); }, times);
  json["volume"].update(RaysJson(times, volume_ms));
  VoxelFileWriter depths(out + ".depths");
  for (const double t : times) depths.Number(t);
  if (auto written = depths.Finish(); !written.ok()) return written.error();
  openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid> surface(*usual->level_set);
  const double surface_ms = BestMs(
      rays.value(),
      [&](const Ray& ray) {
        Ray centred(ray.eye() - openvdb::Vec3d(0.5), ray.dir());
        double t = 0;
        return surface.intersectsIS(centred, t) ? t : std::numeric_limits<double>::infinity();
      },
      times);
  json["level_set"] = RaysJson(times, surface_ms);
  return json;
}

}  // namespace facetless
