#include "render/solve/solver_trace.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "render/accel/structures.h"
#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/model/walk.h"
#include "render/solve/patch_jet.h"
#include "render/solve/solver.h"
#include "render/solve/value_map.h"
#include "render/trace/scene.h"

namespace facetless {
namespace {

// A root of a ray that grazes a surface has a depth that is less exact than its place on the screen. Boxes are made
// larger by the tolerance of the method times this factor.
constexpr double kGrazing = 1e3;

Box3 Enlarged(const Box3& box, double by) {
  return {box.low - Vec3{by, by, by}, box.high + Vec3{by, by, by}};
}

// The nearest hit of a ray.
struct NearestHit {
  double depth = INFINITY;
  std::uint32_t patch = kNoIndex, placed_face = kNoIndex;
  double u = 0, v = 0;
};

// What a thread has.
struct Worker {
  std::unique_ptr<SolverState> solver;
  std::optional<QueryState> query;
  std::uint64_t candidates = 0, trim_tests = 0, no_start = 0, hits = 0, unresolved = 0;
};

// A view that is prepared for a solver: its surfaces, and where rays find them.
class SolverView {
 public:
  SolverView(const Scene& scene, const Camera& camera, const CameraFrame& frame, const SolverInfo& info,
             const SolverOptions& options, const SolverTraceRequest& request)
      : camera_(camera),
        frame_(frame),
        info_(info),
        options_(options),
        request_(request),
        perspective_(frame.projection == Projection::kPerspective),
        starts_(options.starts.value_or(info.starts)),
        surfaces_(frame, scene.model().bounds.center()) {}

  // Errors: those of TraceWithSolver.
  Result<void> Prepare(const Scene& scene) {
    if (starts_ != SolverStarts::kPieces && !info_.takes_map)
      return Error{ErrorCode::kBadUsage, "starts: the method " + info_.name +
                                             " does not start at a map of preliminary values; write pieces"};
    if (auto added = AddFaces(scene); !added.ok()) return added;
    if (auto claims = CheckClaims(info_, surfaces_); !claims.ok()) return claims;
    Result<std::unique_ptr<const Solver>> made =
        info_.make(surfaces_, options_.max_bytes - surfaces_.bytes(), request_.execution);
    if (!made.ok()) return made.error();
    solver_ = std::move(made).value();
    const std::uint64_t used = surfaces_.bytes() + solver_->bytes();
    if (used >= options_.max_bytes) return TooLarge();
    if (starts_ == SolverStarts::kPieces) {
      if (auto built = BuildStructure(); !built.ok()) return built;
      if (used + structure_bytes_ > options_.max_bytes) return TooLarge();
      return {};
    }
    Result<ValueMap> map = ValueMap::Draw(
        surfaces_, info_.unit, {camera_.width_px, camera_.height_px, starts_ == SolverStarts::kPublishedMap},
        options_.max_bytes - used, request_.execution);
    if (!map.ok()) return map.error();
    map_ = std::move(map).value();
    return {};
  }

  Worker MakeWorker() const {
    Worker worker;
    worker.solver = solver_->MakeState();
    if (structure_)
      WithStructure(*structure_,
                    [&](const auto& structure) { worker.query.emplace(structure.state_size()); });
    return worker;
  }

  // Traces the samples of a row, from left to right. wanted(column) says which; write(column, hit, start face, resolved)
  // takes the answers.
  template <typename Wanted, typename Write>
  void TraceRow(int row, Worker& worker, const Wanted& wanted, const Write& write) const {
    solver_->BeginRow(row, *worker.solver);
    const auto trace = [&](const auto& find) {
      for (int column = 0; column < camera_.width_px; ++column) {
        if (!wanted(column)) continue;
        const SolverRay ray = RayAt(column, row);
        const std::uint64_t out_of_work = OutOfWork(*worker.solver);
        worker.solver->BeginRay();
        NearestHit hit;
        const std::uint32_t start_face = find(ray, worker, hit);
        const bool resolved = OutOfWork(*worker.solver) == out_of_work;
        worker.hits += hit.patch != kNoIndex && resolved;
        worker.unresolved += !resolved;
        write(column, hit, start_face, resolved);
      }
    };
    if (map_) {
      trace([&](const SolverRay& ray, Worker& own, NearestHit& hit) { return FromMap(ray, own, hit); });
    } else {
      WithStructure(*structure_, [&](const auto& structure) {
        trace([&](const SolverRay& ray, Worker& own, NearestHit& hit) {
          FromPieces(structure, ray, own, hit);
          return kNoIndex;
        });
      });
    }
  }

