// The judge must find what is wrong, and excuse only what the contract excuses.
#include "tests/verify/oracle/judge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/shapes.h"
#include "tests/unit/nurbs/trim_models.h"
#include "tests/verify/oracle/random_models.h"

namespace facetless::oracle {
namespace {

// A sphere of radius 10 about the origin, and a square behind it.
class JudgeOfASphere : public ::testing::Test {
 protected:
  JudgeOfASphere()
      : model_(facetless::testing::ModelOf(
            {facetless::testing::Sphere({0, 0, 0}, 10),
             facetless::testing::Rectangle({-20, -20, -15}, {40, 0, 0}, {0, 40, 0})})),
        oracle_(model_),
        camera_(NamedView("top", model_.bounds, Projection::kOrthographic, 100, 100).value()),
        direct_(TraceDirect(Scene(model_), camera_, {}).value()),
        judge_(oracle_, camera_) {}

  Claim At(int column, int row) const { return Judge::MakeClaim(direct_.samples, column, row); }
  Verdict VerdictOn(const Claim& claim) const { return judge_.Ask(claim).verdict; }

  Model model_;
  Oracle oracle_;
  Camera camera_;
  DirectResult direct_;
  Judge judge_;
};

TEST_F(JudgeOfASphere, TheRenderersSamplesAreRight) {
  for (int i = 0; i < 100; i += 3) {
    const Judgement judgement = judge_.Ask(At(i, 40));
    EXPECT_EQ(judgement.verdict, Verdict::kRight) << Describe(judgement, model_);
  }
  const Judgement hit = judge_.Ask(At(50, 40));
  EXPECT_TRUE(hit.matched);
  EXPECT_LT(std::fabs(hit.depth_off_mm), 1e-12);
}

TEST_F(JudgeOfASphere, ADepthOffByMoreThanTheBoundIsWrong) {
  Claim claim = At(50, 40);
  ASSERT_EQ(claim.placed_face, 0u);
  claim.depth += 0.5e-12 * model_.Diagonal();
  EXPECT_EQ(VerdictOn(claim), Verdict::kRight);
  claim.depth += 2e-12 * model_.Diagonal();
  EXPECT_EQ(VerdictOn(claim), Verdict::kWrong);
}

TEST_F(JudgeOfASphere, AStatedBoundTakesThePlaceOfTheUsualOne) {
  Claim claim = At(50, 40);
  claim.depth_error = 1e-6;
  claim.depth += 0.9e-6;
  EXPECT_EQ(VerdictOn(claim), Verdict::kRight);
  claim.depth_error = 0.8e-6;
  EXPECT_EQ(VerdictOn(claim), Verdict::kWrong);
}

TEST_F(JudgeOfASphere, SeeingThroughIsWrong) {
  Claim claim = At(50, 40);
  claim.placed_face = 1;
  const Claim corner = At(25, 25);
  ASSERT_EQ(corner.placed_face, 1u);
  claim.depth = corner.depth;  // the square is there, but behind the sphere
  EXPECT_EQ(VerdictOn(claim), Verdict::kWrong);
}

TEST_F(JudgeOfASphere, ALostHitIsWrong) {
  Claim claim = At(50, 40);
  claim.hit = false;
  claim.depth = INFINITY;
  claim.placed_face = kNoIndex;
  const Judgement judgement = judge_.Ask(claim);
  EXPECT_EQ(judgement.verdict, Verdict::kWrong);
  EXPECT_EQ(judgement.oracle_face, 0u);
  EXPECT_EQ(judgement.reach_mm, INFINITY);
}

TEST_F(JudgeOfASphere, AHitOnNothingIsWrong) {
  Claim claim = At(0, 0);
  ASSERT_FALSE(claim.hit);
  claim.hit = true;
  claim.depth = At(50, 40).depth;
  claim.placed_face = 0;
  EXPECT_EQ(VerdictOn(claim), Verdict::kWrong);
}

TEST_F(JudgeOfASphere, TheTallyCountsByCertificate) {
  Claim wrong = At(50, 40);
  wrong.depth += 1;
  Tally tally;
  wrong.certificate = Certificate::kConverged;
  tally.Add(judge_.Ask(wrong));
  EXPECT_EQ(tally.CertifiedWrong(), 0u);
  wrong.certificate = Certificate::kCertified;
  tally.Add(judge_.Ask(wrong));
  EXPECT_EQ(tally.CertifiedWrong(), 1u);
  EXPECT_EQ(tally.Count(Certificate::kConverged, Verdict::kWrong), 1u);
  EXPECT_EQ(tally.list.size(), 2u);
}

// A square of ±1 whose edges have a recorded gap of 1/8, seen from above so that a pixel is 1/16.
class JudgeAtAnEdge : public ::testing::Test {
 protected:
  JudgeAtAnEdge() : model_(trim_models::PlaneModel(-2, 2, -2, 2)) {
    trim_models::AddLoop(model_, trim_models::Polygon({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}), 0.125);
    model_.info.max_edge_gap_mm = 0.125;
    camera_.eye = {0, 0, 8};
    camera_.height = 4;
    camera_.width_px = camera_.height_px = 64;
  }
  // The claim of the pixel whose centre is at x = (column − 31.5)/16.
  Claim Hit(int column) const { return {column, 32, true, 8, 0, Certificate::kCertified, 0}; }
  Claim Miss(int column) const { return {column, 32, false, INFINITY, kNoIndex, Certificate::kCertified, 0}; }
  Verdict VerdictOn(const Claim& claim) const { return Judge(Oracle(model_), camera_).Ask(claim).verdict; }

