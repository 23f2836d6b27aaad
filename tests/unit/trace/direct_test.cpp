// The direct renderer, compared with closed forms. Every sample is checked: hit or miss, depth, normal,
// certificate.
#include "render/trace/direct.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <optional>

#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::Frustum;
using testing::ModelOf;
using testing::Rectangle;
using testing::Sphere;
using testing::Torus;

struct Analytic {
  // Returns the nearest hit's depth along the ray, or nothing. Returns NaN if rounding may decide either way.
  std::function<std::optional<double>(const Ray&)> depth;
  std::function<Vec3(Vec3)> normal;
};

Camera ViewOf(const Model& model, const char* name, Projection projection, int size = 200) {
  return NamedView(name, model.bounds, projection, size, size).value();
}

// Renders the model and compares each sample.
void ExpectMatches(const Model& model, const Camera& camera, const Analytic& analytic, double tolerance,
                   std::uint64_t max_uncertain) {
  const Scene scene(model);
  const Result<DirectResult> result = TraceDirect(scene, camera, {});
  ASSERT_TRUE(result.ok()) << result.error().message;
  const DirectResult& direct = result.value();
  std::uint64_t wrong_hits = 0, hits = 0;
  double worst_depth = 0, worst_normal = 0;
  for (int row = 0; row < camera.height_px; ++row) {
    for (int column = 0; column < camera.width_px; ++column) {
      const std::size_t i = std::size_t(row) * camera.width_px + column;
      const Ray ray = PixelRay(direct.frame, column + 0.5, row + 0.5);
      const std::optional<double> expected = analytic.depth(ray);
      if (expected && std::isnan(*expected)) continue;
      const bool hit = direct.samples.face[i] != kNoIndex;
      if (hit != expected.has_value()) {
        ++wrong_hits;
        ADD_FAILURE() << camera.name << ": pixel " << column << "," << row << " hit " << hit << " depth "
                      << direct.samples.depth[i];
        if (wrong_hits > 5) return;
        continue;
      }
      if (!hit) continue;
      ++hits;
      worst_depth = std::fmax(worst_depth, std::fabs(direct.samples.depth[i] - *expected));
      const Vec3 point = ray.origin + *expected * ray.direction;
      const auto& n = direct.samples.normal[i];
      worst_normal = std::fmax(worst_normal, Length(Vec3{n[0], n[1], n[2]} - analytic.normal(point)));
    }
  }
  EXPECT_GT(hits, 100u);
  EXPECT_LE(worst_depth, tolerance) << camera.name;
  EXPECT_LE(worst_normal, 1e-5) << camera.name;
  const DirectStats& stats = direct.stats;
  EXPECT_EQ(stats.certified + stats.converged + stats.unresolved, stats.rays);
  EXPECT_EQ(stats.unresolved, 0u);
  EXPECT_LE(stats.converged, max_uncertain) << camera.name;
  EXPECT_EQ(stats.hits, hits);
}

Analytic SphereAt(Vec3 center, double radius) {
  return {[=](const Ray& ray) -> std::optional<double> {
            const long double ox = ray.origin.x - center.x, oy = ray.origin.y - center.y,
                              oz = ray.origin.z - center.z;
            const long double dx = ray.direction.x, dy = ray.direction.y, dz = ray.direction.z;
            const long double a = dx * dx + dy * dy + dz * dz, b = ox * dx + oy * dy + oz * dz;
            const long double c = ox * ox + oy * oy + oz * oz - (long double)radius * radius;
            const long double discriminant = b * b - a * c;
            if (std::fabs(double(discriminant)) < 1e-12 * radius * radius) return NAN;
            if (discriminant < 0) return std::nullopt;
            return double((-b - std::sqrt(discriminant)) / a);
          },
          [=](Vec3 p) { return Normalized(p - center); }};
}

TEST(Direct, SphereFromEveryNamedView) {
  const Model model = ModelOf({Sphere({3, -2, 1}, 10)});
  for (const std::string& name : ViewNames()) {
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      SCOPED_TRACE(name);
      ExpectMatches(model, ViewOf(model, name.c_str(), projection), SphereAt({3, -2, 1}, 10), 1e-8, 4);
    }
  }
}

