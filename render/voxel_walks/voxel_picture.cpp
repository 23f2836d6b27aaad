#include "render/voxel_walks/voxel_picture.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/voxel_walks/octree_view.h"
#include "render/voxel_walks/voxel_camera.h"
#include "render/voxel_walks/voxel_normal.h"

namespace facetless {
namespace {

constexpr int kTile = OctreeView::kTile;

class Painter {
 public:
  Painter(const VoxelModel& model, const VoxelCamera& camera, const BoundWalk& walk, const OctreeView* view,
          const VoxelPictureOptions& options)
      : model_(model), camera_(camera), walk_(walk), view_(view), options_(options) {
    if (options.levels) footprint_ = camera.Footprint();
    for (std::size_t byte = 0; byte < 256; ++byte)
      linear_[byte] = SrgbToLinear(static_cast<double>(byte) / 255);
    for (const PointLight& light : options.lights)
      lights_.push_back((1 / camera.grid.pitch) * (light.at - camera.grid.origin));
  }

  struct Worker {
    WalkCounters primary, shadow;
    std::uint64_t hits = 0;
    NormalMemory normals;
  };

  // The light of a sample; nothing is changed where no voxel is seen.
  void Paint(int column, int row, std::array<float, 4>* pixel, Worker* worker) const {
    if (view_ != nullptr && !view_->MayHit(column, row)) return;
    VoxelRay ray;
    if (!camera_.EnterPixel(column + 0.5, row + 0.5, model_.size(), &ray)) return;
    const VoxelHit hit = view_ != nullptr ? view_->Walk(column, row, ray, footprint_, &worker->primary)
                                          : walk_.Walk(ray, footprint_, &worker->primary);
    if (!hit.hit()) return;
    ++worker->hits;
    const Vec3 direction = ray.direction();
    const bool of_grid = options_.grid_normals;
    const Vec3 normal =
        of_grid ? GridNormal(model_, hit, direction, &worker->normals) : SideNormal(hit, direction);
    Vec3 light{options_.ambient, options_.ambient, options_.ambient};
    if (!lights_.empty()) {
      const Vec3 start = of_grid ? AboveVoxel(ray, hit, normal) : BesideSide(ray, hit);
      for (std::size_t i = 0; i < lights_.size(); ++i)
        light = light + Arriving(start, lights_[i], normal, worker) * options_.lights[i].color;
    }
    *pixel = {static_cast<float>(light.x * linear_[hit.voxel.red()]),
              static_cast<float>(light.y * linear_[hit.voxel.green()]),
              static_cast<float>(light.z * linear_[hit.voxel.blue()]), 1};
  }

 private:
  // The point at which a ray enters a voxel, moved along the normal; beside the side, if a filled voxel is there.
  Vec3 AboveVoxel(const VoxelRay& ray, const VoxelHit& hit, Vec3 normal) const {
    const Vec3 above = ray.PointAt(hit.t) + kShadowOffset * (1 << hit.level) * normal;
    const auto index = [](double at, int size) { return at >= 0 && at < size ? static_cast<int>(at) : -1; };
    const VoxelPoint size = model_.size();
    const bool filled =
        model_.Get(index(above.x, size.x), index(above.y, size.y), index(above.z, size.z)).filled();
    return filled ? BesideSide(ray, hit) : above;
  }

  // The point at which a ray enters a voxel, moved across the side to the other voxel there.
  Vec3 BesideSide(const VoxelRay& ray, const VoxelHit& hit) const {
    const Vec3 normal = SideNormal(hit, ray.direction());
    Vec3 point = ray.PointAt(hit.t);
    const int level = hit.level,
              at[3] = {hit.at.x >> level << level, hit.at.y >> level << level, hit.at.z >> level << level};
    double* const coordinates[3] = {&point.x, &point.y, &point.z};
    const double along[3] = {normal.x, normal.y, normal.z};
    for (int axis = 0; axis < 3; ++axis) {
      const double edge = 1 << level, inner = 1e-6 * edge;
      if (axis == hit.side) {
        *coordinates[axis] = along[axis] > 0 ? at[axis] + edge + inner : at[axis] - inner;
      } else {
        // Rounding must not move the point to a neighbour.
        *coordinates[axis] = std::clamp(*coordinates[axis], at[axis] + inner, at[axis] + edge - inner);
      }
    }
    return point;
  }

