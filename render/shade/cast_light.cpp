#include "render/shade/cast_light.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/shade/hemisphere.h"
#include "render/shade/sample_places.h"
#include "render/shade/studio.h"

namespace facetless {
namespace {

// About the number of rays in one call of FindBlocked, so few that their answers stay in the cache.
constexpr std::size_t kBatchRays = 2048;
constexpr std::size_t kMostBatchSamples = 256;
// The rounding error of a point that is computed from a ray and a depth, as a share of its coordinates: four roundings.
constexpr double kPointRounding = 0x1p-50;

// The samples of a view, or of refined pixels, and the ray of each.
template <typename PlaceOf>
struct LitSamples {
  const SampleBuffer& samples;
  const CameraFrame& frame;
  PlaceOf place;  // place(i): column and row of sample i
};

// The start of a sample's rays, on the side of the viewer. If `exists` is false, the sample has no rays.
struct LightStart {
  bool exists = false;
  bool ground = false;     // the start is a point of the ground
  bool certified = false;  // the hit of the view is certified; points of the ground always are
  RayStart at;
};

class LightCaster {
 public:
  LightCaster(const LightSetting& setting, const CameraFrame& frame)
      : setting_(setting),
        key_(TowardKeyLight(frame)),
        hemisphere_(std::max(1, setting.options.occlusion_rays)) {}

  // Casts the rays of the samples [first, last) and fills their entries of `light`.
  template <typename PlaceOf>
  void Cast(const LitSamples<PlaceOf>& lit, std::size_t first, std::size_t last, SampleLight* light,
            LightStats* stats) const {
    Batch batch;
    for (std::size_t i = first; i < last; ++i) {
      const LightStart start = StartOf(lit, i);
      if (setting_.options.ground) light->ground[i] = start.ground;
      const SamplePlace at = lit.place(i);
      AddRays(start, at, &batch);
    }
    batch.passages.resize(batch.rays.size());
    setting_.rays->FindBlocked(batch.starts, batch.rays, batch.passages);
    std::size_t ray = 0;
    for (std::size_t i = first; i < last; ++i) Gather(batch, i - first, &ray, i, light, stats);
  }

 private:
  // The rays of one sample: a shadow ray if its normal faces the light, and then occlusion rays. A ray that a section
  // plane cuts off at its start is not cast, because nothing can block it; it is counted in `free`.
  struct Item {
    bool exists = false, certified = false;
    bool shadow = false;  // a shadow ray is cast
    float key = 0;        // the share of the key light if no shadow ray is cast
    int occlusion = 0;    // number of occlusion rays that are cast
    int free = 0;         // number of occlusion rays that are not cast
  };
  struct Batch {
    std::vector<Item> items;
    std::vector<RayStart> starts;
    std::vector<SecondaryRay> rays;
    std::vector<RayPassage> passages;
  };

  template <typename PlaceOf>
  LightStart StartOf(const LitSamples<PlaceOf>& lit, std::size_t i) const {
    const SampleBuffer& samples = lit.samples;
    const SamplePlace place = lit.place(i);
    const double x = place.column + 0.5, y = place.row + 0.5;
    if (samples.depth[i] == INFINITY)
      return setting_.options.ground ? OnGround(lit.frame, PixelRay(lit.frame, x, y)) : LightStart();
    if (samples.face[i] < setting_.materials.size() &&
        setting_.materials[samples.face[i]].kind != MaterialKind::kMatte)
      return {};
    LightStart start{true, false, false, StartOfSample(samples, lit.frame, i, x, y)};
    if (start.at.placed_face >= setting_.first_cap) start.at.placed_face = kNoIndex;
    start.certified = !samples.certificate.empty() && samples.certificate[i] == Certificate::kCertified;
    return start;
  }