  // Writes a hit, or a miss, to entry `out`.
  void WriteSample(const NearestHit& hit, bool resolved, std::size_t out, SampleBuffer* samples) const {
    if (!samples->certificate.empty())
      samples->certificate[out] = resolved ? Certificate::kConverged : Certificate::kUnresolved;
    if (!samples->doubt.empty()) samples->doubt[out] = resolved ? 0 : kDoubtLimit;
    if (hit.patch == kNoIndex || !resolved) return;
    const SolverPatch& patch = surfaces_.patches()[hit.patch];
    const Vec3 normal = NormalAt(patch, hit.u, hit.v);
    samples->depth[out] = hit.depth;
    samples->face[out] = hit.placed_face;
    samples->normal[out] = {float(normal.x), float(normal.y), float(normal.z)};
    if (samples->uv.empty()) return;
    const Vec2 native = surfaces_.Native(patch, hit.u, hit.v);
    samples->uv[out] = {native.x, native.y};
  }

  void FillStats(const Scene& scene, const PerThread<Worker>& workers, SolverStats* stats) const {
    stats->name = info_.name;
    stats->starts = starts_;
    if (structure_) stats->structure = options_.structure;
    stats->pieces = structure_ ? solver_->pieces().size() : 0;
    stats->bytes = surfaces_.bytes() + solver_->bytes() + (map_ ? map_->bytes() : 0) + structure_bytes_ +
                   scene.data().bytes();
    for (const Worker& worker : workers) {
      stats->counters.Add(worker.solver->counters);
      stats->candidates += worker.candidates;
      stats->trim_tests += worker.trim_tests;
      stats->no_start += worker.no_start;
      stats->hits += worker.hits;
      stats->unresolved += worker.unresolved;
    }
  }

  const Camera& camera() const { return camera_; }
  bool has_map() const { return map_.has_value(); }

 private:
  Error TooLarge() const {
    return {ErrorCode::kLimitExceeded,
            "the method " + info_.name + " needs more than " + std::to_string(options_.max_bytes >> 20) +
                " MB for this model; raise --max-view-memory, or show fewer parts"};
  }

  Result<void> AddFaces(const Scene& scene) {
    const Model& model = scene.model();
    // Count first, so that a model that is too large takes no memory.
    std::uint64_t points = 0;
    const auto wanted = [&](std::uint32_t placed_face) {
      return request_.leave_out == nullptr || !(*request_.leave_out)[placed_face];
    };
    for (const Instance& instance : model.instances)
      for (const PlacedFace face : WalkPlacedFaces(model, instance))
        if (wanted(face.id)) {
          const Surface& surface = model.surfaces[model.faces[face.face].surface];
          points += std::uint64_t{surface.PatchCount()} * surface.PointsPerPatch();
        }
    if (points > options_.max_bytes / (sizeof(Vec4) + sizeof(ViewProjection::Point))) return TooLarge();
    for (const Instance& instance : model.instances)
      for (const PlacedFace face : WalkPlacedFaces(model, instance))
        if (wanted(face.id))
          surfaces_.AddFace(model, face.face, instance.placement, face.id,
                            &scene.data().faces[face.face].trim, scene.data().faces[face.face].patches);
    // A limit of 0 would be none.
    if (surfaces_.bytes() >= options_.max_bytes) return TooLarge();
    return {};
  }