TEST(Direct, PoleUnderThePixelCentre) {
  // With an odd number of pixels, the pole is exactly under the middle pixel of the top view, and a row and a
  // column of pixels lie exactly on borders of patches, one of which is the seam. It cannot be proven on
  // which side of a border a hit lies, but no hit may be lost.
  const Model model = ModelOf({Sphere({0, 0, 0}, 10)});
  ExpectMatches(model, ViewOf(model, "top", Projection::kOrthographic, 201), SphereAt({0, 0, 0}, 10), 1e-8,
                402);
  ExpectMatches(model, ViewOf(model, "bottom", Projection::kOrthographic, 201), SphereAt({0, 0, 0}, 10), 1e-8,
                402);
}

TEST(Direct, CylinderAlongAndAcrossItsAxis) {
  const double radius = 4, height = 9;
  const Model model = ModelOf({Frustum({0, 0, 0}, radius, radius, height)});
  const Analytic analytic{
      [=](const Ray& ray) -> std::optional<double> {
        const double a = ray.direction.x * ray.direction.x + ray.direction.y * ray.direction.y;
        const double b = ray.origin.x * ray.direction.x + ray.origin.y * ray.direction.y;
        const double c = ray.origin.x * ray.origin.x + ray.origin.y * ray.origin.y - radius * radius;
        const double d = b * b - a * c;
        if (std::fabs(d) < 1e-9) return NAN;
        if (d < 0) return std::nullopt;
        for (const double sign : {-1.0, 1.0}) {
          const double t = (-b + sign * std::sqrt(d)) / a, z = ray.origin.z + t * ray.direction.z;
          if (std::fabs(z) < 1e-9 || std::fabs(z - height) < 1e-9) return NAN;
          if (z > 0 && z < height) return t;
        }
        return std::nullopt;
      },
      [=](Vec3 p) {
        return Normalized(Vec3{p.x, p.y, 0});
      }};
  for (const char* name : {"front", "left", "iso", "iso-below"}) {
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      ExpectMatches(model, ViewOf(model, name, projection), analytic, 1e-7, 4);
    }
  }
}

TEST(Direct, TorusAgainstItsQuartic) {
  // The expected depth is refined from the answer itself: a root of the torus' implicit form must lie within
  // 1e-9 of it.
  const double major = 10, minor = 3;
  const Model model = ModelOf({Torus({0, 0, 0}, major, minor)});
  const auto implicit = [=](Vec3 p) {
    const double ring = std::sqrt(p.x * p.x + p.y * p.y) - major;
    return std::sqrt(ring * ring + p.z * p.z) - minor;
  };
  const Scene scene(model);
  for (const char* name : {"top", "front", "iso"}) {
    const Camera camera = ViewOf(model, name, Projection::kPerspective);
    const DirectResult direct = TraceDirect(scene, camera, {}).value();
    std::uint64_t hits = 0;
    for (std::size_t i = 0; i < direct.samples.size(); ++i) {
      const Ray ray =
          PixelRay(direct.frame, double(i % camera.width_px) + 0.5, double(i / camera.width_px) + 0.5);
      // March along the ray with the distance to the torus, to find its first root, if any.
      double t = 0, distance = 0;
      const double speed = Length(ray.direction), far = 4 * model.Diagonal() + Length(ray.origin);
      for (int step = 0; step < 20000 && t * speed < far; ++step) {
        distance = implicit(ray.origin + t * ray.direction);
        if (distance < 1e-10) break;
        t += distance / speed;
      }
      const bool expected = distance < 1e-10;
      const bool hit = direct.samples.face[i] != kNoIndex;
      if (hit) {
        ++hits;
        EXPECT_LT(std::fabs(implicit(ray.origin + direct.samples.depth[i] * ray.direction)), 1e-9);
      }
      ASSERT_EQ(hit, expected) << name << " sample " << i;
    }
    EXPECT_GT(hits, 1000u);
    EXPECT_EQ(direct.stats.unresolved, 0u);
  }
}

TEST(Direct, NearestOfManySurfaces) {
  const Model model =
      ModelOf({Rectangle({0, 0, 3}, {4, 0, 0}, {0, 4, 0}), Rectangle({0, 0, 1}, {4, 0, 0}, {0, 4, 0}),
               Rectangle({0, 0, 2}, {4, 0, 0}, {0, 4, 0})});
  const Scene scene(model);
  const DirectResult direct = TraceDirect(scene, ViewOf(model, "top", Projection::kOrthographic), {}).value();
  std::uint64_t hits = 0;
  for (const std::uint32_t face : direct.samples.face) {
    if (face == kNoIndex) continue;
    EXPECT_EQ(face, 0u);
    ++hits;
  }
  EXPECT_GT(hits, 10000u);
  EXPECT_EQ(direct.stats.certified, direct.stats.rays);
}

