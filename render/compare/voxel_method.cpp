#include "render/compare/voxel_method.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/voxel_walks/octree_view.h"
#include "render/voxel_walks/voxel_camera.h"
#include "render/voxel_walks/voxel_normal.h"

namespace facetless {
namespace {

Result<std::unique_ptr<const Representation>> MakeVoxels(const MethodInput& input, double setting) {
  if (!input.direct.sections.empty())
    return Error{ErrorCode::kBadUsage,
                 "section: voxels are not cut; leave out section, or the method voxels"};
  const Stopwatch stopwatch;
  if (!(setting >= 2 && setting <= kMostVoxelsPerAxis && setting == std::floor(setting)))
    return Error{
        ErrorCode::kBadUsage,
        "voxels: the number of voxels along the longest side must be a whole number from 2 to 65536"};
  const Result<VoxelGrid> grid = GridOfResolution(input.scene.model().bounds, static_cast<int>(setting));
  if (!grid.ok()) return grid.error();
  VoxelSurface::Body body;
  body.grid = grid.value();
  body.normals = input.voxels.normals;
  body.name = input.name;
  body.title = input.title;
  VoxelizeOptions options;
  options.accuracy.max_bytes = input.max_bytes;
  Result<Voxels> voxels = Voxelize(input.scene, body.grid, options, input.execution);
  if (!voxels.ok()) return voxels.error();
  body.stats = std::move(voxels.value().stats);
  auto model = Converted(voxels.value().model, input.voxels.encoding, input.max_bytes);
  if (!model.ok()) return model.error();
  body.model = std::move(model).value();
  if (body.normals == VoxelNormals::kExact) {
    Result<std::vector<TouchedSlab>> touched = FindTouchedVoxels(
        input.scene, body.grid, {.max_bytes = input.max_bytes, .details = true}, input.execution);
    if (!touched.ok()) return touched.error();
    body.faces.emplace(std::move(touched).value(), body.grid.size.y);
  }
  body.make_ms = stopwatch.Milliseconds();
  return std::unique_ptr<const Representation>(std::make_unique<VoxelSurface>(std::move(body)));
}

}  // namespace

std::vector<RepresentationFact> VoxelSurface::facts() const {
  const std::uint64_t count = model_.Count();
  std::vector<RepresentationFact> facts = {
      {"pitch_mm", grid_.pitch},
      {"voxels", static_cast<double>(count)},
      {"volume_mm_cubed", static_cast<double>(count) * grid_.voxel_mm3()},
      {"voxel_bytes", static_cast<double>(model_.bytes())}};
  if (body_.faces) facts.push_back({"normal_bytes", static_cast<double>(body_.faces->bytes())});
  facts.push_back({"open_faces", static_cast<double>(body_.stats.open_faces)});
  facts.push_back({"columns_in_doubt", static_cast<double>(body_.stats.columns_in_doubt)});
  return facts;
}

Vec3 VoxelSurface::NormalOf(const VoxelHit& hit, Vec3 direction) const {
  return body_.normals == VoxelNormals::kSide ? SideNormal(hit, direction)
                                              : GridNormal(model_, hit, direction);
}

VoxelSurface::Shown VoxelSurface::ShownAt(const VoxelHit& hit, Vec3 direction) const {
  if (body_.normals == VoxelNormals::kExact) {
    // A surface passes between the centre of the voxel and that of the empty one before it, so that it touches one of them.
    const int reach = hit.level == 0 ? 1 : 1 + (1 << hit.level);
    if (const std::optional<NearFace> near = body_.faces->Near(hit.at, reach, direction)) {
      const bool known = Dot(near->normal, direction) < 0;
      return {near->placed_face, known ? near->normal : NormalOf(hit, direction)};
    }
  }
  return {0, NormalOf(hit, direction)};
}

VoxelHit VoxelSurface::WalkWithout(const std::vector<bool>& leave_out, const BoundWalk& walk, VoxelRay ray,
                                   WalkCounters* counters) const {
  for (;;) {
    const VoxelHit hit = walk.Walk(ray, {}, counters);
    if (!hit.hit()) return hit;
    for (const TouchedVoxel& touched : body_.faces->At(hit.at))
      if (!leave_out[touched.placed_face]) return hit;
    if (!ray.BeginAt(ray.Leave(hit.at, 1))) return {};
  }
}

Result<TracedView> VoxelSurface::Trace(const Camera& camera, const TraceRequest& request,
                                       const Execution& execution) const {
  if (request.leave_out != nullptr && !names_faces())
    return Error{ErrorCode::kBadUsage,
                 "voxels without exact normals name no faces, so that transparent ones cannot "
                 "be left out; use voxel_normals exact"};
  const Result<CameraFrame> made = MakeFrame(camera, grid_.bounds().diagonal());
  if (!made.ok()) return made.error();
  TracedView view;
  view.frame = made.value();
  const CameraFrame& frame = view.frame;
  view.samples.Resize(camera.width_px, camera.height_px);
  const Stopwatch tracing;
  const Result<std::unique_ptr<const BoundWalk>> bound = BindVoxelWalk(model_, "");
  if (!bound.ok()) return bound.error();
  const BoundWalk& walk = *bound.value();
  const VoxelCamera rays(frame, grid_, camera.width_px, camera.height_px);
  std::optional<OctreeView> tiles;
  if (const auto* octree = dynamic_cast<const OctreeModel*>(&model_);
      octree != nullptr && request.leave_out == nullptr)
    tiles.emplace(*octree, rays);
  // Cubes are no wider than half a pixel, so that their depth is as good as that of a pixel's centre.
  WalkOptions footprint = rays.Footprint();
  footprint.footprint_0 *= 0.5;
  footprint.footprint *= 0.5;
  struct Worker {
    WalkCounters counters;
    std::uint64_t hits = 0;
  };
  PerThread<Worker> workers;
  RunWithThreads(execution.threads, [&] {
    constexpr int kTile = OctreeView::kTile;
    ParallelFor(0, (camera.height_px + kTile - 1) / kTile, [&](int tile_row) {
      if (execution.cancelled()) return;
      Worker& worker = workers.local();
      for (int i = 0; i < kTile * ((camera.width_px + kTile - 1) / kTile) * kTile; ++i) {
        // Tile by tile: neighbouring rays read the same nodes.
        const int column = i / (kTile * kTile) * kTile + i % kTile,
                  row = tile_row * kTile + i / kTile % kTile;
        if (column >= camera.width_px || row >= camera.height_px) continue;
        if (tiles && !tiles->MayHit(column, row)) continue;
        VoxelRay ray;
        if (!rays.EnterPixel(column + 0.5, row + 0.5, model_.size(), &ray)) continue;
        const VoxelHit hit = request.leave_out != nullptr
                                 ? WalkWithout(*request.leave_out, walk, ray, &worker.counters)
                             : tiles ? tiles->Walk(column, row, ray, footprint, &worker.counters)
                                     : walk.Walk(ray, footprint, &worker.counters);
        if (!hit.hit()) continue;
        const std::size_t out = static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width_px) +
                                static_cast<std::size_t>(column);
        const Shown shown = ShownAt(hit, ray.direction());
        view.samples.depth[out] = rays.before + hit.t;
        view.samples.face[out] = shown.placed_face;
        view.samples.normal[out] = {float(shown.normal.x), float(shown.normal.y), float(shown.normal.z)};
        ++worker.hits;
      }
    });
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while tracing"};
  view.counters.trace_ms = tracing.Milliseconds();
  view.counters.rays = view.samples.size();
  for (const Worker& worker : workers) view.counters.hits += worker.hits;
  view.structure_bytes =
      model_.bytes() + walk.bytes() + (tiles ? tiles->bytes() : 0) + (body_.faces ? body_.faces->bytes() : 0);
  return view;
}

Method VoxelMethod() {
  return {.name = "voxels",
          .title = "Voxels",
          .help = "The voxels whose centres lie inside the exact solids.",
          .source = "P. Procházka 2013 (octree, level of detail); Facetless (columns of certified crossings)",
          .does_not = "A part thinner than a voxel may vanish, and open shells have no inside.",
          .setting = "voxels along the longest side",
          .usual = {64, 128, 256, 512},
          .make = MakeVoxels};
}

}  // namespace facetless