  Result<void> BuildStructure() {
    std::vector<Box3> boxes;
    const double pixel = std::max(frame_.pixel_x, frame_.pixel_y);
    for (const SolverPiece& piece : solver_->pieces()) {
      const double depth = perspective_ ? FarthestDepth(piece.box) : 1;
      boxes.push_back(Enlarged(piece.box, kGrazing * info_.tolerance_px * pixel * depth));
      nearest_depth_ = std::min(nearest_depth_, NearestDepth(boxes.back()));
      farthest_depth_ = std::max(farthest_depth_, FarthestDepth(boxes.back()));
    }
    // Rays of orthographic views begin in front of everything.
    nearest_depth_ -= 0.125 * (farthest_depth_ - nearest_depth_);
    if (!(nearest_depth_ < INFINITY)) nearest_depth_ = 0;
    Result<AnyStructure> made = MakeStructure(options_.structure, boxes);
    if (!made.ok()) return made.error();
    structure_.emplace(std::move(made).value());
    structure_bytes_ =
        WithStructure(*structure_, [](const auto& structure) { return std::uint64_t{structure.bytes()}; });
    return {};
  }

  // The depths of the corners of a box that are nearest to and farthest from the eye plane.
  double NearestDepth(const Box3& box) const { return MiddleDepth(box) - HalfDepth(box); }
  double FarthestDepth(const Box3& box) const { return MiddleDepth(box) + HalfDepth(box); }
  double MiddleDepth(const Box3& box) const {
    return Dot(box.center() + surfaces_.origin() - frame_.eye, frame_.forward);
  }
  double HalfDepth(const Box3& box) const {
    const Vec3 half = 0.5 * (box.high - box.low), f = frame_.forward;
    return std::fabs(half.x * f.x) + std::fabs(half.y * f.y) + std::fabs(half.z * f.z);
  }

  SolverRay RayAt(int column, int row) const {
    const Ray ray = PixelRay(frame_, column + 0.5, row + 0.5);
    return {column,
            row,
            column + 0.5 - frame_.center_x,
            row + 0.5 - frame_.center_y,
            ray.origin - surfaces_.origin(),
            ray.direction};
  }

  static std::uint64_t OutOfWork(const SolverState& state) {
    return state.counters.stops[static_cast<std::size_t>(SolverStop::kWork)];
  }

  // Solves from a start, and keeps the nearest hit.
  void Solve(const SolverRay& ray, const SolverStart& start, Worker& worker, NearestHit& hit) const {
    ++worker.candidates;
    const std::size_t first = worker.solver->roots.size();
    solver_->Solve(ray, start, *worker.solver);
    for (std::size_t i = first; i < worker.solver->roots.size(); ++i)
      Keep(worker.solver->roots[i], worker, hit);
    worker.solver->nearest = hit.depth;
  }

  void Keep(const SolverRoot& root, Worker& worker, NearestHit& hit) const {
    const SolverPatch& patch = surfaces_.patches()[root.patch];
    const SolverFace& face = surfaces_.faces()[patch.face];
    const double u = std::clamp(root.u, 0.0, 1.0), v = std::clamp(root.v, 0.0, 1.0);
    const PatchJet<4> jet =
        EvaluatePatch<4>(&surfaces_.screen(patch)->x, patch.degree_u, patch.degree_v, u, v);
    const double w = jet.value[2], q = jet.value[3];
    const double depth = perspective_ ? w / q : q / w;
    if (!(depth < hit.depth || (depth == hit.depth && face.placed_face < hit.placed_face))) return;
    if (!std::isfinite(depth) || (perspective_ && !(depth > frame_.near_mm))) return;
    if (face.trim != nullptr) {
      ++worker.trim_tests;
      const Vec2 native = surfaces_.Native(patch, u, v);
      if (!face.trim->Query(native.x, native.y, 0, 0, 0).inside) return;
    }
    hit = {depth, root.patch, face.placed_face, u, v};
  }

