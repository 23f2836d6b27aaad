#include "render/baseline/tracer.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <tuple>
#include <vector>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/baseline/packet_rays.h"
#include "render/baseline/scene_data.h"
#include "render/baseline/triangle_point.h"

namespace facetless {
namespace {

// Crossings of one ray in the same direction that are closer than this share of the diagonal are assumed to
// belong to triangles that share an edge. It is the resolution of float32, and no wall is thinner.
constexpr double kSameCrossing = 1e-6;

struct HitPoint {
  double depth = INFINITY;
  Vec3 normal;
};

// The point at which `ray` meets the triangle.
HitPoint Refine(const CameraFrame& frame, const Ray& ray, double start, const TriangleCorners& corners) {
  const TrianglePoint point = MeetTriangle(corners, ray.origin + start * ray.direction, ray.direction);
  HitPoint hit{0, point.normal};
  for (int k = 0; k < 3; ++k)
    hit.depth += point.weight[k] * Dot(corners.position[k] - frame.eye, frame.forward);
  return hit;
}

// A triangle that a ray meets.
struct MetTriangle {
  std::uint32_t node, triangle;
  HitPoint hit;
  bool leaving;  // the ray leaves the solid through the triangle
};

// Collects all triangles on a ray: the filter stores each one and lets the ray continue.
struct EveryTriangle {
  RTCIntersectContext context;  // must be the first member, because Embree passes it to the filter
  const BaselineScene::Data* data;
  std::vector<MetTriangle>* found;

  static void Filter(const RTCFilterFunctionNArguments* arguments) {
    auto* self = reinterpret_cast<EveryTriangle*>(arguments->context);
    if (arguments->valid[0] != -1) return;
    const unsigned instance = RTCHitN_instID(arguments->hit, arguments->N, 0, 0);
    const unsigned geometry =
        instance == RTC_INVALID_GEOMETRY_ID ? RTCHitN_geomID(arguments->hit, arguments->N, 0) : instance;
    self->found->push_back(
        {self->data->node_of_geometry[geometry], RTCHitN_primID(arguments->hit, arguments->N, 0), {}, false});
    arguments->valid[0] = 0;
  }
};

class TileTracer {
 public:
  TileTracer(const BaselineScene::Data& data, const CameraFrame& frame, SampleBuffer& out)
      : data_(data), frame_(frame), out_(out), start_(StartDepth(data, frame)) {}

  // Traces the pixels [x0, x1) × [y0, y1) of a view with sections, and returns the number of hits.
  std::uint64_t TraceCut(int x0, int x1, int y0, int y1, const BaselineOptions& options) const {
    std::vector<MetTriangle> met;
    std::vector<SolidCrossing> crossings;
    SectionDecision decision;
    std::uint64_t hits = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) hits += TraceCutRay(x, y, options, &met, &crossings, &decision);
    return hits;
  }

  // Traces the pixels [x0, x1) × [y0, y1) and returns the number of hits.
  std::uint64_t Trace(int x0, int x1, int y0, int y1) const {
    std::uint64_t hits = 0;
    for (int y = y0; y < y1; y += kPacket)
      for (int x = x0; x < x1; x += kPacket)
        hits += TracePacket(BlockOf(x, std::min(x + kPacket, x1), y, std::min(y + kPacket, y1)));
    return hits;
  }

  // Traces the samples [first, last) of refined pixels, which are the entries of the samples in that order.
  void TraceRefined(const PixelSet& pixels, SampleGrid grid, std::size_t first, std::size_t last) const {
    const auto count = static_cast<std::size_t>(grid.count());
    for (std::size_t i = first; i < last; i += kLanes) {
      Lanes lanes;
      lanes.count = static_cast<int>(std::min<std::size_t>(kLanes, last - i));
      for (int lane = 0; lane < lanes.count; ++lane) {
        const std::size_t sample = i + static_cast<std::size_t>(lane);
        lanes.at[lane] = PlaceOfSample(pixels.pixels()[sample / count], pixels.width(), grid,
                                       static_cast<int>(sample % count));
        lanes.out[lane] = sample;
      }
      TracePacket(lanes);
    }
  }

 private:
  static constexpr int kLanes = kPacket * kPacket;
  // The rays of a packet: their pixels, and where their hits are stored.
  struct Lanes {
    int count = 0;
    SamplePlace at[kLanes];
    std::size_t out[kLanes];
  };

