// Light: which rays are cast, and what their answers become.
#include "render/shade/cast_light.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <atomic>
#include <cmath>
#include <functional>

#include "render/shade/shade.h"

namespace facetless {
namespace {

// A space in which a rule says what blocks a ray, and whether that is proven. It counts what it is asked.
class RuledSpace final : public SecondaryRays {
 public:
  using Rule = std::function<RayPassage(const RayStart&, const SecondaryRay&)>;
  explicit RuledSpace(Rule rule) : rule_(std::move(rule)) {}

  void FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<RayPassage> passages) const override {
    asked_ += rays.size();
    for (std::size_t i = 0; i < rays.size(); ++i) passages[i] = rule_(starts[rays[i].start], rays[i]);
  }
  void FindNearest(std::span<const RayStart>, std::span<const SecondaryRay>,
                   std::span<SecondaryHit>) const override {}
  std::string structure() const override { return "rule"; }
  double build_ms() const override { return 0; }
  std::uint64_t bytes() const override { return 0; }
  std::size_t asked() const { return asked_; }

 private:
  const Rule rule_;
  mutable std::atomic<std::size_t> asked_{0};
};

RuledSpace Empty() {
  return RuledSpace([](const RayStart&, const SecondaryRay&) { return RayPassage{false, true, 0}; });
}

constexpr int kWidth = 37, kHeight = 23;

Camera TopCamera() {
  Camera camera;
  camera.eye = {0, 0, 100};
  camera.up = {0, 1, 0};
  camera.height = kHeight;  // one millimetre per pixel
  camera.width_px = kWidth;
  camera.height_px = kHeight;
  return camera;
}
CameraFrame TopFrame() {
  return MakeFrame(TopCamera(), 100).value();
}

// The plane z = 0, seen from above, with a hole: the columns below `misses` show nothing.
SampleBuffer Plane(int misses = 0, Vec3 normal = {0, 0, 1}) {
  SampleBuffer samples;
  samples.Resize(kWidth, kHeight);
  samples.certificate.assign(samples.size(), Certificate::kCertified);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (static_cast<int>(i % kWidth) < misses) continue;
    samples.depth[i] = 100;
    samples.normal[i] = {static_cast<float>(normal.x), static_cast<float>(normal.y),
                         static_cast<float>(normal.z)};
    samples.face[i] = 3;
  }
  return samples;
}

LightSetting With(const SecondaryRays& space, const LightOptions& options, Ground plane = {},
                  std::span<const SectionPlane> sections = {}) {
  LightSetting setting;
  setting.rays = &space;
  setting.options = options;
  setting.plane = plane;
  setting.sections = sections;
  return setting;
}

SampleLight Cast(const SampleBuffer& samples, const LightSetting& setting, int threads = 2) {
  Result<SampleLight> light = CastLight(samples, TopFrame(), setting, {.threads = threads});
  EXPECT_TRUE(light.ok()) << light.error().message;
  return std::move(light).value();
}

LightOptions Shadows() {
  LightOptions options;
  options.shadows = true;
  return options;
}
LightOptions Occlusion(int rays, double radius_mm = INFINITY) {
  LightOptions options;
  options.occlusion_rays = rays;
  options.occlusion_radius_mm = radius_mm;
  return options;
}

TEST(CastLight, NothingIsBlockedInEmptySpace) {
  const RuledSpace space = Empty();
  LightOptions options = Occlusion(16);
  options.shadows = true;
  const SampleLight light = Cast(Plane(5), With(space, options));
  for (const float key : light.key) EXPECT_EQ(key, 1);
  for (const float open : light.open) EXPECT_EQ(open, 1);
  const std::size_t hits = std::size_t{kWidth - 5} * kHeight;
  EXPECT_EQ(light.stats.samples, hits);
  EXPECT_EQ(light.stats.certified, hits);
  EXPECT_EQ(light.stats.rays, 17 * hits);
  EXPECT_EQ(light.stats.certified_rays, 17 * hits);
  EXPECT_EQ(light.stats.blocked, 0u);
  EXPECT_EQ(space.asked(), 17 * hits) << "a miss has no ray";
}

TEST(CastLight, TheStartIsTheHitAndTheRayIsTheLight) {
  const CameraFrame frame = TopFrame();
  const Vec3 key = TowardKeyLight(frame);
  EXPECT_NEAR(Length(key), 1, 1e-15);
  EXPECT_GT(key.z, 0.5) << "the light is on the viewer's side";
  std::atomic<int> wrong{0};
  const RuledSpace space([&](const RayStart& start, const SecondaryRay& ray) {
    wrong += start.placed_face != 3 || std::fabs(start.position.z) > start.error || start.error > 1e-10 ||
             start.normal.z != 1 || ray.direction.x != key.x || ray.length != INFINITY;
    return RayPassage{start.position.x < 0, true, 0};
  });
  const SampleLight light = Cast(Plane(), With(space, Shadows()));
  EXPECT_EQ(wrong, 0);
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column)
      EXPECT_EQ(light.key[static_cast<std::size_t>(row) * kWidth + column],
                column + 0.5 < kWidth / 2.0 ? 0 : 1);
}

