#include "render/shade/cast_reflections.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <string>
#include <vector>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/shade/environment.h"
#include "render/shade/sample_places.h"
#include "render/shade/studio.h"

namespace facetless {
namespace {

constexpr std::size_t kBlock = 256;    // samples whose rays are followed together
constexpr double kMirrorShare = 0.94;  // share of the light that a mirror reflects
// At each face of a glass, this share of the refracted light keeps its colour. The rest is multiplied by the colour of
// the face.
constexpr double kClear = 0.92;

Vec3 Times(Vec3 a, Vec3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
double Largest(Vec3 v) {
  return std::max({v.x, v.y, v.z});
}
Vec3 Linear(const Color& color) {
  return {SrgbToLinear(color.r), SrgbToLinear(color.g), SrgbToLinear(color.b)};
}

// A ray that is followed from a sample, against the direction of the light.
struct Branch {
  std::uint32_t item;  // index of the sample within the block
  Vec3 share;          // the share of the sample's light that the ray carries, by channel
  Vec3 direction;      // unit vector
};

// A point at which a ray meets a face.
struct Meeting {
  RayStart at;     // the point; its normal is outward by the face's orientation
  Vec3 direction;  // of the ray that arrives, unit vector
};

// The rays of one block of samples.
class Block {
 public:
  Block(const ReflectionSetting& setting, std::span<const Vec3> albedo, const CameraFrame& frame,
        LightStats* stats)
      : setting_(setting),
        albedo_(albedo),
        frame_(frame),
        key_(TowardKeyLight(frame)),
        surroundings_(frame, setting.panorama, setting.up),
        stats_(stats) {}

  // Adds a sample, and returns its number within the block.
  std::uint32_t Add(const Meeting& meeting, bool certified) {
    const auto item = static_cast<std::uint32_t>(items_.size());
    items_.push_back({{0, 0, 0}, certified, 0});
    Scatter(item, {1, 1, 1}, meeting);
    return item;
  }

  // Follows all rays. Light may be called afterwards.
  void Follow() {
    for (int bounce = 0; !branches_.empty(); ++bounce) {
      std::vector<Branch> branches = std::move(branches_);
      const std::vector<RayStart> starts = std::move(starts_);
      branches_.clear();
      starts_.clear();
      if (bounce > setting_.bounces) {
        for (const Branch& branch : branches) AddSurroundings(branch);
        return;
      }
      FollowOnce(branches, starts);
    }
  }

  Vec3 Light(std::uint32_t item) const { return items_[item].light; }

  void Count() const {
    for (const Item& item : items_) {
      ++stats_->samples;
      stats_->certified += item.certified;
      for (std::size_t bit = 0; bit < stats_->doubts.size(); ++bit)
        stats_->doubts[bit] += item.doubts >> bit & 1;
    }
  }

 private:
  struct Item {
    Vec3 light;
    bool certified;
    std::uint8_t doubts;
  };

  void FollowOnce(const std::vector<Branch>& branches, const std::vector<RayStart>& starts) {
    std::vector<SecondaryRay> rays;
    for (std::size_t i = 0; i < branches.size(); ++i)
      rays.push_back({static_cast<std::uint32_t>(i), branches[i].direction, INFINITY});
    std::vector<SecondaryHit> hits(rays.size());
    setting_.rays->FindNearest(starts, rays, hits);
    std::vector<std::size_t> matte;
    for (std::size_t i = 0; i < branches.size(); ++i) {
      Count(branches[i].item, hits[i].certified, hits[i].doubt);
      if (hits[i].placed_face == kNoIndex) {
        AddSurroundings(branches[i]);
      } else if (KindOf(hits[i].placed_face) == MaterialKind::kMatte) {
        matte.push_back(i);
      } else {
        Scatter(branches[i].item, branches[i].share, {StartAt(hits[i]), branches[i].direction});
      }
    }
    AddMatte(branches, hits, matte);
  }

  // Adds the light of the matte faces that were met, with shadows if they are cast.
  void AddMatte(const std::vector<Branch>& branches, const std::vector<SecondaryHit>& hits,
                const std::vector<std::size_t>& matte) {
    std::vector<RayStart> starts;
    std::vector<SecondaryRay> rays;
    std::vector<std::size_t> asked(matte.size(), kNoRay);
    for (std::size_t k = 0; k < matte.size(); ++k) {
      const SecondaryHit& hit = hits[matte[k]];
      if (setting_.shadow_rays == nullptr ||
          !(Dot(Facing(hit.normal, branches[matte[k]].direction), key_) > 0))
        continue;
      asked[k] = rays.size();
      rays.push_back({static_cast<std::uint32_t>(starts.size()), key_, INFINITY});
      starts.push_back(StartAt(hit));
    }
    std::vector<RayPassage> passages(rays.size());
    if (!rays.empty()) setting_.shadow_rays->FindBlocked(starts, rays, passages);
    for (std::size_t k = 0; k < matte.size(); ++k) {
      const Branch& branch = branches[matte[k]];
      const SecondaryHit& hit = hits[matte[k]];
      LightShare share;
      share.shadows = setting_.shadow_rays != nullptr;
      if (asked[k] != kNoRay) {
        const RayPassage& passage = passages[asked[k]];
        share.key = passage.blocked ? 0 : 1;
        stats_->blocked += passage.blocked;
        Count(branch.item, passage.certified, passage.doubt);
      }
      const StudioView view(ToViewer(-branch.direction));
      const Vec3 normal = ToViewer(Facing(hit.normal, branch.direction));
      Item& item = items_[branch.item];
      item.light = item.light + Times(branch.share, view.Light(normal, AlbedoOf(hit.placed_face), share));
    }
  }

  // Adds the rays into which a face that is not matte turns the ray that meets it.
  void Scatter(std::uint32_t item, Vec3 share, const Meeting& meeting) {
    const Material& material = setting_.materials[meeting.at.placed_face];
    const Vec3 d = meeting.direction, n = Facing(meeting.at.normal, d);
    const double cosine = std::clamp(-Dot(n, d), 0.0, 1.0);
    const Vec3 reflected = Normalized(d + (2 * cosine) * n);
    if (material.kind == MaterialKind::kMirror) return Push(item, kMirrorShare * share, meeting, reflected);
    const Vec3 albedo = AlbedoOf(meeting.at.placed_face);
    if (material.kind == MaterialKind::kMetal) {
      const double grazing = 1 - cosine, grazing2 = grazing * grazing;
      const double rest = grazing2 * grazing2 * grazing;
      return Push(item, Times(share, (1 - rest) * albedo + Vec3{rest, rest, rest}), meeting, reflected);
    }
    // A glass: the ray enters it if it arrives against the outward normal.
    const bool enters = Dot(meeting.at.normal, d) < 0;
    const double n1 = enters ? 1 : material.ior, n2 = enters ? material.ior : 1, eta = n1 / n2;
    const double squared = 1 - eta * eta * (1 - cosine * cosine);
    if (!(squared > 0)) return Push(item, share, meeting, reflected);  // total reflection
    const double inner = std::sqrt(squared);
    const double s = (n1 * cosine - n2 * inner) / (n1 * cosine + n2 * inner);
    const double p = (n1 * inner - n2 * cosine) / (n1 * inner + n2 * cosine);
    const double reflects = 0.5 * (s * s + p * p);
    Push(item, reflects * share, meeting, reflected);
    const Vec3 tint = (1 - kClear) * albedo + Vec3{kClear, kClear, kClear};
    Push(item, (1 - reflects) * Times(share, tint), meeting,
         Normalized(eta * d + (eta * cosine - inner) * n));
  }

  void Push(std::uint32_t item, Vec3 share, const Meeting& meeting, Vec3 direction) {
    if (!(Largest(share) >= kLeastShare)) return;
    branches_.push_back({item, share, direction});
    starts_.push_back(meeting.at);
  }

  void AddSurroundings(const Branch& branch) {
    Item& item = items_[branch.item];
    item.light = item.light + Times(branch.share, surroundings_.Light(branch.direction));
  }

  void Count(std::uint32_t item, bool certified, std::uint8_t doubt) {
    ++stats_->rays;
    stats_->certified_rays += certified;
    items_[item].certified = items_[item].certified && certified;
    items_[item].doubts |= doubt;
  }

  MaterialKind KindOf(std::uint32_t face) const {
    return face < setting_.materials.size() ? setting_.materials[face].kind : MaterialKind::kMatte;
  }
  Vec3 AlbedoOf(std::uint32_t face) const { return face < albedo_.size() ? albedo_[face] : Vec3{}; }
  Vec3 ToViewer(Vec3 v) const {
    return {Dot(v, frame_.right), -Dot(v, frame_.down), -Dot(v, frame_.forward)};
  }
  static Vec3 Facing(Vec3 normal, Vec3 direction) {
    if (!(Dot(normal, normal) > 0)) return -direction;
    return Dot(normal, direction) > 0 ? -normal : normal;
  }
  static RayStart StartAt(const SecondaryHit& hit) {
    return {hit.position, hit.normal, hit.placed_face, hit.u, hit.v, hit.error};
  }

  static constexpr std::size_t kNoRay = static_cast<std::size_t>(-1);
  const ReflectionSetting& setting_;
  const std::span<const Vec3> albedo_;
  const CameraFrame& frame_;
  const Vec3 key_;
  const Surroundings surroundings_;
  LightStats* stats_;
  std::vector<Item> items_;
  std::vector<Branch> branches_;  // rays that are not followed yet
  std::vector<RayStart> starts_;  // the start of each of them
};

// Follows the rays of the samples [first, last).
template <typename PlaceOf>
void FollowSamples(const SampleBuffer& samples, const CameraFrame& frame, const PlaceOf& place,
                   const ReflectionSetting& setting, std::span<const Vec3> albedo, std::size_t first,
                   std::size_t last, SampleLight* light, LightStats* stats) {
  Block block(setting, albedo, frame, stats);
  std::vector<std::size_t> chosen;
  for (std::size_t i = first; i < last; ++i) {
    const std::uint32_t face = samples.face[i];
    if (samples.depth[i] == INFINITY || face >= setting.materials.size() ||
        setting.materials[face].kind == MaterialKind::kMatte)
      continue;
    const SamplePlace at = place(i);
    const double x = at.column + 0.5, y = at.row + 0.5;
    Meeting meeting{StartOfSample(samples, frame, i, x, y), Normalized(PixelRay(frame, x, y).direction)};
    // StartOfSample turns the normal to the viewer. A glass needs the outward normal, so set it again.
    meeting.at.normal = Normalized({samples.normal[i][0], samples.normal[i][1], samples.normal[i][2]});
    const bool certified = !samples.certificate.empty() && samples.certificate[i] == Certificate::kCertified;
    block.Add(meeting, certified);
    chosen.push_back(i);
  }
  if (chosen.empty()) return;
  block.Follow();
  block.Count();
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const Vec3 seen = StudioTone(block.Light(static_cast<std::uint32_t>(k)));
    light->seen[chosen[k]] = {static_cast<float>(seen.x), static_cast<float>(seen.y),
                              static_cast<float>(seen.z)};
    light->shows[chosen[k]] = 1;
  }
}

template <typename PlaceOf>
Result<void> FollowAll(const SampleBuffer& samples, const CameraFrame& frame, const PlaceOf& place,
                       const ReflectionSetting& setting, const Execution& execution, SampleLight* light) {
  if (setting.bounces < 0 || setting.bounces > kMostBounces)
    return Error{ErrorCode::kBadUsage,
                 "the number of bounces must lie between 0 and " + std::to_string(kMostBounces)};
  const Stopwatch stopwatch;
  try {
    light->seen.resize(samples.size());
    light->shows.resize(samples.size());
    std::vector<Vec3> albedo;
    for (const Color& color : setting.colors) albedo.push_back(Linear(color));
    PerThread<LightStats> stats;
    RunWithThreads(execution.threads, [&] {
      ParallelForBlocks(std::size_t{0}, samples.size(), kBlock, [&](std::size_t first, std::size_t last) {
        if (execution.cancelled()) return;
        LightStats own;
        FollowSamples(samples, frame, place, setting, albedo, first, last, light, &own);
        stats.local().Add(own);
      });
    });
    for (const LightStats& one : stats) light->stats.Add(one);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimitExceeded, "the reflections of the samples do not fit into memory"};
  }
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while following reflections"};
  light->cast_ms += stopwatch.Milliseconds();
  return {};
}

}  // namespace

Result<void> CastReflections(const SampleBuffer& samples, const CameraFrame& frame,
                             const ReflectionSetting& setting, const Execution& execution,
                             SampleLight* light) {
  return FollowAll(samples, frame, PlacesOf(samples), setting, execution, light);
}

Result<void> CastReflections(const Refinement& refinement, const ReflectionSetting& setting,
                             const Execution& execution, SampleLight* light) {
  return FollowAll(refinement.samples, refinement.frame, PlacesOf(refinement), setting, execution, light);
}

}  // namespace facetless