  // The pixels [x0, x1) × [y0, y1), of which there are at most kLanes.
  Lanes BlockOf(int x0, int x1, int y0, int y1) const {
    Lanes lanes;
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        lanes.at[lanes.count] = {x, y};
        lanes.out[lanes.count++] = static_cast<std::size_t>(y) * out_.width + x;
      }
    }
    return lanes;
  }

  std::uint64_t TracePacket(const Lanes& lanes) const {
    // Fill the packet; lanes without a ray stay idle.
    alignas(64) int valid[kLanes];
    alignas(64) RTCRayHit16 packet;
    Ray rays[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      const bool inside = lane < lanes.count;
      const SamplePlace at = lanes.at[inside ? lane : 0];
      rays[lane] = PixelRay(frame_, at.column + 0.5, at.row + 0.5);
      const Vec3 origin = rays[lane].origin + start_ * rays[lane].direction - data_.center;
      valid[lane] = inside && Reaches(data_, origin, rays[lane].direction) ? -1 : 0;
      packet.ray.org_x[lane] = static_cast<float>(origin.x);
      packet.ray.org_y[lane] = static_cast<float>(origin.y);
      packet.ray.org_z[lane] = static_cast<float>(origin.z);
      packet.ray.dir_x[lane] = Coordinate(static_cast<float>(rays[lane].direction.x));
      packet.ray.dir_y[lane] = Coordinate(static_cast<float>(rays[lane].direction.y));
      packet.ray.dir_z[lane] = Coordinate(static_cast<float>(rays[lane].direction.z));
      packet.ray.tnear[lane] = 0;
      packet.ray.tfar[lane] = INFINITY;
      packet.ray.time[lane] = 0;
      packet.ray.mask[lane] = 0xffffffffu;
      packet.ray.id[lane] = static_cast<unsigned>(lane);
      packet.ray.flags[lane] = 0;
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }

    // Find the triangles.
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, data_.scene, &context, &packet);

    // Compute the points again in double.
    std::uint64_t hits = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      if (valid[lane] == 0 || packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      const unsigned instance = packet.hit.instID[0][lane];
      const unsigned geometry = instance == RTC_INVALID_GEOMETRY_ID ? packet.hit.geomID[lane] : instance;
      Store(lanes.out[lane], rays[lane], data_.node_of_geometry[geometry], packet.hit.primID[lane]);
      ++hits;
    }
    return hits;
  }

  bool TraceCutRay(int x, int y, const BaselineOptions& options, std::vector<MetTriangle>* met,
                   std::vector<SolidCrossing>* crossings, SectionDecision* decision) const {
    const Ray ray = PixelRay(frame_, x + 0.5, y + 0.5);
    const KeptInterval kept = ClipRayToSections(
        ray, options.sections, frame_.projection == Projection::kPerspective ? frame_.near_mm : -INFINITY);
    FindAllTriangles(ray, met);

    // Sort the triangles by depth, and merge those that share an edge.
    const auto solid_of = [&](const MetTriangle& m) {
      if (!data_.mesh->from_model) return m.node;
      return options.solids->ClosedSolidOfFace(PlacedFaceOf(data_, m.node, m.triangle));
    };
    std::sort(met->begin(), met->end(), [&](const MetTriangle& a, const MetTriangle& b) {
      return std::tuple(solid_of(a), a.hit.depth, a.node, a.triangle) <
             std::tuple(solid_of(b), b.hit.depth, b.node, b.triangle);
    });
    const double same = kSameCrossing * data_.bounds.diagonal();
    met->erase(std::unique(met->begin(), met->end(),
                           [&](const MetTriangle& a, const MetTriangle& b) {
                             return a.leaving == b.leaving && solid_of(a) == solid_of(b) &&
                                    b.hit.depth - a.hit.depth <= same;
                           }),
               met->end());
    std::sort(met->begin(), met->end(), [](const MetTriangle& a, const MetTriangle& b) {
      return std::tuple(a.hit.depth, a.node, a.triangle) < std::tuple(b.hit.depth, b.node, b.triangle);
    });
    crossings->clear();
    for (const MetTriangle& m : *met) crossings->push_back({m.hit.depth, data_.noise_mm, solid_of(m)});

    const SectionAnswer answer = decision->Decide(*crossings, kept);
    const std::size_t pixel = static_cast<std::size_t>(y) * out_.width + x;
    if (answer.kind == SectionAnswer::Kind::kMiss) return false;
    if (answer.kind == SectionAnswer::Kind::kCap) {
      const Vec3 normal = options.sections[kept.plane].normal;
      out_.depth[pixel] = kept.begin;
      out_.normal[pixel] = {static_cast<float>(normal.x), static_cast<float>(normal.y),
                            static_cast<float>(normal.z)};
      out_.face[pixel] = options.solids->CapId(kept.plane, data_.mesh->from_model ? answer.index : 0);
      return true;
    }
    const MetTriangle& nearest = (*met)[answer.index];
    Store(pixel, ray, nearest.node, nearest.triangle);
    return true;
  }

  // Finds all triangles that the ray meets, with their points.
  void FindAllTriangles(const Ray& ray, std::vector<MetTriangle>* met) const {
    met->clear();
    EveryTriangle every;
    rtcInitIntersectContext(&every.context);
    every.context.filter = EveryTriangle::Filter;
    every.data = &data_;
    every.found = met;
    const Vec3 origin = ray.origin + start_ * ray.direction - data_.center;
    if (!Reaches(data_, origin, ray.direction)) return;
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(origin.x);
    query.ray.org_y = static_cast<float>(origin.y);
    query.ray.org_z = static_cast<float>(origin.z);
    query.ray.dir_x = Coordinate(static_cast<float>(ray.direction.x));
    query.ray.dir_y = Coordinate(static_cast<float>(ray.direction.y));
    query.ray.dir_z = Coordinate(static_cast<float>(ray.direction.z));
    query.ray.tfar = INFINITY;
    query.ray.mask = 0xffffffffu;
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(data_.scene, &every.context, &query);
    for (MetTriangle& m : *met) {
      const TriangleCorners corners = LoadCorners(data_, m.node, m.triangle);
      m.hit = Refine(frame_, ray, start_, corners);
      m.leaving = Dot(corners.Facing(), ray.direction) > 0;
    }
  }

  void Store(std::size_t pixel, const Ray& ray, std::uint32_t node_index, std::uint32_t triangle) const {
    const HitPoint hit = Refine(frame_, ray, start_, LoadCorners(data_, node_index, triangle));
    out_.depth[pixel] = hit.depth;
    out_.normal[pixel] = {static_cast<float>(hit.normal.x), static_cast<float>(hit.normal.y),
                          static_cast<float>(hit.normal.z)};
    out_.face[pixel] = PlacedFaceOf(data_, node_index, triangle);
  }

  const BaselineScene::Data& data_;
  const CameraFrame& frame_;
  SampleBuffer& out_;
  const double start_;
};