TEST(CastLight, WhatFacesAwayFromTheLightNeedsNoRay) {
  const RuledSpace space = Empty();
  const Vec3 key = TowardKeyLight(TopFrame());
  // Towards the viewer, but away from the light.
  const Vec3 normal = Normalized(Vec3{-key.x, -key.y, 0.01});
  const SampleLight light = Cast(Plane(0, normal), With(space, Shadows()));
  for (const float one : light.key) EXPECT_EQ(one, 0);
  EXPECT_EQ(space.asked(), 0u);
}

TEST(CastLight, OcclusionIsTheShareOfTheSky) {
  EXPECT_TRUE(rc::check("a wall beside the plane, any radius", [] {
    const int rays = *rc::gen::inRange(64, 513);
    const double radius = *rc::gen::inRange(1, 100);
    const RuledSpace space([](const RayStart&, const SecondaryRay& ray) {
      return RayPassage{ray.direction.x > 0 && ray.length >= 50, true, 0};
    });
    const SampleLight light = Cast(Plane(), With(space, Occlusion(rays, radius)));
    for (const float open : light.open) {
      if (radius < 50)
        RC_ASSERT(open == 1);
      else
        RC_ASSERT(std::fabs(open - 0.5) < 0.1);
    }
  }));
}

TEST(CastLight, ASampleIsCertifiedIfItsHitAndAllItsRaysAre) {
  EXPECT_TRUE(rc::check("rays that are sometimes in doubt", [] {
    const int rays = *rc::gen::inRange(1, 64);
    const double bound = *rc::gen::inRange(-10, 11) / 10.0;
    const RuledSpace space([&](const RayStart& start, const SecondaryRay& ray) {
      const bool sure = start.position.x < 0 || ray.direction.x < bound;
      return RayPassage{false, sure, static_cast<std::uint8_t>(sure ? 0 : kDoubtTrim)};
    });
    SampleBuffer samples = Plane();
    samples.certificate[5] = Certificate::kConverged;
    const SampleLight light = Cast(samples, With(space, Occlusion(rays)));
    RC_ASSERT(light.stats.samples == samples.size());
    // Bit 3 is the doubt of trimming. Sample 5 lies on the left, where all rays are sure.
    RC_ASSERT(light.stats.certified + light.stats.doubts[3] == samples.size() - 1);
    RC_ASSERT(light.stats.doubts[0] == 0);
  }));
}

TEST(CastLight, DoesNotDependOnTheNumberOfThreads) {
  const RuledSpace space([](const RayStart& start, const SecondaryRay& ray) {
    return RayPassage{std::sin(9 * start.position.x + 7 * ray.direction.y) > 0, false, kDoubtPole};
  });
  LightOptions options = Occlusion(9, 3);
  options.shadows = options.ground = true;
  const LightSetting setting = With(space, options, {{0, 0, -1}, {0, 0, 1}});
  const SampleLight one = Cast(Plane(9), setting, 1), four = Cast(Plane(9), setting, 4);
  EXPECT_EQ(one.key, four.key);
  EXPECT_EQ(one.open, four.open);
  EXPECT_EQ(one.ground, four.ground);
  EXPECT_EQ(one.stats.blocked, four.stats.blocked);
  EXPECT_EQ(one.stats.doubts, four.stats.doubts);
}

TEST(CastLight, TheGroundCatchesWhatMissesTheModel) {
  const RuledSpace space([](const RayStart& start, const SecondaryRay&) {
    return RayPassage{start.placed_face == kNoIndex && start.position.y > 0, true, 0};
  });
  LightOptions options = Shadows();
  options.ground = true;
  const SampleLight light = Cast(Plane(7), With(space, options, {{0, 0, -5}, {0, 0, 1}}));
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * kWidth + column;
      EXPECT_EQ(light.ground[i], column < 7);
      EXPECT_EQ(light.key[i], column < 7 && row + 0.5 < kHeight / 2.0 ? 0 : 1);
    }
  }
  // From below, there is no ground.
  const SampleLight below = Cast(Plane(7), With(space, options, {{0, 0, -5}, {0, 0, -1}}));
  for (const std::uint8_t one : below.ground) EXPECT_EQ(one, 0);
}

