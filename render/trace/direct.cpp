#include "render/trace/direct.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/kernels/dispatch.h"
#include "render/trace/audit.h"
#include "render/trace/hit_geometry.h"
#include "render/trace/prepare.h"
#include "render/trace/section_tracer.h"
#include "render/trace/tally.h"
#include "render/trace/thin_parts.h"
#include "render/trace/tile_tracer.h"

namespace facetless {
namespace {

// The leaf that a sample shows: its neighbours mostly show the same one.
class ShownLeaf {
 public:
  explicit ShownLeaf(const TraceShared& shared) : shared_(shared), leaves_(shared.view.tiles->leaves()) {}

  const TraceShared::LeafSite& Site(std::uint32_t leaf) {
    if (site_.leaf != leaf) site_ = shared_.SiteOf(leaf);
    return site_;
  }

  struct Face {
    std::uint32_t placed_face = kNoIndex;
    float outward = 1;
  };
  const Face& FaceOfPlacedFace(std::uint32_t leaf) {
    if (leaf != of_) LookUp(leaf);
    return face_;
  }

 private:
  [[gnu::noinline]] void LookUp(std::uint32_t leaf) {
    of_ = leaf;
    const std::uint32_t placed_face = leaves_.Header(leaf).placed_face;
    if (placed_face != face_.placed_face) face_ = {placed_face, float(shared_.Placed(placed_face).outward)};
  }