TEST(Direct, CameraInsideTheModelSeesTheWallsAllAround) {
  const Model model = ModelOf({Sphere({0, 0, 0}, 10)});
  const Scene scene(model);
  Camera camera;
  camera.eye = {1, 2, -3};
  camera.target = {9, 2, 4};
  camera.up = {0, 0, 1};
  camera.projection = Projection::kPerspective;
  camera.fov_y_deg = 150;
  camera.width_px = camera.height_px = 150;
  const DirectResult direct = TraceDirect(scene, camera, {}).value();
  EXPECT_EQ(direct.stats.hits, direct.stats.rays);
  EXPECT_EQ(direct.stats.unresolved, 0u);
  for (std::size_t i = 0; i < direct.samples.size(); ++i) {
    const Ray ray = PixelRay(direct.frame, double(i % 150) + 0.5, double(i / 150) + 0.5);
    EXPECT_NEAR(Length(ray.origin + direct.samples.depth[i] * ray.direction), 10, 1e-9);
  }
}

TEST(Direct, FacesThatNoRayCanSeeAreNamed) {
  // The second rectangle is narrower than the distance between pixel centres, and lies between two of them.
  const double size = 100;
  Model model = ModelOf(
      {Rectangle({0, 0, 0}, {size, 0, 0}, {0, size, 0}), Rectangle({50.01, 20, 1}, {0.2, 0, 0}, {0, 20, 0})});
  Camera camera;
  camera.eye = {50, 50, 10};
  camera.target = {50, 50, 0};
  camera.height = 100;
  camera.width_px = camera.height_px = 100;
  const Scene scene(model);
  const DirectResult direct = TraceDirect(scene, camera, {}).value();
  EXPECT_EQ(direct.stats.unseen_faces, std::vector<std::uint32_t>{1});
}

TEST(Direct, ThreadsDoNotChangeABit) {
  const Model model = ModelOf({Torus({0, 0, 0}, 10, 3), Sphere({5, 5, 0}, 4)});
  const Scene scene(model);
  const Camera camera = ViewOf(model, "iso", Projection::kPerspective);
  DirectOptions one, seven;
  one.execution.threads = 1;
  seven.execution.threads = 7;
  const SampleBuffer a = TraceDirect(scene, camera, one).value().samples,
                     b = TraceDirect(scene, camera, seven).value().samples;
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.face, b.face);
  EXPECT_EQ(a.certificate, b.certificate);
}

TEST(Direct, StopsWhenItIsToldToOrWouldTakeTooMuchMemory) {
  const Model model = ModelOf({Torus({0, 0, 0}, 10, 3)});
  const Scene scene(model);
  DirectOptions small;
  small.accuracy.max_bytes = 100000;
  const Result<DirectResult> limited =
      TraceDirect(scene, ViewOf(model, "iso", Projection::kPerspective), small);
  ASSERT_FALSE(limited.ok());
  EXPECT_EQ(limited.error().code, ErrorCode::kLimitExceeded);
  const std::atomic<bool> cancel{true};
  DirectOptions cancelled;
  cancelled.execution.cancel = &cancel;
  const Result<DirectResult> stopped =
      TraceDirect(scene, ViewOf(model, "iso", Projection::kPerspective), cancelled);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

TEST(Direct, AnAbsurdGapAtAnEdgeCostsNoMoreThanAnyOther) {
  // A broken file claimed a gap of a fifth of the model's size. Every leaf at the border then covered half of
  // the image.
  ModelBuilder builder(ModelOf({Sphere({0, 0, 0}, 10)}));
  const Vec3 corners[] = {{0, -1.5, 1}, {6.25, -1.5, 1}, {6.25, 1.5, 1}, {0, 1.5, 1}, {0, -1.5, 1}};
  builder.AddLoop();
  Coedge coedge;
  coedge.gap_mm = 4;
  builder.AddCoedge(coedge);
  for (int i = 0; i < 4; ++i) builder.AddTrimSegment({corners + i, 2});
  const Model model = testing::Finished(std::move(builder));
  const DirectStats stats =
      TraceDirect(Scene(model), ViewOf(model, "iso", Projection::kOrthographic), {}).value().stats;
  EXPECT_GT(stats.hits, 1000u);
  EXPECT_LT(stats.leaves, 20000u);
}

TEST(Direct, APlaneSeenEdgeOnIsNotSplitForever) {
  // Pixel centres lie in the plane, and neither of its parameters runs along a ray. Every piece contains some
  // of the centres and none has a certificate. In a close-up there were millions of pieces.
  const Model model = ModelOf({Rectangle({0, 0, 0}, {10, 3, 0}, {-2, 10, 0})});
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    Camera camera;
    camera.eye = {3, -15, 0};
    camera.target = {4, 6, 0};
    camera.up = {0, 0, 1};
    camera.projection = projection;
    camera.height = 1e-3;
    camera.fov_y_deg = 3e-3;
    camera.width_px = camera.height_px = 33;
    const DirectResult direct = TraceDirect(Scene(model), camera, {}).value();
    EXPECT_LT(direct.stats.leaves, 10u);
    EXPECT_EQ(direct.stats.unresolved, 33u) << "the row in the plane";
    EXPECT_EQ(direct.stats.certified, direct.stats.rays - 33);
    EXPECT_EQ(direct.stats.hits, 0u);
  }
}

