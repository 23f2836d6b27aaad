// Tests the judge itself: known points on known shapes, and models that are wrong on purpose.

#include "tests/verify/differential/exact_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/files.h"
#include "tests/verify/differential/differential.h"

namespace facetless {
namespace {

Ray Down(double x, double y) {
  return {{x, y, 100}, {0, 0, -1}};
}

// The cone of the samples: base radius 10 at z = 0, apex at z = 20; seen from above.
class Cone : public ::testing::Test {
 protected:
  void SetUp() override {
    Result<ExactReference> loaded = ExactReference::Load(Sample("cone.step"), false);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    cone_ = std::make_unique<ExactReference>(std::move(loaded.value()));
  }
  std::unique_ptr<ExactReference> cone_;
  static constexpr double kTolerance = 1e-6;
};

TEST_F(Cone, NearestIsTheClosedForm) {
  const ReferenceHit hit = cone_->Nearest(Down(3, 4), -INFINITY);
  ASSERT_TRUE(hit.hit());
  EXPECT_NEAR(hit.depth, 100 - 10, 1e-9);  // z = 20 − 2·5
  EXPECT_EQ(cone_->SurfaceName(hit.face), "cone");
  EXPECT_FALSE(cone_->Nearest(Down(9, 9), -INFINITY).hit());
}

TEST_F(Cone, NothingBeforeTheEyeIsHit) {
  const ReferenceHit hit = cone_->Nearest({{3, 4, 5}, {0, 0, -1}}, 1e-6);
  ASSERT_TRUE(hit.hit());
  EXPECT_NEAR(hit.depth, 5, 1e-9);
  EXPECT_EQ(cone_->SurfaceName(hit.face), "plane");
}

TEST_F(Cone, JudgesPointsOnAndOffTheFace) {
  EXPECT_EQ(cone_->Judge(Down(3, 4), 90, kTolerance).standing, Standing::kOn);
  EXPECT_EQ(cone_->Judge(Down(3, 4), 100, kTolerance).standing, Standing::kOn);  // the base
  EXPECT_EQ(cone_->Judge(Down(3, 4), 90.001, kTolerance).standing, Standing::kOff);
  // The point is in the plane of the base, but outside of it.
  EXPECT_EQ(cone_->Judge(Down(10.01, 0.3), 100, kTolerance).standing, Standing::kOff);
}

TEST_F(Cone, KnowsTheSideOfAnEdge) {
  const double angle = 0.3, inside = 10 - 5e-7, outside = 10 + 5e-7;
  const Judgement in =
      cone_->Judge(Down(inside * std::cos(angle), inside * std::sin(angle)), 100, kTolerance);
  EXPECT_EQ(in.standing, Standing::kEdge);
  EXPECT_NEAR(in.edge_mm, 5e-7, 1e-9);
  EXPECT_TRUE(in.inside_edge);
  const Judgement out =
      cone_->Judge(Down(outside * std::cos(angle), outside * std::sin(angle)), 100, kTolerance);
  EXPECT_EQ(out.standing, Standing::kEdge);
  EXPECT_FALSE(out.inside_edge);
}

// Moves the control points of one face's surface.
void Move(Model& model, std::uint32_t face, Vec3 by) {
  const Surface& surface = model.surfaces[model.faces[face].surface];
  const std::uint32_t end = surface.first_control_point + surface.PatchCount() * surface.PointsPerPatch();
  for (std::uint32_t i = surface.first_control_point; i < end; ++i) {
    Vec4& p = model.control_points[i];
    p = {p.x + by.x * p.w, p.y + by.y * p.w, p.z + by.z * p.w, p.w};
  }
}

// The bracket has one part with one placement, so that placed faces are faces.
class Spoiled : public ::testing::Test {
 protected:
  void SetUp() override {
    Result<ComparedFile> loaded = LoadBoth(Sample("bracket.step"), false);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    file_ = std::make_unique<ComparedFile>(std::move(loaded.value()));
    const Model& model = file_->model;
    ASSERT_EQ(model.instances.size(), 1u);
    Result<Camera> camera = NamedView("iso", model.bounds, Projection::kOrthographic, 64, 64);
    ASSERT_TRUE(camera.ok());
    camera_ = camera.value();
    // Find the face that most rays hit.
    const Result<DirectResult> traced = TraceDirect(Scene(model), camera_, {});
    ASSERT_TRUE(traced.ok());
    std::vector<int> rays(model.faces.size(), 0);
    for (const std::uint32_t face : traced.value().samples.face) {
      if (face != kNoIndex && ++rays[face] > rays[most_seen_]) most_seen_ = face;
    }
    rays_ = static_cast<std::uint64_t>(rays[most_seen_]);
    ASSERT_GT(rays_, 100u);
  }
  ViewComparison Compare() {
    Result<ViewComparison> view = CompareView(*file_, Scene(file_->model), camera_);
    EXPECT_TRUE(view.ok());
    return std::move(view.value());
  }
  static std::uint64_t Count(const ViewComparison& view, Verdict verdict) {
    return view.counts[static_cast<std::size_t>(verdict)];
  }

  std::unique_ptr<ComparedFile> file_;
  Camera camera_;
  std::uint32_t most_seen_ = 0;
  std::uint64_t rays_ = 0;
};

TEST_F(Spoiled, NotAtAllHasNoDefect) {
  const ViewComparison view = Compare();
  EXPECT_GE(view.both_within, rays_);
  EXPECT_EQ(view.Defects(), 0u);
}

TEST_F(Spoiled, ALostFaceIsFound) {
  Move(file_->model, most_seen_, 100 * file_->model.Diagonal() * file_->model.bounds.high);
  const ViewComparison view = Compare();
  EXPECT_GE(Count(view, Verdict::kOursLost), rays_ * 9 / 10);
}

TEST_F(Spoiled, AFaceTooNearIsFound) {
  const Vec3 towards_eye = Normalized(camera_.eye - camera_.target);
  Move(file_->model, most_seen_, 1e-2 * file_->model.Diagonal() * towards_eye);
  const ViewComparison view = Compare();
  EXPECT_GE(Count(view, Verdict::kOursInvented), rays_ * 9 / 10);
}

TEST_F(Spoiled, AFaceMovedByTwiceTheAgreementIsFound) {
  const Vec3 towards_eye = Normalized(camera_.eye - camera_.target);
  Move(file_->model, most_seen_, 2 * kAgreement * file_->model.Diagonal() * towards_eye);
  EXPECT_GE(Compare().Defects(), rays_ * 9 / 10);
}

}  // namespace
}  // namespace facetless
