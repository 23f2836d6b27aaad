// The independent check of certificates agrees with correct roots, and contradicts wrong ones.
#include "render/trace/certificate_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "render/trace/direct.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::ModelOf;

Placement Turned(double scale, Vec3 shift) {
  // A rotation about (1, 1, 1) by a third of a turn, which permutes the axes.
  Placement placement;
  const double m[3][4] = {{0, 0, scale, shift.x}, {scale, 0, 0, shift.y}, {0, scale, 0, shift.z}};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) placement.m[r][c] = m[r][c];
  return placement;
}

Model Shapes() {
  return ModelOf({testing::Torus({0, 0, 0}, 10, 3), testing::Sphere({4, 6, 2}, 5),
                  testing::Frustum({-6, 0, -4}, 4, 0, 9),
                  testing::Rectangle({-12, -12, -4}, {24, 0, 1}, {0, 24, 2})});
}

TEST(CertificateCheck, AgreesWithEveryCertifiedSampleOfEveryPrecision) {
  for (const bool placed : {false, true}) {
    Model model = Shapes();
    if (placed) testing::Place(&model, Turned(0.01, {1000, -200, 30}));
    const Scene scene(model);
    for (const Precision precision : {Precision::kFast, Precision::kStandard, Precision::kCertified}) {
      for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
        DirectOptions options;
        options.accuracy.precision = precision;
        options.accuracy.check = CheckLevel::kAll;
        const Camera camera = NamedView("iso", model.bounds, projection, 150, 140).value();
        const DirectStats stats = TraceDirect(scene, camera, options).value().stats;
        EXPECT_GE(stats.check.roots, stats.certified_hits);
        EXPECT_GT(stats.check.rays, 20u);
        EXPECT_EQ(stats.check.roots_contradicted, 0u);
        EXPECT_EQ(stats.check.rays_contradicted, 0u);
        EXPECT_EQ(stats.doubts[7], 0u);
      }
    }
  }
}

TEST(CertificateCheck, IsAskedAsThePrecisionAndTheAuditSay) {
  const Model model = Shapes();
  const Scene scene(model);
  const Camera camera = NamedView("iso", model.bounds, Projection::kOrthographic, 100, 100).value();
  const auto checked = [&](Precision precision, bool audit, CheckLevel level) {
    DirectOptions options;
    options.accuracy.precision = precision;
    options.audit = audit;
    options.accuracy.check = level;
    const CheckStats check = TraceDirect(scene, camera, options).value().stats.check;
    return check.roots > 0 && check.rays > 0;
  };
  EXPECT_FALSE(checked(Precision::kStandard, false, CheckLevel::kAuto));
  EXPECT_FALSE(checked(Precision::kFast, false, CheckLevel::kAuto));
  EXPECT_TRUE(checked(Precision::kCertified, false, CheckLevel::kAuto));
  EXPECT_TRUE(checked(Precision::kStandard, true, CheckLevel::kAuto));
  EXPECT_TRUE(checked(Precision::kFast, false, CheckLevel::kAll));
  EXPECT_FALSE(checked(Precision::kCertified, true, CheckLevel::kNone));
}

// A plane z = 0 over [0, 4]², seen from above: everything about a ray is known.
class PlaneCheck : public ::testing::Test {
 protected:
  PlaneCheck() : model_(ModelOf({testing::Rectangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0})})), scene_(model_) {
    Camera camera;
    camera.eye = {2, 2, 10};
    camera.target = {2, 2, 0};
    camera.up = {0, 1, 0};
    camera.height = 8;
    camera.width_px = camera.height_px = 8;
    frame_ = MakeFrame(camera, model_.Diagonal()).value();
  }
  // The ray of pixel (x, y) meets (x − 2, 6 − y, 0). u and v are these coordinates divided by 4.
  StatedRoot RootAt(double x, double y) const {
    StatedRoot root;
    root.u = (x - 2) / 4;
    root.v = (6 - y) / 4;
    root.error_u = root.error_v = 1e-12;
    root.x = x;
    root.y = y;
    root.depth = 10;
    root.depth_error = 1e-13;
    return root;
  }

  Model model_;
  Scene scene_;
  CameraFrame frame_;
};

TEST_F(PlaneCheck, ARootHoldsWithinItsBoundsAndNotBeyondThem) {
  const CertificateCheck check(scene_.data(), frame_);
  const StatedRoot right = RootAt(3.5, 4.25);
  EXPECT_TRUE(check.RootHolds(right));
  for (const double off : {1e-9, 1e-6, 1e-3, 0.1}) {
    StatedRoot wrong = right;
    wrong.u += off;
    EXPECT_FALSE(check.RootHolds(wrong)) << off;
    wrong.error_u = off;
    EXPECT_TRUE(check.RootHolds(wrong)) << off;
    wrong = right;
    wrong.v -= off;
    EXPECT_FALSE(check.RootHolds(wrong)) << off;
    wrong = right;
    wrong.depth += off;
    EXPECT_FALSE(check.RootHolds(wrong)) << off;
    wrong.depth_error = off;
    EXPECT_TRUE(check.RootHolds(wrong)) << off;
  }
  StatedRoot wrong = right;
  wrong.u = NAN;
  EXPECT_FALSE(check.RootHolds(wrong));
  wrong = right;
  wrong.depth = NAN;
  EXPECT_FALSE(check.RootHolds(wrong));
}

TEST_F(PlaneCheck, ANearerHitIsFound) {
  const CertificateCheck check(scene_.data(), frame_);
  EXPECT_EQ(check.CheckRay(3.5, 4.25, 10, 1e-13), RayCheck::kClear);
  EXPECT_EQ(check.CheckRay(3.5, 4.25, INFINITY, 0), RayCheck::kContradicted);
  EXPECT_EQ(check.CheckRay(3.5, 4.25, 10.5, 1e-13), RayCheck::kContradicted);
  EXPECT_EQ(check.CheckRay(3.5, 4.25, 10.5, 0.6), RayCheck::kClear);
  EXPECT_EQ(check.CheckRay(1.5, 4.25, INFINITY, 0), RayCheck::kClear);  // beside the plane
}

// Patches of any degree with two equal sides: a closed patch has no width between its corners.
TEST(CertificateCheck, AHitOnAClosedPatchIsFound) {
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const Model model = ModelOf({testing::Sphere({0, 0, 0}, 5)});
    const Scene scene(model);
    const Camera camera = NamedView("iso", model.bounds, projection, 40, 40).value();
    const CameraFrame frame = MakeFrame(camera, model.Diagonal()).value();
    const CertificateCheck check(scene.data(), frame);
    const SampleBuffer samples = TraceDirect(scene, camera, {}).value().samples;
    int hits = 0, contradicted = 0;
    for (int row = 0; row < 40; ++row) {
      for (int column = 0; column < 40; ++column) {
        const double depth = samples.depth[40 * row + column];
        if (!std::isfinite(depth)) {
          EXPECT_EQ(check.CheckRay(column + 0.5, row + 0.5, INFINITY, 0), RayCheck::kClear);
          continue;
        }
        EXPECT_EQ(check.CheckRay(column + 0.5, row + 0.5, depth, 1e-9), RayCheck::kClear);
        ++hits;
        contradicted += check.CheckRay(column + 0.5, row + 0.5, INFINITY, 0) == RayCheck::kContradicted;
      }
    }
    // Rays that pass a border of two patches, or a silhouette, are not certain.
    EXPECT_GT(contradicted, hits * 9 / 10);
  }
}

}  // namespace
}  // namespace facetless