// Traces the samples of the pixels that the request names for a view whose centres have been traced.
Result<Refinement> Refine(const BaselineScene& scene, const Camera& camera, const BaselineResult& centres,
                          const BaselineOptions& options) {
  const SampleGrid grid = options.refine->grid;
  PixelSet pixels(camera.width_px, camera.height_px);
  options.refine->picker->Pick(centres.samples, centres.frame, &pixels);
  pixels.Finish();
  const Result<CameraFrame> frame = MakeFrame(camera.Supersampled(grid.x, grid.y), scene.bounds().diagonal());
  if (!frame.ok()) return frame.error();
  Refinement refinement{grid, frame.value(), std::move(pixels), {}};
  refinement.samples.Resize(grid.count(), static_cast<int>(refinement.pixels.size()));
  const TileTracer tracer(scene.data(), refinement.frame, refinement.samples);
  constexpr std::size_t kBlock = 1024;  // samples
  RunWithThreads(options.execution.threads, [&] {
    ParallelForBlocks(0, refinement.samples.size(), kBlock, [&](std::size_t first, std::size_t last) {
      if (!options.execution.cancelled()) tracer.TraceRefined(refinement.pixels, grid, first, last);
    });
  });
  if (options.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  return refinement;
}

}  // namespace

Result<BaselineResult> TraceBaseline(const BaselineScene& scene, const Camera& camera,
                                     const BaselineOptions& options) {
  const Result<CameraFrame> frame = MakeFrame(camera, scene.bounds().diagonal());
  if (!frame.ok()) return frame.error();
  if (auto sound = CheckSections(options.sections); !sound.ok()) return sound.error();
  if (!options.sections.empty() && (options.solids == nullptr || !scene.data().to_be_cut))
    return Error{ErrorCode::kBadUsage,
                 "section planes need the model's solids, and a mesh prepared to be cut"};
  if (options.refine != nullptr && !options.sections.empty())
    return Error{ErrorCode::kBadUsage, "views with section planes cannot be refined"};
  const Stopwatch stopwatch;
  BaselineResult result;
  result.frame = frame.value();
  std::atomic<std::uint64_t> hits{0};
  try {
    result.samples.Resize(camera.width_px, camera.height_px);
    const TileTracer tracer(scene.data(), result.frame, result.samples);
    RunWithThreads(options.execution.threads, [&] {
      ParallelForTiles(
          camera.height_px, camera.width_px, kTile, [&](int row, int row_end, int column, int column_end) {
            if (options.execution.cancelled()) return;
            hits += options.sections.empty() ? tracer.Trace(column, column_end, row, row_end)
                                             : tracer.TraceCut(column, column_end, row, row_end, options);
          });
    });
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimitExceeded, "view '" + camera.name + "': its samples do not fit into memory"};
  }
  if (options.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  result.stats.trace_ms = stopwatch.Milliseconds();
  if (options.refine != nullptr) {
    const Stopwatch refining;
    Result<Refinement> refined = Refine(scene, camera, result, options);
    if (!refined.ok()) return refined.error();
    result.refinement = std::move(refined).value();
    result.stats.refine_ms = refining.Milliseconds();
  }

  result.stats.rays =
      static_cast<std::uint64_t>(camera.width_px) * static_cast<std::uint64_t>(camera.height_px);
  result.stats.hits = hits;
  result.stats.buffer_bytes =
      result.samples.size() * (sizeof(double) + 3 * sizeof(float) + sizeof(std::uint32_t));
  return result;
}

}  // namespace facetless