  const TraceShared& shared_;
  const LeafSpans leaves_;
  TraceShared::LeafSite site_;
  std::uint32_t of_ = kNoIndex;
  Face face_;
};

// Verifies the root of sample `k` of a tile with the independent check, if it is certified and belongs to the
// share that is checked. Roots of hard leaves have already been verified.
std::uint8_t CheckSample(const TraceShared& shared, const TileTracer& tile, int k, int column, int row,
                         ShownLeaf* shown, CheckStats* stats) {
  if (!shared.check || !shared.IsRootChecked(column, row) || tile.doubt[k] != 0 || tile.leaf[k] == kNoIndex)
    return 0;
  const std::uint32_t id = tile.leaf[k];
  if (KindOf(id) != LeafKind::kCertified) return 0;
  const double root_error = shared.view.tiles->leaves().certified[id].RootError(shared.view.arithmetic);
  const double x = column + 0.5 - shared.frame.center_x, y = row + 0.5 - shared.frame.center_y;
  return shared.CheckRoot(shown->Site(id), {tile.s[k], tile.t[k], root_error, root_error}, x, y,
                          tile.depth[k], tile.error[k], stats);
}

// Verifies with the independent check that the rays of some samples of a tile, hits and misses, are clear up
// to the stated depth. Samples whose rays are not clear get the doubt kDoubtContradicted.
void CheckRays(const TraceShared& shared, const TileTracer& tile, SampleBuffer* samples, Tally* tally) {
  if (!shared.check) return;
  // Check a fixed number of rays of every tile, or one ray of every n-th tile, at positions that are the same
  // on every machine.
  const int rays = std::max(1, TileTracer::kSamples / shared.rays_per_checked_ray);
  const std::uint32_t tiles =
      static_cast<std::uint32_t>(std::max(1, shared.rays_per_checked_ray / TileTracer::kSamples));
  constexpr std::uint32_t kFactor = 2654435761u;  // D. Knuth's multiplicative hash
  const auto scrambled = [](std::uint32_t number) { return number * kFactor >> 8; };
  const std::uint32_t number = scrambled(static_cast<std::uint32_t>(tile.row()) * 4096u +
                                         static_cast<std::uint32_t>(tile.column()) / kTileSize);
  if (number % tiles != 0) return;
  for (int ray = 0; ray < rays; ++ray) {
    const std::uint32_t place = scrambled(number + static_cast<std::uint32_t>(ray));
    const int i = static_cast<int>(place / kTileSize % kTileSize), j = static_cast<int>(place % kTileSize);
    if (i >= tile.rows() || j >= tile.columns()) continue;
    const int column = tile.column() + j, row = tile.row() + i;
    const std::size_t out = std::size_t(row) * samples->width + column;
    if (samples->certificate[out] != Certificate::kCertified) continue;
    const bool hit = samples->face[out] != kNoIndex;
    const double error = hit ? tile.error[i * kTileSize + j] : 0;
    ++tally->check.rays;
    const RayCheck answer = shared.check->CheckRay(column + 0.5, row + 0.5, samples->depth[out], error);
    tally->check.rays_open += answer == RayCheck::kOpen;
    if (answer != RayCheck::kContradicted) continue;
    ++tally->check.rays_contradicted;
    samples->doubt[out] = kDoubtContradicted;
    samples->certificate[out] = CertificateForDoubt(kDoubtContradicted);
    tally->AddDoubts(kDoubtContradicted);
    --tally->certified;
    tally->certified_hits -= hit;
  }
}

// The normal of the hit `k` of a traced tile, for which the kernel has none.
[[gnu::noinline]] std::array<float, 3> NormalAlone(const TraceShared& shared, const TileTracer& tile, int k,
                                                   int column, int row) {
  const double x = column + 0.5 - 0.5 * shared.camera.width_px, y = row + 0.5 - 0.5 * shared.camera.height_px;
  const Vec3 normal = shared.HitAt(tile.leaf[k], tile.s[k], tile.t[k], x, y).normal;
  return {float(normal.x), float(normal.y), float(normal.z)};
}

// Copies the hit `k` of a traced tile, of the sample (column, row) of the view, to entry `out` of the samples.
inline void WriteHit(const TraceShared& shared, const TileTracer& tile, int k, int column, int row,
                     ShownLeaf* shown, std::size_t out, SampleBuffer* samples) {
  const std::uint32_t leaf = tile.leaf[k];
  const ShownLeaf::Face& face = shown->FaceOfPlacedFace(leaf);
  std::array<float, 3> normal = tile.normal[k];
  if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0) normal = NormalAlone(shared, tile, k, column, row);
  const float outward = face.outward;
  samples->depth[out] = tile.depth[k];
  samples->face[out] = face.placed_face;
  samples->normal[out] = {outward * normal[0], outward * normal[1], outward * normal[2]};
}

// Copies what was requested of the sample `k` of a traced tile beyond that: of a hit, or the values of a miss.
void WriteRequested(const TileTracer& tile, int k, ShownLeaf* shown, std::size_t out, SampleBuffer* samples) {
  const bool hit = tile.leaf[k] != kNoIndex;
  if (!samples->uv.empty()) {
    samples->uv[out] = {0, 0};
    if (hit) {
      const TraceShared::LeafSite& site = shown->Site(tile.leaf[k]);
      samples->uv[out] = {site.u_map->ToNative(site.U(tile.s[k])), site.v_map->ToNative(site.V(tile.t[k]))};
    }
  }
  if (!samples->depth_error.empty()) samples->depth_error[out] = hit ? RoundedUp(tile.error[k]) : 0;
}

// Copies row `i` of a traced tile into the image, with the normals and parameters of its hits.
void WriteRow(const TraceShared& shared, const TileTracer& tile, int i, ShownLeaf* shown,
              SampleBuffer* samples, Tally* tally) {
  const int count = tile.columns(), row = tile.row() + i, k0 = i * kTileSize;
  const std::size_t out0 = std::size_t(row) * samples->width + tile.column();

  // Copy what each sample has. The depth of a miss is infinite already.
  std::array<std::uint8_t, kTileSize> doubts;
  std::copy_n(tile.doubt.data() + k0, kTileSize, doubts.data());
  if (shared.check) {
    for (int j = 0; j < count; ++j)
      doubts[j] |= CheckSample(shared, tile, k0 + j, tile.column() + j, row, shown, &tally->check);
  }
  std::copy_n(tile.depth.data() + k0, count, samples->depth.data() + out0);
  std::copy_n(doubts.data(), count, samples->doubt.data() + out0);
  int certified = 0;
  for (int j = 0; j < count; ++j) {
    samples->certificate[out0 + j] = CertificateForDoubt(doubts[j]);
    certified += doubts[j] == 0;
  }
  tally->certified += certified;
  for (int j = 0; certified < count && j < count; ++j) tally->AddDoubts(doubts[j]);

  // Find the face and the normal of each hit.
  std::uint64_t hits = 0, certified_hits = 0;
  double greatest_error = tally->depth_error_max;
  for (int j = 0; j < count; ++j) {
    const int k = k0 + j;
    if (tile.leaf[k] == kNoIndex) {
      samples->face[out0 + j] = kNoIndex;
      samples->normal[out0 + j] = {0, 0, 0};
      continue;
    }
    WriteHit(shared, tile, k, tile.column() + j, row, shown, out0 + j, samples);
    ++hits;
    if (doubts[j] != 0) continue;
    ++certified_hits;
    greatest_error = std::max(greatest_error, tile.error[k]);
  }
  tally->hits += hits;
  tally->certified_hits += certified_hits;
  tally->depth_error_max = greatest_error;

  if (samples->uv.empty() && samples->depth_error.empty()) return;
  for (int j = 0; j < count; ++j) WriteRequested(tile, k0 + j, shown, out0 + j, samples);
}

// Writes the rows of a tile that no leaf meets.
void WriteEmptyTile(const TileTracer& tile, SampleBuffer* samples, Tally* tally) {
  for (int i = 0; i < tile.rows(); ++i) {
    const std::size_t first = std::size_t(tile.row() + i) * samples->width + tile.column();
    std::fill_n(samples->depth.begin() + first, tile.columns(), INFINITY);
    std::fill_n(samples->normal.begin() + first, tile.columns(), std::array<float, 3>{0, 0, 0});
    std::fill_n(samples->face.begin() + first, tile.columns(), kNoIndex);
    std::fill_n(samples->certificate.begin() + first, tile.columns(), Certificate::kCertified);
    std::fill_n(samples->doubt.begin() + first, tile.columns(), std::uint8_t{0});
    if (!samples->depth_error.empty())
      std::fill_n(samples->depth_error.begin() + first, tile.columns(), 0.0f);
    if (!samples->uv.empty())
      std::fill_n(samples->uv.begin() + first, tile.columns(), std::array<double, 2>{0, 0});
  }
  tally->certified += std::uint64_t(tile.rows()) * tile.columns();
}

// Copies a traced tile into the image.
void WriteTile(const TraceShared& shared, const TileTracer& tile, SampleBuffer* samples, Tally* tally) {
  if (tile.empty()) {
    WriteEmptyTile(tile, samples, tally);
  } else {
    ShownLeaf shown(shared);
    for (int i = 0; i < tile.rows(); ++i) WriteRow(shared, tile, i, &shown, samples, tally);
  }
  // That no leaf is visible somewhere must be verified, too.
  CheckRays(shared, tile, samples, tally);
}

CheckLevel ResolveCheckLevel(const DirectOptions& options) {
  if (options.leave_out) return CheckLevel::kNone;  // the check cannot ignore faces
  if (options.accuracy.check != CheckLevel::kAuto) return options.accuracy.check;
  if (options.audit) return CheckLevel::kAll;
  return options.accuracy.precision == Precision::kCertified ? CheckLevel::kShare : CheckLevel::kNone;
}

// Finds the samples of a tile that belong to refined pixels: a bit per column for each row. Returns false if there
// are none.
bool FindActiveSamples(const PixelSet& pixels, SampleGrid grid, int first_column, int first_row,
                       std::array<std::uint32_t, kTileSize>* active) {
  const int first_pixel = first_column / grid.x,
            end_pixel = std::min((first_column + kTileSize - 1) / grid.x + 1, pixels.width());
  constexpr std::uint64_t kAll = (std::uint64_t{1} << kTileSize) - 1;
  const std::uint64_t samples_of_pixel = (std::uint64_t{1} << grid.x) - 1;
  bool any = false;
  int previous = -1;
  for (int i = 0; i < kTileSize; ++i) {
    const int row = (first_row + i) / grid.y;
    if (i > 0 && row == previous) {
      (*active)[i] = (*active)[i - 1];
      continue;
    }
    previous = row;
    std::uint64_t bits = 0;
    for (int column = first_pixel; row < pixels.height() && column < end_pixel; ++column) {
      if (!pixels.Has(column, row)) continue;
      const int shift = column * grid.x - first_column;
      bits |= shift >= 0 ? samples_of_pixel << shift : samples_of_pixel >> -shift;
    }
    (*active)[i] = static_cast<std::uint32_t>(bits & kAll);
    any |= (*active)[i] != 0;
  }
  return any;
}

// Traces the samples of the pixels that the request names for a view whose centres have been traced.
class Refiner {
 public:
  Refiner(const Scene& scene, const Camera& camera, const CameraFrame& frame, const PreparedView& view,
          TileKernel kernel, const DirectOptions& options)
      : scene_(scene),
        camera_(camera),
        frame_(frame),
        view_(view),
        kernel_(kernel),
        options_(options),
        grid_(options.refine->grid) {}

