#include "bench/prochazka.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/statistics.h"
#include "render/view/camera.h"
#include "render/voxel_walks/octree_view.h"
#include "render/voxel_walks/voxel_camera.h"
#include "render/voxel_walks/voxel_picture.h"
#include "render/voxels/raw_model.h"

namespace facetless {
namespace {

// The horizontal field of view is 90 degrees, so that half the height is 3/4 of the distance to the picture.
constexpr double kFovY = 73.739795291688;

std::string NameOfPath(const std::string& walk, int level) {
  return walk == "kd-shortstack" ? walk + ":" + std::to_string(std::max(1, level / 2)) : walk;
}

// The frames of the path: a turn around the model, from twice its size into its box.
std::vector<Camera> Path(const VoxelGrid& grid, int divisor) {
  // Unit vectors of the horizontal directions, which need no function that differs by processor.
  constexpr double kTurn[8][2] = {{1, 0},  {0.7071067811865476, 0.7071067811865476},
                                  {0, 1},  {-0.7071067811865476, 0.7071067811865476},
                                  {-1, 0}, {-0.7071067811865476, -0.7071067811865476},
                                  {0, -1}, {0.7071067811865476, -0.7071067811865476}};
  const Vec3 size = grid.bounds().high - grid.bounds().low, center = grid.bounds().center();
  std::vector<Camera> path;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double distance = 1.5 - 1.2 * frame / (kFrames - 1);  // in sizes of the model, from its centre
    const double* turn = kTurn[frame % 8];
    Camera camera;
    camera.name = "frame" + std::to_string(frame);
    camera.eye =
        center + Vec3{distance * size.x * turn[0], distance * size.y * turn[1], 0.4 * distance * size.z};
    camera.target = center - Vec3{0.1 * size.x * turn[1], 0.1 * size.y * turn[0], 0.1 * size.z};
    camera.up = {0, 0, 1};
    camera.projection = Projection::kPerspective;
    camera.fov_y_deg = kFovY;
    camera.width_px = kFrameWidth / divisor;
    camera.height_px = kFrameHeight / divisor;
    path.push_back(camera);
  }
  return path;
}

void AddTo(const WalkCounters& from, WalkCounters* to) {
  to->rays += from.rays;
  to->steps += from.steps;
  to->nodes += from.nodes;
}

// Renders the frames of the path by one walk. `frames_ms` gets the times of this run.
Result<void> RenderPath(const VoxelModel& model, const VoxelGrid& grid, const std::vector<Camera>& path,
                        const VoxelPictureOptions& look, const Execution& execution,
                        std::vector<double>* frames_ms, PathFigures* figures) {
  for (const Camera& camera : path) {
    const Result<VoxelPicture> picture = RenderVoxelPicture(model, grid, camera, look, execution);
    if (!picture) return picture.error();
    frames_ms->push_back(picture.value().trace_ms);
    if (figures == nullptr) continue;
    AddTo(picture.value().primary, &figures->primary);
    AddTo(picture.value().shadow, &figures->shadow);
  }
  return {};
}

Result<std::vector<PathFigures>> MeasurePaths(const OctreeModel& octree, const VoxelGrid& grid,
                                              const VoxelBenchOptions& options) {
  const std::vector<Camera> path = Path(grid, options.divisor);
  std::vector<PathFigures> all;
  for (const std::string walk : {"kd-restart", "kd-backtrack", "kd-shortstack"})
    all.push_back({.walk = NameOfPath(walk, octree.level()), .primary = {}, .shadow = {}});
  const Vec3 size = grid.bounds().high - grid.bounds().low;
  // The times of each frame in each round, for each walk, without and with the light.
  const std::size_t frames = path.size();
  std::vector<std::vector<std::vector<double>>> times[2];
  for (auto& of_light : times) of_light.assign(all.size(), std::vector<std::vector<double>>(frames));
  for (int round = 0; round < options.repeats; ++round)
    for (std::size_t walk = 0; walk < all.size(); ++walk)
      for (int light = 0; light < 2; ++light) {
        VoxelPictureOptions look;
        look.walk = all[walk].walk;
        look.grid_normals = false;
        look.levels = false;
        if (light == 1)
          look.lights = {{.at = grid.bounds().center() + Vec3{0.6 * size.x, -0.4 * size.y, size.z}}};
        std::vector<double> ms;
        const bool count = round == 0 && light == 1;
        const Result<void> done =
            RenderPath(octree, grid, path, look, options.execution, &ms, count ? &all[walk] : nullptr);
        if (!done) return done.error();
        for (std::size_t frame = 0; frame < frames; ++frame) times[light][walk][frame].push_back(ms[frame]);
      }
  for (std::size_t walk = 0; walk < all.size(); ++walk) {
    double sum[2] = {0, 0};
    all[walk].best_ms = INFINITY;
    for (int light = 0; light < 2; ++light)
      for (std::size_t frame = 0; frame < frames; ++frame) {
        const double ms = Median(times[light][walk][frame]);
        sum[light] += ms;
        if (light == 1) continue;
        all[walk].worst_ms = std::max(all[walk].worst_ms, ms);
        all[walk].best_ms = std::min(all[walk].best_ms, ms);
      }
    all[walk].fps = 1000 * static_cast<double>(frames) / sum[0];
    all[walk].fps_light = 1000 * static_cast<double>(frames) / sum[1];
  }
  return all;
}

// One picture of primary rays, and what came of it.
struct RayPicture {
  std::vector<VoxelHit> hits;
  WalkCounters counters;
};

// Walks with all rays of a picture. Hits are kept if `keep` is true; without that, only their depths are added up.
double WalkAll(const VoxelModel& model, const VoxelCamera& camera, const BoundWalk& walk,
               const OctreeView* view, RayPicture* picture, bool keep) {
  constexpr int kTile = OctreeView::kTile;
  double sum = 0;
  picture->counters = {};
  if (keep)
    picture->hits.assign(
        static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px), {});
  for (int tile_row = 0; tile_row < camera.height_px; tile_row += kTile)
    for (int tile_column = 0; tile_column < camera.width_px; tile_column += kTile)
      for (int i = 0; i < kTile * kTile; ++i) {
        const int column = tile_column + i % kTile, row = tile_row + i / kTile;
        if (column >= camera.width_px || row >= camera.height_px) continue;
        VoxelRay ray;
        if ((view != nullptr && !view->MayHit(column, row)) ||
            !camera.EnterPixel(column + 0.5, row + 0.5, model.size(), &ray))
          continue;
        const VoxelHit hit = view != nullptr ? view->Walk(column, row, ray, {}, &picture->counters)
                                             : walk.Walk(ray, {}, &picture->counters);
        if (!hit.hit()) continue;
        sum += hit.t;
        if (keep)
          picture->hits[static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width_px) +
                        static_cast<std::size_t>(column)] = hit;
      }
  return sum;
}

