// What counts as lost, invented and imprecise: each class by a sample that is made for it.
#include "render/compare/hit_errors.h"

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include <cmath>

namespace facetless {
namespace {

struct Pair {
  CameraFrame frame;
  SampleBuffer exact, samples;
};

// Both show face 3 at the depth 100 everywhere, seen at the given cosine; a pixel is `pixel` mm.
Pair Agreeing(int width, int height, double cosine, double pixel) {
  Pair pair;
  pair.frame.forward = {0, 0, -1};
  pair.frame.right = {1, 0, 0};
  pair.frame.down = {0, -1, 0};
  pair.frame.pixel_x = pair.frame.pixel_y = pixel;
  for (SampleBuffer* buffer : {&pair.exact, &pair.samples}) {
    buffer->Resize(width, height);
    buffer->certificate.assign(buffer->size(), Certificate::kCertified);
    for (std::size_t i = 0; i < buffer->size(); ++i) {
      buffer->depth[i] = 100;
      buffer->face[i] = 3;
      buffer->normal[i] = {float(std::sqrt(1 - cosine * cosine)), 0, float(cosine)};
    }
  }
  std::fill(pair.samples.certificate.begin(), pair.samples.certificate.end(), Certificate::kConverged);
  return pair;
}

HitErrors Judged(const Pair& pair, double tolerance_px) {
  return JudgeHits({pair.exact, pair.frame}, pair.samples, tolerance_px);
}

TEST(HitErrors, EachClass) {
  Pair pair = Agreeing(8, 1, 1, 0.5);
  pair.samples.face[1] = kNoIndex;                         // lost
  pair.samples.depth[2] = 101, pair.samples.face[2] = 4;   // another one, farther: lost
  pair.exact.face[3] = kNoIndex;                           // invented
  pair.samples.depth[4] = 99;                              // nearer: invented
  pair.samples.depth[5] = 100 + 1e-4;                      // imprecise
  pair.samples.certificate[6] = Certificate::kUnresolved;  // unresolved
  pair.exact.certificate[7] = Certificate::kConverged, pair.samples.depth[7] = 5;  // not judged
  const HitErrors errors = Judged(pair, 1e-6);
  const HitError expected[] = {HitError::kNone,       HitError::kLost,     HitError::kLost,
                               HitError::kInvented,   HitError::kInvented, HitError::kImprecise,
                               HitError::kUnresolved, HitError::kNotJudged};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(errors.of[i], expected[i]) << i;
  EXPECT_EQ(errors.count(HitError::kLost), 2u);
  EXPECT_EQ(errors.count(HitError::kInvented), 2u);
  EXPECT_EQ(errors.wrong(), 6u);
}

RC_GTEST_PROP(HitErrors, TheToleranceIsMeasuredAlongTheNormal, ()) {
  const double cosine = *rc::gen::inRange(1, 1001) / 1000.0, pixel = std::exp2(*rc::gen::inRange(0, 20)),
               tolerance = std::exp2(*rc::gen::inRange(-30, -10));
  Pair pair = Agreeing(2, 1, cosine, pixel);
  // The distance along the normal is the difference of the depths times the cosine.
  pair.samples.depth[0] += 0.9 * kToleranceSlack * tolerance * pixel / cosine;
  pair.samples.depth[1] -= 1.2 * kToleranceSlack * tolerance * pixel / cosine;
  const HitErrors errors = Judged(pair, tolerance);
  RC_ASSERT(errors.of[0] == HitError::kNone);
  RC_ASSERT(errors.of[1] == HitError::kImprecise);
  RC_ASSERT(std::fabs(errors.largest_px / (0.9 * kToleranceSlack * tolerance) - 1) < 1e-2);
}

TEST(HitErrors, TheBoundOfTheReferenceIsAllowed) {
  Pair pair = Agreeing(1, 1, 1, 1);
  pair.samples.depth[0] += 1e-3;
  EXPECT_EQ(Judged(pair, 1e-9).of[0], HitError::kImprecise);
  pair.exact.depth_error.assign(1, 2e-3f);
  EXPECT_EQ(Judged(pair, 1e-9).of[0], HitError::kNone);
}

TEST(HitErrors, MarksStandOut) {
  Pair pair = Agreeing(9, 9, 1, 1);
  pair.samples.face[4 * 9 + 4] = kNoIndex;
  Image8 picture{9, 9, 3, std::vector<std::uint8_t>(9 * 9 * 3, 0)};
  MarkHitErrors(Judged(pair, 1e-6), &picture);
  for (int row = 0; row < 9; ++row)
    for (int column = 0; column < 9; ++column) {
      const std::uint8_t* p = picture.bytes.data() + 3 * (row * 9 + column);
      const bool marked = std::abs(row - 4) <= 1 && std::abs(column - 4) <= 1;
      EXPECT_EQ(p[0] == 213 && p[1] == 94 && p[2] == 0, marked) << row << ", " << column;
      if (!marked) {
        EXPECT_TRUE(p[0] == 128 && p[1] == 128 && p[2] == 128);
      }
    }
}

}  // namespace
}  // namespace facetless