  // Adds the memory of the samples' leaves and bitmaps to *bytes.
  Result<Refinement> Refine(const SampleBuffer& centres, std::uint64_t* bytes) const {
    PixelSet pixels(camera_.width_px, camera_.height_px);
    options_.refine->picker->Pick(centres, frame_, &pixels);
    MarkThinParts(scene_.data(), view_, frame_, centres, &pixels);
    pixels.Finish();
    Refinement refinement{grid_, {}, std::move(pixels), {}};
    const Camera fine = camera_.Supersampled(grid_.x, grid_.y);
    if (auto frame = MakeFrame(fine, scene_.model().Diagonal()); frame.ok()) {
      refinement.frame = frame.value();
    } else {
      return frame.error();
    }
    Result<PreparedView> prepared =
        PrepareRefinement(scene_.data(), view_, fine, refinement.frame, grid_, refinement.pixels, options_);
    if (!prepared.ok()) return prepared.error();
    refinement.samples.Resize(grid_.count(), static_cast<int>(refinement.pixels.size()));
    if (options_.refine->ray_starts) {
      refinement.samples.uv.resize(refinement.samples.size());
      refinement.samples.depth_error.resize(refinement.samples.size());
      refinement.samples.certificate.assign(refinement.samples.size(), Certificate::kCertified);
    }
    *bytes += prepared.value().bytes() + TraceSamples(prepared.value(), fine, &refinement);
    if (options_.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while tracing"};
    return refinement;
  }

 private:
  // Returns the memory of the bitmaps.
  std::uint64_t TraceSamples(const PreparedView& prepared, const Camera& fine, Refinement* refinement) const {
    const TraceShared shared(scene_.data(), prepared, fine, refinement->frame);
    PerThread<TileTracer> tracers([&] { return TileTracer(shared, kernel_, /*certify=*/false); });
    ParallelFor(0, prepared.tiles->tiles_x() * prepared.tiles->tiles_y(), [&](int tile) {
      if (options_.execution.cancelled() || prepared.tiles->Tile(tile).empty()) return;
      std::array<std::uint32_t, kTileSize> active;
      const int column = tile % prepared.tiles->tiles_x() * kTileSize,
                row = tile / prepared.tiles->tiles_x() * kTileSize;
      if (!FindActiveSamples(refinement->pixels, grid_, column, row, &active)) return;
      TileTracer& tracer = tracers.local();
      tracer.Trace(tile, nullptr, active.data());
      WriteSamples(shared, tracer, active, refinement);
    });
    std::uint64_t bytes = 0;
    for (const TileTracer& tracer : tracers) bytes += tracer.bitmap_bytes();
    return bytes;
  }

  void WriteSamples(const TraceShared& shared, const TileTracer& tile,
                    const std::array<std::uint32_t, kTileSize>& active, Refinement* refinement) const {
    ShownLeaf shown(shared);
    for (int i = 0; i < tile.rows(); ++i) {
      for (std::uint32_t rest = active[i]; rest != 0; rest &= rest - 1) {
        const int j = __builtin_ctz(rest), k = i * kTileSize + j;
        if (tile.leaf[k] == kNoIndex) continue;
        const int column = tile.column() + j, row = tile.row() + i;
        const std::size_t rank = refinement->pixels.Rank(column / grid_.x, row / grid_.y);
        const std::size_t out = rank * static_cast<std::size_t>(grid_.count()) +
                                static_cast<std::size_t>(row % grid_.y * grid_.x + column % grid_.x);
        WriteHit(shared, tile, k, column, row, &shown, out, &refinement->samples);
        WriteRequested(tile, k, &shown, out, &refinement->samples);
        if (!refinement->samples.certificate.empty())
          refinement->samples.certificate[out] = CertificateForDoubt(tile.doubt[k]);
      }
    }
  }

  const Scene& scene_;
  const Camera& camera_;
  const CameraFrame& frame_;
  const PreparedView& view_;
  const TileKernel kernel_;
  const DirectOptions& options_;
  const SampleGrid grid_;
};

// Adds up the counters of all threads.
void AddCounters(const PerThread<Tally>& tallies, const PerThread<TileTracer>& tracers, DirectStats* total) {
  DirectStats& stats = *total;
  for (const Tally& tally : tallies) {
    stats.hits += tally.hits;
    stats.certified += tally.certified;
    stats.converged += tally.converged;
    stats.unresolved += tally.unresolved;
    stats.certified_hits += tally.certified_hits;
    stats.caps += tally.caps;
    stats.check.Add(tally.check);
    for (std::size_t bit = 0; bit < tally.doubts.size(); ++bit) stats.doubts[bit] += tally.doubts[bit];
    stats.depth_error_max = std::max(stats.depth_error_max, tally.depth_error_max);
  }
  for (const TileTracer& tracer : tracers) {
    stats.candidates += tracer.counters.candidates;
    stats.solves += tracer.counters.solves;
    stats.iterations += tracer.counters.iterations;
    stats.fallbacks += tracer.counters.fallbacks;
    stats.trim_tests += tracer.counters.trim_tests;
    stats.check.Add(tracer.check);
    stats.bmssm_bytes += tracer.bitmap_bytes();
  }
}

// Fills in what the stats say of a prepared view. Requires the bytes of the bitmaps.
void FillViewStats(const PreparedView& view, const Scene& scene, DirectStats* total) {
  DirectStats& stats = *total;
  stats.leaves = view.tiles->leaves().size();
  stats.hard_leaves = view.tiles->leaves().hard.size();
  stats.bmssm_bits = view.tiles->bits();
  stats.scene_bytes = view.bytes() + stats.bmssm_bytes + scene.data().bytes();
  stats.unseen_faces = view.unseen_faces;
}

Result<DirectResult> Trace(const Scene& scene, const Camera& camera, const DirectOptions& options) {
  const Stopwatch stopwatch;
  DirectResult result;
  if (auto sound = CheckSections(options.sections); !sound.ok()) return sound.error();
  if (options.refine != nullptr && !options.sections.empty())
    return Error{ErrorCode::kBadUsage, "views with section planes cannot be refined"};
  if (auto frame = MakeFrame(camera, scene.model().Diagonal()); frame.ok()) {
    result.frame = frame.value();
  } else {
    return frame.error();
  }
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels.ok()) return kernels.error();
  result.stats.isa = kernels.value().isa;
  const TileKernel kernel = options.accuracy.precision == Precision::kFast ? kernels.value().trace_tile_float
                                                                           : kernels.value().trace_tile;
  const bool certify = options.accuracy.precision == Precision::kCertified;