  template <typename Structure>
  void FromPieces(const Structure& structure, const SolverRay& ray, Worker& worker, NearestHit& hit) const {
    RaySegment segment{ray.origin, ray.direction, frame_.near_mm, INFINITY};
    double before = 0;  // the depth at which the segment's t is 0
    if (!perspective_) {
      before = nearest_depth_;
      segment.origin = ray.origin + nearest_depth_ * ray.direction;
      segment.t_first = 0;
    }
    const std::span<const SolverPiece> pieces = solver_->pieces();
    structure.Visit(segment, *worker.query, [&](std::uint32_t piece) {
      if (worker.solver->work_left <= 0) {
        worker.solver->End(SolverStop::kWork);
        return kStop;
      }
      Solve(ray, StartOf(pieces[piece]), worker, hit);
      return hit.depth - before;
    });
  }

  // Returns the placed face at which the search began.
  std::uint32_t FromMap(const SolverRay& ray, Worker& worker, NearestHit& hit) const {
    const std::optional<SolverStart> start = map_->At(ray.column, ray.row);
    if (!start) {
      ++worker.no_start;
      return kNoIndex;
    }
    Solve(ray, *start, worker, hit);
    const std::uint32_t face =
        info_.unit == SolverUnit::kFace ? start->surface : surfaces_.patches()[start->surface].face;
    return surfaces_.faces()[face].placed_face;
  }

  // The outward normal. At a pole or a collapsed edge it is the limit towards the middle of the patch.
  Vec3 NormalAt(const SolverPatch& patch, double u, double v) const {
    const Vec4* points = surfaces_.space(patch);
    // A step of this share of the way to the middle is too small to be seen.
    constexpr double kSteps[] = {0, 0x1p-20, 0x1p-10, 0x1p-5, 0.5};
    // Products of derivatives below this share of the square of the patch's size have no correct digits.
    constexpr double kNothing = 0x1p-44;
    for (const double step : kSteps) {
      const PatchJet<4> jet = EvaluatePatch<4>(&points->x, patch.degree_u, patch.degree_v,
                                               u + step * (0.5 - u), v + step * (0.5 - v));
      const double inverse = 1 / jet.value[3];
      const Vec3 s = inverse * Vec3{jet.value[0], jet.value[1], jet.value[2]};
      const Vec3 su = inverse * (Vec3{jet.du[0], jet.du[1], jet.du[2]} - jet.du[3] * s),
                 sv = inverse * (Vec3{jet.dv[0], jet.dv[1], jet.dv[2]} - jet.dv[3] * s);
      const Vec3 normal = Cross(su, sv);
      const double size = std::max(Dot(su, su), Dot(sv, sv));
      if (Dot(normal, normal) > kNothing * kNothing * size * size)
        return surfaces_.faces()[patch.face].outward * Normalized(normal);
    }
    return {0, 0, 1};
  }