TEST(Direct, APatchThatItsErrorsPlaceAnywhereIsInDoubtAndNotSplitForever) {
  // One corner is so far away, or has such a large weight, that rounding removes all other points. No piece
  // can be culled, and none has a certificate. Such patches were once split without end, or until the memory
  // was full.
  const Vec4 corners[][2] = {{{5, 5, 0, 1e161}, {1e151, 1e248, 1e223, 1}},
                             {{5, 5, 0, 1}, {1e230, 1e240, 0, 1e-167}},
                             {{1e254, 1e254, 0, 1e-56}, {5, 5, 0, 1}},
                             {{5, 5, 0, 1e40}, {1e265, 1e260, 0, 1e-200}}};
  for (const auto& [beside, corner] : corners) {
    std::vector<Vec4> points;
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) points.push_back({5.0 * k, 5.0 * l, 2.0 * (k == 1), 1});
    points[7] = beside;
    points[8] = corner;
    const std::vector<Span> span{{0, 1, SpanMap::kLinear}};
    ModelBuilder builder;
    builder.AddPart("part");
    builder.AddFace({SurfaceKind::kBspline, 2, 2, span, span, points});
    builder.AddInstance({});
    builder.SetBounds({{0, 0, 0}, {10, 10, 2}});
    const Model model = testing::Finished(std::move(builder));
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      const DirectStats stats = TraceDirect(Scene(model), ViewOf(model, "iso", projection), {}).value().stats;
      EXPECT_LT(stats.leaves, 1000u) << corner.w;
      EXPECT_EQ(stats.unresolved, stats.rays) << corner.w;
    }
  }
}

TEST(Direct, FarFromTheOriginLosesOnlyTheCoordinatesOwnDigits) {
  const Vec3 center{1e7, -1e7, 1e7};
  const Model model = ModelOf({Sphere(center, 1)});
  ExpectMatches(model, ViewOf(model, "iso", Projection::kOrthographic), SphereAt(center, 1), 1e-4, 200);
}

TEST(Direct, FarFromTheOriginByAPlacementLosesNoDigits) {
  Model model = ModelOf({Sphere({0, 0, 0}, 1)});
  const Vec3 center{1e7, -1e7, 1e7};
  testing::Place(&model, {{{0.6, -0.8, 0, center.x}, {0.8, 0.6, 0, center.y}, {0, 0, 1, center.z}}});
  model.bounds = {center - Vec3{1, 1, 1}, center + Vec3{1, 1, 1}};
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const DirectStats stats = TraceDirect(Scene(model), ViewOf(model, "iso", projection), {}).value().stats;
    EXPECT_GT(stats.hits, 1000u);
    EXPECT_EQ(stats.certified, stats.rays);
    EXPECT_LT(stats.depth_error_max, 1e-9);
  }
}

TEST(Direct, FromVeryFarOnlyTheDistancesOwnDigitsAreLost) {
  // A rational surface from a distance of 6e7 times its size: its weights vary, but its depth hardly changes.
  const Model model = ModelOf({Sphere({0, 0, 0}, 1)});
  Camera camera;
  camera.projection = Projection::kPerspective;
  camera.eye = {1.2e8, 0, 0};
  camera.up = {0, 0, 1};
  camera.fov_y_deg = 1e-6;
  camera.width_px = camera.height_px = 101;
  const DirectStats stats = TraceDirect(Scene(model), camera, {}).value().stats;
  EXPECT_GT(stats.hits, 1000u);
  EXPECT_LT(stats.depth_error_max, 1e-3);
}