  // Project, split, list per tile.
  Result<PreparedView> prepared = PrepareView(scene.data(), camera, result.frame, options);
  if (!prepared.ok()) return prepared.error();
  const PreparedView& view = prepared.value();
  TraceShared shared(scene.data(), view, camera, result.frame);
  std::optional<CertificateCheck> check;
  if (const CheckLevel level = ResolveCheckLevel(options); level != CheckLevel::kNone) {
    check.emplace(scene.data(), result.frame);
    shared.check = &*check;
    shared.roots_per_checked_root = level == CheckLevel::kAll ? 1 : kRootsPerCheckedRoot;
    shared.rays_per_checked_ray = level == CheckLevel::kAll ? kRaysPerAuditedRay : kRaysPerCheckedRay;
  }
  result.stats.prepare_ms = stopwatch.Milliseconds();

  // Trace tile by tile.
  const Stopwatch tracing;
  SampleBuffer& samples = result.samples;
  samples.Allocate(camera.width_px, camera.height_px);
  samples.certificate.resize(samples.size());
  samples.doubt.resize(samples.size());
  if (options.depth_error) samples.depth_error.resize(samples.size());
  if (options.uv) samples.uv.resize(samples.size());
  PerThread<TileTracer> tracers([&] { return TileTracer(shared, kernel, certify); });
  PerThread<Tally> tallies;
  if (options.sections.empty()) {
    ParallelFor(0, view.tiles->tiles_x() * view.tiles->tiles_y(), [&](int tile) {
      if (options.execution.cancelled()) return;
      TileTracer& tracer = tracers.local();
      tracer.Trace(tile, nullptr);
      WriteTile(shared, tracer, &samples, &tallies.local());
    });
  } else {
    const SectionSolids solids(scene.model());
    PerThread<SectionTracer> sections(
        [&] { return SectionTracer(shared, options.sections, solids, certify); });
    ParallelFor(0, view.tiles->tiles_x() * view.tiles->tiles_y(), [&](int tile) {
      if (options.execution.cancelled()) return;
      sections.local().Trace(tile, &tracers.local(), &samples, &tallies.local());
    });
  }
  if (options.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while tracing"};
  result.stats.trace_ms = tracing.Milliseconds();
  if (options.refine != nullptr) {
    const Stopwatch refining;
    Result<Refinement> refined = Refiner(scene, camera, result.frame, view, kernel, options)
                                     .Refine(samples, &result.stats.refine_bytes);
    if (!refined.ok()) return refined.error();
    result.refinement = std::move(refined).value();
    result.stats.refine_ms = refining.Milliseconds();
  }

  AddCounters(tallies, tracers, &result.stats);
  result.stats.rays = samples.size();
  FillViewStats(view, scene, &result.stats);

  // Count all crossings, if an audit is requested.
  if (options.audit) {
    Result<AuditResult> audit = Audit(scene.data(), view, camera, result.frame, kernel, options);
    if (!audit.ok()) return audit.error();
    DirectStats& stats = result.stats;
    if (audit.value().has_closed_solid) stats.odd_rays = audit.value().odd_samples.size();
    stats.reverse_mismatches = audit.value().mismatched_samples.size();
    stats.odd_samples = std::move(audit.value().odd_samples);
    stats.mismatched_samples = std::move(audit.value().mismatched_samples);
  }
  return result;
}

}  // namespace

Result<DirectResult> TraceDirect(const Scene& scene, const Camera& camera, const DirectOptions& options) {
  std::optional<Result<DirectResult>> result;
  RunWithThreads(options.execution.threads, [&] { result = Trace(scene, camera, options); });
  return *std::move(result);
}

Result<std::string> ActiveIsa() {
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels.ok()) return kernels.error();
  return kernels.value().isa;
}

}  // namespace facetless