  const Camera& camera_;
  const CameraFrame frame_;
  const SolverInfo& info_;
  const SolverOptions& options_;
  const SolverTraceRequest& request_;
  const bool perspective_;
  const SolverStarts starts_;
  SolverScene surfaces_;
  std::unique_ptr<const Solver> solver_;
  std::optional<AnyStructure> structure_;
  std::uint64_t structure_bytes_ = 0;
  std::optional<ValueMap> map_;
  double nearest_depth_ = INFINITY, farthest_depth_ = -INFINITY;
};

// Traces the samples of the pixels that the request names.
Result<Refinement> Refine(const Scene& scene, const Camera& camera, const CameraFrame& frame,
                          const SolverInfo& info, const SolverOptions& options,
                          const SolverTraceRequest& request, const SampleBuffer& centres) {
  const RefineRequest& refine = *request.refine;
  PixelSet pixels(camera.width_px, camera.height_px);
  refine.picker->Pick(centres, frame, &pixels);
  pixels.Finish();
  Refinement refinement{refine.grid, {}, std::move(pixels), {}};
  const Camera fine = camera.Supersampled(refine.grid.x, refine.grid.y);
  const Result<CameraFrame> fine_frame = MakeFrame(fine, scene.model().Diagonal());
  if (!fine_frame.ok()) return fine_frame.error();
  refinement.frame = fine_frame.value();
  SolverView view(scene, fine, refinement.frame, info, options, request);
  if (auto prepared = view.Prepare(scene); !prepared.ok()) return prepared.error();
  SampleBuffer& samples = refinement.samples;
  samples.Resize(refine.grid.count(), static_cast<int>(refinement.pixels.size()));
  if (refine.ray_starts) {
    samples.uv.resize(samples.size());
    samples.certificate.assign(samples.size(), Certificate::kConverged);
  }
  PerThread<Worker> workers([&] { return view.MakeWorker(); });
  ParallelFor(0, fine.height_px, [&](int row) {
    if (request.execution.cancelled()) return;
    const int pixel_row = row / refine.grid.y;
    view.TraceRow(
        row, workers.local(),
        [&](int column) { return refinement.pixels.Has(column / refine.grid.x, pixel_row); },
        [&](int column, const NearestHit& hit, std::uint32_t, bool resolved) {
          const std::size_t rank = refinement.pixels.Rank(column / refine.grid.x, pixel_row);
          const int place = row % refine.grid.y * refine.grid.x + column % refine.grid.x;
          view.WriteSample(
              hit, resolved,
              rank * static_cast<std::size_t>(refine.grid.count()) + static_cast<std::size_t>(place),
              &samples);
        });
  });
  if (request.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while tracing"};
  return refinement;
}

Result<SolverTrace> Trace(const Scene& scene, const Camera& camera, const SolverInfo& info,
                          const SolverOptions& options, const SolverTraceRequest& request) {
  const Stopwatch preparing;
  SolverTrace traced;
  const Result<CameraFrame> frame = MakeFrame(camera, scene.model().Diagonal());
  if (!frame.ok()) return frame.error();
  traced.frame = frame.value();
  SolverView view(scene, camera, traced.frame, info, options, request);
  if (auto prepared = view.Prepare(scene); !prepared.ok()) return prepared.error();
  traced.stats.prepare_ms = preparing.Milliseconds();

  const Stopwatch tracing;
  SampleBuffer& samples = traced.samples;
  samples.Resize(camera.width_px, camera.height_px);
  samples.certificate.resize(samples.size());
  samples.doubt.resize(samples.size());
  if (request.uv) samples.uv.resize(samples.size());
  if (view.has_map()) traced.start_face.resize(samples.size());
  PerThread<Worker> workers([&] { return view.MakeWorker(); });
  ParallelFor(0, camera.height_px, [&](int row) {
    if (request.execution.cancelled()) return;
    view.TraceRow(
        row, workers.local(), [](int) { return true; },
        [&](int column, const NearestHit& hit, std::uint32_t start_face, bool resolved) {
          const std::size_t out = static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width_px) +
                                  static_cast<std::size_t>(column);
          view.WriteSample(hit, resolved, out, &samples);
          if (view.has_map()) traced.start_face[out] = start_face;
        });
  });
  if (request.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while tracing"};
  traced.stats.trace_ms = tracing.Milliseconds();
  traced.stats.rays = samples.size();
  view.FillStats(scene, workers, &traced.stats);

  if (request.refine != nullptr) {
    const Stopwatch refining;
    Result<Refinement> refined = Refine(scene, camera, traced.frame, info, options, request, samples);
    if (!refined.ok()) return refined.error();
    traced.refinement = std::move(refined).value();
    traced.stats.refine_ms = refining.Milliseconds();
  }
  return traced;
}

}  // namespace

Result<SolverTrace> TraceWithSolver(const Scene& scene, const Camera& camera, const SolverInfo& info,
                                    const SolverOptions& options, const SolverTraceRequest& request) {
  std::optional<Result<SolverTrace>> result;
  RunWithThreads(request.execution.threads, [&] { result = Trace(scene, camera, info, options, request); });
  return *std::move(result);
}

}  // namespace facetless