  // The point of the ground that a ray of the view meets from above.
  LightStart OnGround(const CameraFrame& frame, const Ray& ray) const {
    const Ground& ground = setting_.plane;
    LightStart start;
    const double rate = Dot(ground.up, ray.direction);
    if (!(rate < 0)) return start;
    const double depth = Dot(ground.up, ground.point - ray.origin) / rate;
    if (frame.projection == Projection::kPerspective && !(depth > frame.near_mm)) return start;
    if (!std::isfinite(depth)) return start;
    start.exists = start.ground = start.certified = true;
    start.at.position = ray.origin + depth * ray.direction;
    start.at.normal = ground.up;
    return start;
  }

  void AddRays(const LightStart& start, SamplePlace place, Batch* batch) const {
    Item item;
    item.exists = start.exists;
    item.certified = start.certified;
    item.key = start.exists ? 0 : 1;
    if (start.exists) {
      const auto index = static_cast<std::uint32_t>(batch->starts.size());
      batch->starts.push_back(start.at);
      if (setting_.options.shadows && Dot(start.at.normal, key_) > 0) {
        item.shadow = Add(index, start, key_, INFINITY, batch);
        item.key = 1;
      }
      if (setting_.options.occlusion_rays > 0) {
        const LocalFrame axes(start.at.normal);
        for (const Vec3 local : hemisphere_.Set(place.column, place.row)) {
          const bool cast =
              Add(index, start, axes.ToWorld(local), setting_.options.occlusion_radius_mm, batch);
          ++(cast ? item.occlusion : item.free);
        }
      }
    }
    batch->items.push_back(item);
  }

  // Adds a ray that ends at `length`, or earlier where it leaves the kept side of a section plane. Returns false, and
  // adds nothing, if the ray would end at its start.
  bool Add(std::uint32_t index, const LightStart& start, Vec3 direction, double length, Batch* batch) const {
    for (const SectionPlane& plane : setting_.sections) {
      const double rate = Dot(plane.normal, direction);
      if (rate > 0) length = std::min(length, Dot(plane.normal, plane.point - start.at.position) / rate);
    }
    if (!(length > 0)) return false;
    batch->rays.push_back({index, direction, length});
    return true;
  }

  // Takes the answers of the rays of a sample, which begin at *ray.
  void Gather(const Batch& batch, std::size_t item_index, std::size_t* ray, std::size_t sample,
              SampleLight* light, LightStats* stats) const {
    const Item& item = batch.items[item_index];
    if (setting_.options.shadows) light->key[sample] = item.key;
    if (setting_.options.occlusion_rays > 0) light->open[sample] = 1.0f;
    if (!item.exists) return;
    bool certified = item.certified;
    std::uint8_t doubts = 0;
    const auto take = [&] {
      const RayPassage& passage = batch.passages[(*ray)++];
      ++stats->rays;
      stats->blocked += passage.blocked;
      stats->certified_rays += passage.certified;
      certified = certified && passage.certified;
      doubts |= passage.doubt;
      return passage.blocked;
    };
    if (item.shadow) light->key[sample] = take() ? 0.0f : 1.0f;
    if (setting_.options.occlusion_rays > 0) {
      int open = item.free;
      for (int k = 0; k < item.occlusion; ++k) open += !take();
      light->open[sample] = static_cast<float>(open) / static_cast<float>(setting_.options.occlusion_rays);
    }
    ++stats->samples;
    stats->certified += certified;
    for (std::size_t bit = 0; bit < stats->doubts.size(); ++bit) stats->doubts[bit] += doubts >> bit & 1;
  }