WalkDistortion DistortionOf(const std::vector<VoxelHit>& hits, const std::vector<VoxelHit>& exact,
                            double pitch) {
  WalkDistortion distortion;
  double pixels = 0, other = 0, both = 0, sum = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].hit() && !exact[i].hit()) continue;
    pixels += 1;
    other += hits[i].hit() != exact[i].hit() || !(hits[i].at == exact[i].at);
    if (!hits[i].hit() || !exact[i].hit()) continue;
    both += 1;
    const double depth = std::abs(hits[i].t - exact[i].t) / pitch;
    sum += depth;
    distortion.most_depth = std::max(distortion.most_depth, depth);
  }
  distortion.other_voxel = pixels > 0 ? other / pixels : 0;
  distortion.mean_depth = both > 0 ? sum / both : 0;
  return distortion;
}

using Encoded = std::map<std::string, std::unique_ptr<VoxelModel>, std::less<>>;

std::vector<WalkFigures> MeasureWalks(const Encoded& encoded, const VoxelGrid& grid,
                                      const VoxelBenchOptions& options) {
  const int pixels = kRaySize / options.divisor;
  const Result<Camera> view = NamedView("iso", grid.bounds(), Projection::kOrthographic, pixels, pixels);
  if (!view.ok()) return {};
  const VoxelCamera camera(MakeFrame(view.value(), grid.bounds().diagonal()).value(), grid, pixels, pixels);
  struct Competitor {
    const VoxelModel* model;
    std::unique_ptr<const BoundWalk> walk;
    bool tiles, exact;
    RayPicture picture = {};
    double side_bytes = 0;
  };
  std::vector<Competitor> competitors;
  std::vector<WalkFigures> all;
  const auto add = [&](const NamedVoxelWalk& row, bool tiles) {
    const auto found = encoded.find(row.encoding);
    if (found == encoded.end()) return;
    competitors.push_back(
        {found->second.get(), BindVoxelWalk(*found->second, row.name).value(), tiles, row.exact});
    all.push_back({.walk = tiles ? "octree, tile by tile" : std::string(row.name), .counters = {}});
  };
  for (const NamedVoxelWalk& row : VoxelWalks()) {
    if (row.name == UsualVoxelWalk("octree").name) add(row, true);
    add(row, false);
  }
  volatile double sink = 0;
  const auto run = [&](Competitor& competitor, bool keep) {
    std::optional<OctreeView> tiles;
    if (competitor.tiles) tiles.emplace(static_cast<const OctreeModel&>(*competitor.model), camera);
    competitor.side_bytes = static_cast<double>(competitor.walk->bytes() + (tiles ? tiles->bytes() : 0));
    sink = WalkAll(*competitor.model, camera, *competitor.walk, tiles ? &*tiles : nullptr,
                   &competitor.picture, keep);
  };
  std::vector<std::function<void()>> turns;
  for (Competitor& competitor : competitors) turns.push_back([&] { run(competitor, false); });
  const std::vector<std::vector<double>> ms = TakeTurns(options.repeats, turns);
  RayPicture exact;
  for (std::size_t i = 0; i < competitors.size(); ++i) {
    Competitor& competitor = competitors[i];
    run(competitor, true);
    all[i].rays_per_second = 1000.0 * pixels * pixels / Median(ms[i]);
    all[i].side_bytes = competitor.side_bytes;
    all[i].counters = competitor.picture.counters;
    for (const VoxelHit& hit : competitor.picture.hits) all[i].pixels_hit += hit.hit();
    if (exact.hits.empty()) exact = competitor.picture;  // the first walk of each encoding is exact
    if (!competitor.exact) all[i].distortion = DistortionOf(competitor.picture.hits, exact.hits, grid.pitch);
    competitor.picture.hits = {};
  }
  return all;
}

}  // namespace