TEST(CastLight, SectionsEndTheRaysWhereTheyLeaveTheKeptSide) {
  EXPECT_TRUE(rc::check("a plane at any height", [] {
    const double height = *rc::gen::inRange(0, 50);
    const SectionPlane plane{{0, 0, height}, {0, 0, 1}};
    const RuledSpace space([&](const RayStart&, const SecondaryRay& ray) {
      const double end = height / ray.direction.z;
      return RayPassage{std::fabs(ray.length - end) > 1e-9 * (1 + end), true, 0};
    });
    const SampleLight light = Cast(Plane(), With(space, Occlusion(8), {}, std::span(&plane, 1)));
    for (const float open : light.open) RC_ASSERT(open == 1);
  }));
}

TEST(CastLight, RefusesWhatItCannotDo) {
  const RuledSpace space = Empty();
  const auto error = [&](const LightSetting& setting) {
    return CastLight(Plane(), TopFrame(), setting, {}).error().code;
  };
  EXPECT_EQ(error(With(space, Occlusion(kMostOcclusionRays + 1))), ErrorCode::kBadUsage);
  EXPECT_EQ(error(With(space, Occlusion(4, 0))), ErrorCode::kBadUsage);
  EXPECT_EQ(error(With(space, Occlusion(4, NAN))), ErrorCode::kBadUsage);
  const SectionPlane plane{{0, 0, 1}, {0, 0, 1}};
  LightOptions options = Shadows();
  options.ground = true;
  EXPECT_EQ(error(With(space, options, {}, std::span(&plane, 1))), ErrorCode::kBadUsage);
  const std::atomic<bool> stop = true;
  EXPECT_EQ(CastLight(Plane(), TopFrame(), With(space, Shadows()), {.cancel = &stop}).error().code,
            ErrorCode::kCancelled);
}

// ---- How light is shown ----

Film Shaded(const SampleLight* light, Background background = Background::kStudio, int misses = 0) {
  ShadeOptions options;
  options.light = light;
  options.ground_up = {0, 0, 1};
  options.background = background;
  const std::vector<Color> colors(4, Color{0.7f, 0.7f, 0.7f});
  Result<Film> film = Shade(Plane(misses), TopFrame(), colors, options);
  EXPECT_TRUE(film.ok()) << film.error().message;
  return std::move(film).value();
}

TEST(ShadeWithLight, LessLightIsDarkerInEveryChannel) {
  const std::size_t size = std::size_t{kWidth} * kHeight;
  SampleLight light;
  light.key.assign(size, 1);
  light.open.assign(size, 1);
  std::array<float, 4> last = Shaded(&light).pixels[0];
  for (const auto& [key, open] : {std::pair{1.0f, 0.5f}, {1.0f, 0.0f}, {0.0f, 0.0f}}) {
    light.key.assign(size, key);
    light.open.assign(size, open);
    const std::array<float, 4> next = Shaded(&light).pixels[0];
    for (int c = 0; c < 3; ++c) EXPECT_LT(next[c], last[c]);
    EXPECT_EQ(next[3], 1);
    last = next;
  }
  for (int c = 0; c < 3; ++c) EXPECT_EQ(last[c], 0) << "without light, everything is black";
}

TEST(ShadeWithLight, OpenSkyChangesNothing) {
  SampleLight light;
  light.open.assign(std::size_t{kWidth} * kHeight, 1);
  EXPECT_EQ(Shaded(&light).pixels, Shaded(nullptr).pixels);
}

TEST(ShadeWithLight, AGroundInFullLightIsTheBackgroundAndAShadowIsItsAlpha) {
  const std::size_t size = std::size_t{kWidth} * kHeight;
  SampleLight light;
  light.key.assign(size, 1);
  light.open.assign(size, 1);
  light.ground.assign(size, 1);
  EXPECT_EQ(Shaded(&light, Background::kStudio, kWidth).pixels,
            Shaded(nullptr, Background::kStudio, kWidth).pixels);
  EXPECT_EQ(Shaded(&light, Background::kTransparent, kWidth).pixels[0], (std::array<float, 4>{0, 0, 0, 0}));
  light.key.assign(size, 0);
  const std::array<float, 4> shadow = Shaded(&light, Background::kTransparent, kWidth).pixels[0];
  EXPECT_EQ(shadow[0], 0);
  EXPECT_GT(shadow[3], 0.2f);
  EXPECT_LT(shadow[3], 0.8f);
  const std::array<float, 4> bright = Shaded(nullptr, Background::kStudio, kWidth).pixels[0],
                             dark = Shaded(&light, Background::kStudio, kWidth).pixels[0];
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(dark[c], (1 - shadow[3]) * bright[c], 1e-6);
}

TEST(ShadeWithLight, RefusesTheLightOfOtherSamples) {
  SampleLight light;
  light.key.assign(5, 1);
  ShadeOptions options;
  options.light = &light;
  EXPECT_EQ(Shade(Plane(), TopFrame(), {}, options).error().code, ErrorCode::kSizeMismatch);
}

}  // namespace
}  // namespace facetless