TEST(Direct, NoMissIsCertifiedBetweenPiecesBesideAnApex) {
  // These pixels lie on the diagonals, at 1e-11 of the cone's size from its apex. There, the pieces of a leaf
  // without a certificate are not much larger than the error of a root.
  const Model model = ModelOf({Frustum({0, 0, 0}, 1, 0, 1)});
  const Scene scene(model);
  for (const double window : {1e-5, 1e-6, 1e-7, 1e-8}) {
    Camera camera;
    camera.eye = {0, 0, 4};
    camera.height = window;
    camera.width_px = camera.height_px = 33;
    const DirectStats stats = TraceDirect(scene, camera, {}).value().stats;
    EXPECT_GE(stats.hits, stats.rays - 1) << window;  // one ray on the seam may stay in doubt
    EXPECT_EQ(stats.certified, stats.certified_hits) << window;
  }
}

TEST(Direct, RaysThroughABorderOfPatchesAreCertifiedWhereTheSurfaceGoesOn) {
  // The middle column runs along meridians in which two patches meet. A silhouette, or a corner of patches,
  // is not certain.
  const Model model = ModelOf({Sphere({0, 0, 0}, 1)});
  for (const char* view : {"front", "top"}) {
    for (const Precision precision : {Precision::kFast, Precision::kStandard, Precision::kCertified}) {
      DirectOptions options;
      options.accuracy.precision = precision;
      const Camera camera = ViewOf(model, view, Projection::kOrthographic, 101);
      const DirectStats stats = TraceDirect(Scene(model), camera, options).value().stats;
      EXPECT_GE(stats.certified, stats.rays - 1) << view;
    }
  }
}

TEST(Direct, TheEndsOfAnOpenSpiralDoNotVouchForEachOther) {
  // One turn of a ramp. Seen from above, the ray through one end passes the other end, 20 mm deeper. The
  // middle row runs along both ends on the right, and along a border of patches within the ramp on the left.
  testing::PatchGrid spiral = testing::Frustum({0, 0, 0}, 10, 4, 1);
  spiral.kind = SurfaceKind::kBspline;
  for (std::size_t i = 0; i < spiral.points.size(); ++i) {
    Vec4& point = spiral.points[i];
    const std::size_t quarter = i / 6, control = i % 6 / 2;
    point.z += point.w * 5 * (double(quarter) + 0.5 * double(control));
  }
  const Model model = ModelOf({spiral});
  for (const Precision precision : {Precision::kFast, Precision::kStandard, Precision::kCertified}) {
    DirectOptions options;
    options.accuracy.precision = precision;
    const Camera camera = ViewOf(model, "top", Projection::kOrthographic, 101);
    const SampleBuffer samples = TraceDirect(Scene(model), camera, options).value().samples;
    int at_ends = 0, within = 0;
    for (int column = 0; column < 101; ++column) {
      const std::size_t k = 50 * 101 + column;
      if (!std::isfinite(samples.depth[k])) continue;
      if (column > 50) {
        ++at_ends;
        EXPECT_NE(samples.certificate[k], Certificate::kCertified) << column;
      } else {
        ++within;
        EXPECT_EQ(samples.certificate[k], Certificate::kCertified) << column;
      }
    }
    EXPECT_GT(at_ends, 20);
    EXPECT_GT(within, 20);
  }
}

TEST(Direct, AnEyeAtAPoleOrFarDownATubeCostsNoMoreLeavesThanAnyOther) {
  struct Case {
    const char* what;
    Model model;
    Vec3 eye, target;
  };
  for (const Case& at :
       {Case{"pole", ModelOf({Sphere({0, 0, 0}, 1)}), {0, 0, 1}, {1, 0, 1}},
        Case{"apex", ModelOf({Frustum({0, 0, 0}, 1, 0, 1)}), {0, 0, 1}, {1, 0, 1}},
        Case{"tube", ModelOf({Frustum({0, 0, 0}, 0.5, 0.5, 1e8)}), {0.1, 0.1, 5e7}, {0.1, 0.1, 1e8}}}) {
    Camera camera;
    camera.eye = at.eye;
    camera.target = at.target;
    camera.up = at.target.z > at.eye.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    camera.projection = Projection::kPerspective;
    camera.fov_y_deg = 90;
    camera.width_px = camera.height_px = 65;
    DirectOptions options;
    options.accuracy.max_bytes = 1 << 25;
    const Result<DirectResult> direct = TraceDirect(Scene(at.model), camera, options);
    ASSERT_TRUE(direct.ok()) << at.what << ": " << direct.error().message;
    EXPECT_LT(direct.value().stats.leaves, 20000u) << at.what;
  }
}

}  // namespace
}  // namespace facetless