VoxelBenchModel CubeOfThesis() {
  constexpr int kSize = 1024, kCube = kSize / 4;
  RunModel model({kSize, kSize, kSize});
  model.Fill({{kCube, kCube, kCube}, {2 * kCube, 2 * kCube, 2 * kCube}}, Voxel::Of(200, 60, 40));
  const VoxelGrid grid{{0, 0, 0}, 1, model.size()};
  return {"cube", std::move(model), grid};
}

Result<VoxelBench> MeasureVoxels(const VoxelBenchModel& model, const VoxelBenchOptions& options) {
  VoxelBench bench;
  bench.name = model.name;
  bench.size = model.voxels.size();
  bench.filled = model.voxels.Count();
  Encoded encoded;
  for (const VoxelEncoding& encoding : VoxelEncodings()) {
    if (encoding.name == "raw" && RawModel::BytesOf(bench.size) > kMostRawBytes) {
      bench.sizes.push_back({"raw", static_cast<double>(RawModel::BytesOf(bench.size))});
      continue;
    }
    auto made = Converted(model.voxels, encoding.name);
    if (!made) return made.error();
    bench.sizes.push_back({std::string(encoding.name), static_cast<double>(made.value()->bytes())});
    encoded[std::string(encoding.name)] = std::move(made).value();
  }
  const OctreeModel& octree = static_cast<const OctreeModel&>(*encoded.at("octree"));
  const OctreeModel::Figures figures = octree.CountNodes();
  bench.nodes = figures.nodes;
  bench.leaves = figures.leaves;
  bench.filled_leaves = figures.filled_leaves;
  bench.walks = MeasureWalks(encoded, model.grid, options);
  if (options.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while measuring voxels"};
  auto paths = MeasurePaths(octree, model.grid, options);
  if (!paths) return paths.error();
  bench.paths = std::move(paths).value();
  return bench;
}

}  // namespace facetless