  // The cosine of the light, or 0 in its shadow. Points are in the coordinates of the model.
  double Arriving(Vec3 from, Vec3 light, Vec3 normal, Worker* worker) const {
    const Vec3 way = light - from;
    const double length = Length(way), along = Dot(normal, way);
    if (!(along > 0) || !(length > 0)) return 0;
    VoxelRay ray;
    if (ray.Enter(from, way, 0, model_.size()) && ray.EndAt(1) && walk_.Walk(ray, {}, &worker->shadow).hit())
      return 0;
    return along / length;
  }

  const VoxelModel& model_;
  const VoxelCamera& camera_;
  const BoundWalk& walk_;
  const OctreeView* const view_;
  const VoxelPictureOptions& options_;
  WalkOptions footprint_;
  std::vector<Vec3> lights_;
  std::array<double, 256> linear_;
};

void AddTo(const WalkCounters& from, WalkCounters* to) {
  to->rays += from.rays;
  to->steps += from.steps;
  to->nodes += from.nodes;
}

}  // namespace

PointLight LightBesideEye(const CameraFrame& frame, const VoxelGrid& grid) {
  const Box3 bounds = grid.bounds();
  const double distance = 2 * bounds.diagonal();
  return {.at = bounds.center() - distance * frame.forward - 0.35 * distance * frame.right -
                0.55 * distance * frame.down,
          .color = {0.75, 0.75, 0.75}};
}

Result<VoxelPicture> RenderVoxelPicture(const VoxelModel& model, const VoxelGrid& grid, const Camera& view,
                                        const VoxelPictureOptions& options, const Execution& execution) {
  const Camera camera = view.Supersampled(options.samples_x, options.samples_y);
  const Result<CameraFrame> frame = MakeFrame(camera, grid.bounds().diagonal());
  if (!frame) return frame.error();
  VoxelPicture picture;
  const Stopwatch binding;
  const Result<std::unique_ptr<const BoundWalk>> walk = BindVoxelWalk(model, options.walk);
  if (!walk) return walk.error();
  picture.bind_ms = binding.Milliseconds();
  const Stopwatch tracing;
  const VoxelCamera rays(frame.value(), grid, camera.width_px, camera.height_px);
  std::optional<OctreeView> tiles;
  if (const auto* octree = dynamic_cast<const OctreeModel*>(&model);
      octree != nullptr && options.walk.empty())
    tiles.emplace(*octree, rays);
  picture.side_bytes = walk.value()->bytes() + (tiles ? tiles->bytes() : 0);
  const Painter painter(model, rays, *walk.value(), tiles ? &*tiles : nullptr, options);
  Film film{camera.width_px, camera.height_px, {}};
  film.pixels.assign(static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px),
                     BackgroundLight(options.background));
  PerThread<Painter::Worker> workers;
  const auto paint_tiles = [&](int tile_row) {
    if (execution.cancelled()) return;
    Painter::Worker& worker = workers.local();
    const int columns = (camera.width_px + kTile - 1) / kTile;
    // Tile by tile: neighbouring rays read the same nodes.
    for (int i = 0; i < columns * kTile * kTile; ++i) {
      const int column = i / (kTile * kTile) * kTile + i % kTile, row = tile_row * kTile + i / kTile % kTile;
      if (column >= camera.width_px || row >= camera.height_px) continue;
      painter.Paint(column, row,
                    &film.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width_px) +
                                 static_cast<std::size_t>(column)],
                    &worker);
    }
  };
  RunWithThreads(execution.threads,
                 [&] { ParallelFor(0, (camera.height_px + kTile - 1) / kTile, paint_tiles); });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while tracing"};
  for (const Painter::Worker& worker : workers) {
    AddTo(worker.primary, &picture.primary);
    AddTo(worker.shadow, &picture.shadow);
    picture.hits += worker.hits;
  }
  picture.trace_ms = tracing.Milliseconds();
  Result<Film> resolved = Resolve(std::move(film), options.samples_x, options.samples_y);
  if (!resolved) return resolved.error();
  picture.film = std::move(resolved).value();
  return picture;
}

}  // namespace facetless