  const LightSetting& setting_;
  const Vec3 key_;
  const Hemisphere hemisphere_;
};

Result<void> CheckOptions(const LightSetting& setting) {
  const LightOptions& options = setting.options;
  if (options.occlusion_rays < 0 || options.occlusion_rays > kMostOcclusionRays)
    return Error{ErrorCode::kBadUsage,
                 "the number of occlusion rays must lie between 0 and " + std::to_string(kMostOcclusionRays)};
  if (options.occlusion_rays > 0 && !(options.occlusion_radius_mm > 0))
    return Error{ErrorCode::kBadUsage, "the radius of occlusion must be above 0"};
  if (options.ground && !setting.sections.empty())
    return Error{ErrorCode::kBadUsage, "a ground cannot be combined with section planes"};
  return {};
}

template <typename PlaceOf>
Result<SampleLight> CastAll(const LitSamples<PlaceOf>& lit, const LightSetting& setting,
                            const Execution& execution) {
  if (Result<void> sound = CheckOptions(setting); !sound.ok()) return sound.error();
  const Stopwatch stopwatch;
  SampleLight light;
  try {
    const std::size_t size = lit.samples.size();
    if (setting.options.shadows) light.key.resize(size);
    if (setting.options.occlusion_rays > 0) light.open.resize(size);
    if (setting.options.ground) light.ground.resize(size);
    const LightCaster caster(setting, lit.frame);
    const std::size_t batch = std::clamp<std::size_t>(
        kBatchRays / static_cast<std::size_t>(1 + setting.options.occlusion_rays), 1, kMostBatchSamples);
    PerThread<LightStats> stats;
    RunWithThreads(execution.threads, [&] {
      ParallelForBlocks(std::size_t{0}, size, batch, [&](std::size_t first, std::size_t last) {
        if (execution.cancelled()) return;
        LightStats own;
        caster.Cast(lit, first, last, &light, &own);
        stats.local().Add(own);
      });
    });
    for (const LightStats& one : stats) light.stats.Add(one);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimitExceeded, "the light of the samples does not fit into memory"};
  }
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while casting light"};
  light.cast_ms = stopwatch.Milliseconds();
  return light;
}

}  // namespace

void LightStats::Add(const LightStats& other) {
  samples += other.samples;
  certified += other.certified;
  rays += other.rays;
  blocked += other.blocked;
  certified_rays += other.certified_rays;
  for (std::size_t bit = 0; bit < doubts.size(); ++bit) doubts[bit] += other.doubts[bit];
}

Result<SampleLight> CastLight(const SampleBuffer& samples, const CameraFrame& frame,
                              const LightSetting& setting, const Execution& execution) {
  const auto place = PlacesOf(samples);
  return CastAll(LitSamples<decltype(place)>{samples, frame, place}, setting, execution);
}

Result<SampleLight> CastLight(const Refinement& refinement, const LightSetting& setting,
                              const Execution& execution) {
  const auto place = PlacesOf(refinement);
  return CastAll(LitSamples<decltype(place)>{refinement.samples, refinement.frame, place}, setting,
                 execution);
}

RayStart StartOfSample(const SampleBuffer& samples, const CameraFrame& frame, std::size_t i, double x,
                       double y) {
  const Ray ray = PixelRay(frame, x, y);
  const double along = Length(ray.direction);
  RayStart start;
  start.position = ray.origin + samples.depth[i] * ray.direction;
  start.placed_face = samples.face[i];
  if (!samples.uv.empty()) start.u = samples.uv[i][0], start.v = samples.uv[i][1];
  // Turn the normal towards the viewer, as shading does. A normal that the tracer could not find is zero.
  start.normal = Normalized({samples.normal[i][0], samples.normal[i][1], samples.normal[i][2]});
  if (!(Dot(start.normal, start.normal) > 0)) start.normal = -Normalized(ray.direction);
  if (Dot(start.normal, ray.direction) > 0) start.normal = -start.normal;
  start.error = kPointRounding * (Length(ray.origin) + std::fabs(samples.depth[i]) * along);
  // Without a bound, the point counts as exact up to its rounding; such a sample is not certified anyway.
  if (!samples.depth_error.empty() && std::isfinite(samples.depth_error[i]))
    start.error += samples.depth_error[i] * along;
  return start;
}

Vec3 TowardKeyLight(const CameraFrame& frame) {
  const Vec3 key = KeyDirection();
  return Normalized(key.x * frame.right - key.y * frame.down - key.z * frame.forward);
}

}  // namespace facetless
