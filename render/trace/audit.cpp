#include "render/trace/audit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "render/base/parallel.h"
#include "render/trace/tile_tracer.h"

namespace facetless {
namespace {

// The roots of one view, sorted by sample and depth, twins removed.
std::vector<AuditHit> Collect(const Scene::Data& scene, const PreparedView& view, const Camera& camera,
                              const CameraFrame& frame, TileKernel kernel) {
  const TraceShared shared(scene, view, camera, frame);
  struct Worker {
    Worker(const TraceShared& s, TileKernel k) : tracer(s, k, /*certify=*/false) {}
    TileTracer tracer;
    std::vector<Crossing> crossings;
  };
  PerThread<Worker> workers([&] { return Worker(shared, kernel); });
  ParallelFor(0, view.tiles->tiles_x() * view.tiles->tiles_y(), [&](int tile) {
    Worker& worker = workers.local();
    worker.tracer.Trace(tile, &worker.crossings);
  });

  std::vector<AuditHit> hits;
  for (const Worker& worker : workers) {
    for (const Crossing& crossing : worker.crossings) {
      hits.push_back({crossing.sample, view.tiles->leaves().Header(crossing.leaf).placed_face,
                      RootTwin(view, crossing.leaf, crossing.hit)});
    }
  }
  const auto key = [](const AuditHit& h) { return std::tie(h.sample, h.placed_face, h.root.depth); };
  ParallelSort(hits.begin(), hits.end(),
               [&](const AuditHit& a, const AuditHit& b) { return key(a) < key(b); });
  const auto twin = [](const AuditHit& a, const AuditHit& b) {
    return a.sample == b.sample && a.placed_face == b.placed_face && a.root.Is(b.root);
  };
  hits.erase(std::unique(hits.begin(), hits.end(), twin), hits.end());
  return hits;
}

// The samples whose rays cross some placed closed solid an odd number of times.
std::vector<std::uint32_t> OddSamples(const Model& model, const std::vector<AuditHit>& hits) {
  std::vector<std::uint32_t> odd;
  std::vector<std::pair<std::uint32_t, std::uint32_t>>
      solids;  // (instance, solid) of each crossing of the sample
  for (std::size_t i = 0; i < hits.size();) {
    const std::uint32_t sample = hits[i].sample;
    solids.clear();
    for (; i < hits.size() && hits[i].sample == sample; ++i) {
      const std::uint32_t solid = model.faces[model.FaceOfPlacedFace(hits[i].placed_face)].solid;
      if (solid != kNoIndex && model.solids[solid].closed)
        solids.emplace_back(model.InstanceOfPlacedFace(hits[i].placed_face), solid);
    }
    std::sort(solids.begin(), solids.end());
    for (std::size_t k = 0; k < solids.size();) {
      std::size_t end = k;
      while (end < solids.size() && solids[end] == solids[k]) ++end;
      if ((end - k) % 2 != 0) {
        odd.push_back(sample);
        break;
      }
      k = end;
    }
  }
  return odd;
}

}  // namespace

Result<AuditResult> Audit(const Scene::Data& scene, const PreparedView& view, const Camera& camera,
                          const CameraFrame& frame, TileKernel kernel, const DirectOptions& options) {
  const Model& model = *scene.model;
  AuditResult result;
  result.has_closed_solid = scene.has_closed_solid;
  std::vector<AuditHit> forward = Collect(scene, view, camera, frame, kernel);
  result.crossings = forward.size();
  result.odd_samples = OddSamples(model, forward);

  // Trace the same lines from behind. Columns run in the opposite direction, and so do orthographic depths.
  CameraFrame behind = frame;
  behind.right = -frame.right;
  const bool orthographic = frame.projection == Projection::kOrthographic;
  if (orthographic) behind.forward = -frame.forward;
  const Result<PreparedView> opposite = PrepareView(scene, camera, behind, options);
  if (!opposite.ok()) return opposite.error();
  std::vector<AuditHit> backward = Collect(scene, opposite.value(), camera, behind, kernel);
  for (AuditHit& hit : backward) {
    const std::uint32_t row = hit.sample / camera.width_px, column = hit.sample % camera.width_px;
    hit.sample = row * camera.width_px + (camera.width_px - 1 - column);
    if (orthographic) hit.root.depth = -hit.root.depth;
  }

  // Compare sample by sample: the sorted depths must agree one by one.
  const auto by_depth = [](const AuditHit& a, const AuditHit& b) {
    return std::tie(a.sample, a.root.depth) < std::tie(b.sample, b.root.depth);
  };
  ParallelSort(forward.begin(), forward.end(), by_depth);
  ParallelSort(backward.begin(), backward.end(), by_depth);
  const double tolerance = kReverseTolerance * model.Diagonal();
  std::size_t i = 0, j = 0;
  while (i < forward.size() || j < backward.size()) {
    const std::uint32_t sample = std::min(i < forward.size() ? forward[i].sample : kNoIndex,
                                          j < backward.size() ? backward[j].sample : kNoIndex);
    bool same = true;
    for (;;) {
      const bool more_i = i < forward.size() && forward[i].sample == sample,
                 more_j = j < backward.size() && backward[j].sample == sample;
      if (!more_i && !more_j) break;
      if (more_i != more_j || !(std::fabs(forward[i].root.depth - backward[j].root.depth) <= tolerance))
        same = false;
      i += more_i;
      j += more_j;
    }
    if (!same) result.mismatched_samples.push_back(sample);
  }

  // Keep only the crossings of odd and mismatched samples.
  const auto in_question = [&](const AuditHit& hit) {
    const auto among = [&](const std::vector<std::uint32_t>& samples) {
      return std::binary_search(samples.begin(), samples.end(), hit.sample);
    };
    return among(result.odd_samples) || among(result.mismatched_samples);
  };
  std::copy_if(forward.begin(), forward.end(), std::back_inserter(result.forward), in_question);
  std::copy_if(backward.begin(), backward.end(), std::back_inserter(result.backward), in_question);
  return result;
}

}  // namespace facetless