  Model model_;
  Camera camera_;
};

TEST_F(JudgeAtAnEdge, EitherAnswerPassesWithinTheGap) {
  EXPECT_EQ(VerdictOn(Hit(46)), Verdict::kRight);    // x = 0.906
  EXPECT_EQ(VerdictOn(Miss(46)), Verdict::kAtEdge);  // 0.094 inside
  EXPECT_EQ(VerdictOn(Hit(48)), Verdict::kAtEdge);   // x = 1.031
  EXPECT_EQ(VerdictOn(Miss(48)), Verdict::kRight);
}

TEST_F(JudgeAtAnEdge, BeyondTheGapOnlyOneIsRight) {
  EXPECT_EQ(VerdictOn(Miss(44)), Verdict::kAtTwiceTheGap);  // x = 0.781
  EXPECT_EQ(VerdictOn(Miss(42)), Verdict::kWrong);
  EXPECT_EQ(VerdictOn(Hit(51)), Verdict::kAtTwiceTheGap);  // x = 1.219
  EXPECT_EQ(VerdictOn(Hit(53)), Verdict::kWrong);
}

TEST(Judge, LightThroughASeamIsNeverExcused) {
  // A ray beside an edge of a solid box meets the face on one side or on the other. A miss cannot be excused
  // by the gap, because no neighbouring ray misses.
  Model model = SolidBox({});
  for (Coedge& coedge : model.coedges) coedge.gap_mm = 1e-3;
  model.info.max_edge_gap_mm = 1e-3;
  const Oracle oracle(model);
  Camera camera;
  camera.eye = {8, 8.5, 0.25};
  camera.target = {1, 1, 0.25};
  camera.up = {0, 0, 1};
  camera.height = 3.3e-3;
  camera.width_px = camera.height_px = 33;
  const Judge judge(oracle, camera);
  const Claim miss{14, 16, false, INFINITY, kNoIndex, Certificate::kCertified, 0};
  EXPECT_EQ(judge.Ask(miss).verdict, Verdict::kWrong);
  // Either face is excused.
  const DirectResult direct = TraceDirect(Scene(model), camera, {}).value();
  for (const int column : {14, 18}) {
    Claim claim = Judge::MakeClaim(direct.samples, column, 16);
    ASSERT_TRUE(claim.hit);
    const Verdict verdict = judge.Ask(claim).verdict;
    EXPECT_TRUE(verdict == Verdict::kRight || verdict == Verdict::kAtEdge);
  }
}

TEST(Judge, RoundingOfTheCameraIsKnownForWhatItIs) {
  // A square without edges. A pixel centre lies 1e-15 outside of its border.
  const Model model =
      facetless::testing::ModelOf({facetless::testing::Rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})});
  Camera camera;
  camera.eye = {1 + 0x1p-50, 0.5, 8};
  camera.target = {1 + 0x1p-50, 0.5, 0};
  camera.width_px = camera.height_px = 1;
  const Oracle oracle(model);
  const Judge judge(oracle, camera);
  EXPECT_EQ(judge.Ask({0, 0, false, INFINITY, kNoIndex, Certificate::kCertified, 0}).verdict,
            Verdict::kRight);
  const Judgement judgement = judge.Ask({0, 0, true, 8, 0, Certificate::kCertified, 0});
  EXPECT_EQ(judgement.verdict, Verdict::kWithinRounding);
  EXPECT_LT(judgement.reach_mm, 1e-13);
}

}  // namespace
}  // namespace facetless::oracle
