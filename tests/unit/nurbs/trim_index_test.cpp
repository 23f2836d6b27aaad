// The trim index as a specification: the even-odd rule against brute force, conservative rectangles, bands,
// corners, and shapes that occur in real files.
#include "render/nurbs/trim_index.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tests/unit/nurbs/trim_models.h"

namespace facetless {
namespace {

using namespace trim_models;

constexpr double kPi = 3.14159265358979323846;

FaceTrim TrimOf(const std::vector<Outline>& loops, double gap_mm = 0) {
  Model model = PlaneModel(-2, 2, -2, 2);
  for (const Outline& loop : loops) AddLoop(model, loop, gap_mm);
  return FaceTrim::Build(model, 0);
}

bool Inside(const FaceTrim& trim, double u, double v) {
  return trim.Query(u, v, 0, 0).inside;
}

// A closed chain of Bézier segments with random degrees, weights and points in [−1, 1]². It usually crosses
// itself.
Outline RandomLoop(Random& random, int max_degree) {
  const int segments = random.Integer(1, 8);
  std::vector<Vec2> joints;
  for (int i = 0; i < segments; ++i) joints.push_back({random.Uniform(-1, 1), random.Uniform(-1, 1)});
  Outline outline;
  for (int i = 0; i < segments; ++i) {
    const int degree = random.Integer(segments < 3 ? std::min(3, max_degree) : 1, max_degree);
    const bool rational = random.Integer(0, 1) == 1;
    Curve curve;
    for (int k = 0; k <= degree; ++k) {
      const Vec2 p = k == 0        ? joints[i]
                     : k == degree ? joints[(i + 1) % segments]
                                   : Vec2{random.Uniform(-1, 1), random.Uniform(-1, 1)};
      const double w = rational && k > 0 && k < degree ? random.Uniform(0.2, 3) : 1;
      curve.push_back({w * p.x, w * p.y, w});
    }
    outline.push_back({curve});
  }
  return outline;
}

void CompareWithSampling(const std::vector<Outline>& loops, Random& random, int samples, double clearance) {
  const FaceTrim trim = TrimOf(loops);
  const Sampled sampled(loops, samples);
  int compared = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec2 q{random.Uniform(-1.2, 1.2), random.Uniform(-1.2, 1.2)};
    if (sampled.Distance(q) < clearance) continue;
    const TrimAnswer answer = trim.Query(q.x, q.y, 0, 0);
    RC_ASSERT(answer.inside == sampled.Inside(q));
    RC_ASSERT(answer.certain);
    RC_ASSERT(answer.coedge == kNoIndex);
    ++compared;
  }
  RC_ASSERT(compared > 20);
}

RC_GTEST_PROP(TrimIndex, PolygonsAgreeWithBruteForce, (std::uint32_t seed)) {
  Random random(seed);
  std::vector<Vec2> corners;
  for (int i = random.Integer(3, 60); i > 0; --i)
    corners.push_back({random.Uniform(-1, 1), random.Uniform(-1, 1)});
  CompareWithSampling({Polygon(corners)}, random, 1, 1e-12);
}

RC_GTEST_PROP(TrimIndex, SplinesAgreeWithBruteForce, (std::uint32_t seed)) {
  Random random(seed);
  CompareWithSampling({RandomLoop(random, 6), RandomLoop(random, 3)}, random, 500, 1e-3);
}

RC_GTEST_PROP(TrimIndex, HighDegreesAgreeWithBruteForce, (std::uint32_t seed)) {
  Random random(seed);
  CompareWithSampling({RandomLoop(random, 25)}, random, 500, 2e-3);
}

// Many corners lie exactly on these heights, where careless counting counts a corner twice or never.
RC_GTEST_PROP(TrimIndex, CornersOnTheHalfLineCountOnce, (std::uint32_t seed)) {
  Random random(seed);
  std::vector<Vec2> corners;
  for (int i = random.Integer(3, 30); i > 0; --i)
    corners.push_back({random.Integer(-4, 4) / 4.0, random.Integer(-4, 4) / 4.0});
  const std::vector<Outline> loops{Polygon(corners)};
  const FaceTrim trim = TrimOf(loops);
  const Sampled sampled(loops, 1);
  for (int i = -16; i <= 16; ++i)
    for (int j = -4; j <= 4; ++j) {
      const Vec2 q{(i + 0.37) / 12, j / 4.0};
      if (sampled.Distance(q) > 1e-12) RC_ASSERT(Inside(trim, q.x, q.y) == sampled.Inside(q));
    }
}

RC_GTEST_PROP(TrimIndex, RectanglesAreProven, (std::uint32_t seed)) {
  Random random(seed);
  const FaceTrim trim = TrimOf({RandomLoop(random, 5), RandomLoop(random, 2)}, random.Uniform(0, 1e-3));
  int decided = 0;
  for (int i = 0; i < 100; ++i) {
    const double size = std::exp2(random.Uniform(-12, 0));
    const double u0 = random.Uniform(-1.2, 1.2), v0 = random.Uniform(-1.2, 1.2);
    const double u1 = u0 + size * random.Uniform(0, 1), v1 = v0 + size * random.Uniform(0, 1);
    const RectClass where = trim.Classify(u0, u1, v0, v1);
    if (where == RectClass::kMixed) continue;
    ++decided;
    for (int k = 0; k < 30; ++k) {
      const double u = k == 0 ? u0 : k == 1 ? u1 : random.Uniform(u0, u1);
      const double v = k == 0 ? v0 : k == 1 ? v1 : random.Uniform(v0, v1);
      const TrimAnswer answer = trim.Query(u, v, 0, 0);
      RC_ASSERT(answer.inside == (where == RectClass::kInside));
      RC_ASSERT(answer.certain);
      RC_ASSERT(answer.coedge == kNoIndex);
    }
  }
  RC_ASSERT(decided > 20);
}

RC_GTEST_PROP(TrimIndex, SmallRectanglesOffTheCurvesAreDecided, (std::uint32_t seed)) {
  Random random(seed);
  const std::vector<Outline> loops{RandomLoop(random, 4)};
  const FaceTrim trim = TrimOf(loops);
  const Sampled sampled(loops, 500);
  for (int i = 0; i < 100; ++i) {
    const Vec2 q{random.Uniform(-1, 1), random.Uniform(-1, 1)};
    const double half = 0.5 * sampled.Distance(q);
    if (half < 1e-3) continue;
    RC_ASSERT(trim.Classify(q.x - half, q.x + half, q.y - half, q.y + half) != RectClass::kMixed);
  }
}

RC_GTEST_PROP(TrimIndex, SenseOfALoopDoesNotMatter, (std::uint32_t seed)) {
  Random random(seed);
  const Outline outline = RandomLoop(random, 4);
  const FaceTrim forward = TrimOf({outline}), backward = TrimOf({Reversed(outline)});
  for (int i = 0; i < 100; ++i) {
    const double u = random.Uniform(-1, 1), v = random.Uniform(-1, 1);
    RC_ASSERT(Inside(forward, u, v) == Inside(backward, u, v));
  }
}

RC_GTEST_PROP(TrimIndex, AnswersAreTheSameBits, (std::uint32_t seed)) {
  Random random(seed);
  const Outline outline = RandomLoop(random, 6);
  const FaceTrim a = TrimOf({outline}, 1e-2), b = TrimOf({outline}, 1e-2);
  for (int i = 0; i < 100; ++i) {
    const double u = random.Uniform(-1, 1), v = random.Uniform(-1, 1);
    const TrimAnswer x = a.Query(u, v, 1e-4, 1e-4), y = b.Query(u, v, 1e-4, 1e-4);
    RC_ASSERT(x.inside == y.inside && x.certain == y.certain && x.coedge == y.coedge && x.path == y.path);
    RC_ASSERT(x.other_coedge == y.other_coedge);
    RC_ASSERT(std::memcmp(&x.edge_parameter, &y.edge_parameter, sizeof(double)) == 0);
  }
}

TEST(TrimIndex, CircleIsExact) {
  const FaceTrim trim = TrimOf({Circle({0.25, -0.5}, 0.75)});
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    // Test points very close to the curve, from a distance of 1e-15 on.
    const double angle = random.Uniform(0, 2 * kPi), off = std::pow(10, random.Uniform(-13.5, -1));
    for (double side : {-1.0, 1.0}) {
      const double r = 0.75 + side * off;
      const TrimAnswer answer = trim.Query(0.25 + r * std::cos(angle), -0.5 + r * std::sin(angle), 0, 0);
      EXPECT_EQ(answer.inside, side < 0) << off << " at " << angle;
      EXPECT_TRUE(answer.certain || off < 1e-13) << off << " at " << angle;
    }
  }
}

TEST(TrimIndex, NamesTheTestThatAnswered) {
  const FaceTrim trim = TrimOf({Circle({0, 0}, 1)});
  EXPECT_EQ(trim.Query(0, 0, 0, 0).path, TrimPath::kBoxes);
  EXPECT_EQ(trim.Query(1.5, 0.1, 0, 0).path, TrimPath::kBoxes);
  const double r = 1 - 1e-9;
  EXPECT_EQ(trim.Query(r * std::cos(0.5), r * std::sin(0.5), 0, 0).path, TrimPath::kCurve);
  // The point is in the box of a piece, but outside its strip.
  bool strip = false;
  for (int i = 0; i < 100; ++i) strip |= trim.Query(0.7 + 0.001 * i, 0.65, 0, 0).path == TrimPath::kStrip;
  EXPECT_TRUE(strip);
}

TEST(TrimIndex, ErrorBoxThatMeetsACurveIsNotCertain) {
  const FaceTrim trim = TrimOf({Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}})});
  EXPECT_TRUE(trim.Query(0.5, 1e-6, 1e-7, 1e-7).certain);
  const TrimAnswer near = trim.Query(0.5, 1e-6, 1e-7, 1e-5);
  EXPECT_FALSE(near.certain);
  EXPECT_TRUE(near.inside);
  EXPECT_EQ(near.coedge, 0u);
  EXPECT_NEAR(near.edge_parameter, 0.5, 1e-12);
  EXPECT_FALSE(trim.Query(0.5, 0, 0, 0).certain);
}

TEST(TrimIndex, NotANumberIsNeitherInsideNorCertain) {
  const FaceTrim trim = TrimOf({Circle({0, 0}, 1)});
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (double bad : {nan, infinity, -infinity}) {
    EXPECT_FALSE(trim.Query(bad, 0, 0, 0).inside);
    EXPECT_FALSE(trim.Query(bad, 0, 0, 0).certain);
    EXPECT_FALSE(trim.Query(0, bad, 0, 0).certain);
    EXPECT_EQ(trim.Classify(bad, 0.1, 0, 0.1), RectClass::kMixed);
    EXPECT_EQ(trim.Classify(0, 0.1, 0, bad), RectClass::kMixed);
  }
  EXPECT_FALSE(trim.Query(0, 0, nan, 0).certain);
  EXPECT_EQ(trim.Classify(0.1, 0, 0, 0.1), RectClass::kMixed);
}

TEST(TrimIndex, HolesAndLoopsThatTouch) {
  // A hole that touches the outer loop in a corner and another hole along a side.
  const FaceTrim trim =
      TrimOf({Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), Polygon({{0, 0}, {0.2, 0.4}, {0.4, 0.2}}),
              Polygon({{0.5, 0.5}, {0.7, 0.5}, {0.7, 0.7}, {0.5, 0.7}}),
              Polygon({{0.7, 0.5}, {0.9, 0.5}, {0.9, 0.7}, {0.7, 0.7}})});
  EXPECT_TRUE(Inside(trim, 0.5, 0.1));
  EXPECT_FALSE(Inside(trim, 0.2, 0.2));
  EXPECT_FALSE(Inside(trim, 0.6, 0.6));
  EXPECT_FALSE(Inside(trim, 0.8, 0.6));
  EXPECT_TRUE(Inside(trim, 0.95, 0.6));
  EXPECT_TRUE(Inside(trim, 0.001, 0.5));
}

TEST(TrimIndex, FigureOfEightTouchesItself) {
  const FaceTrim trim = TrimOf({Polygon({{-1, -1}, {1, 1}, {1, -1}, {-1, 1}})});
  EXPECT_TRUE(Inside(trim, 0.5, 0.1));
  EXPECT_TRUE(Inside(trim, -0.5, 0.1));
  EXPECT_FALSE(Inside(trim, 0, 0.5));
  EXPECT_FALSE(Inside(trim, 0, -0.5));
}

TEST(TrimIndex, GapsBetweenSegmentsAreClosed) {
  // Each side starts a little beside the end of the previous one.
  Outline outline{{Line({0, 0}, {1, 1e-5})},
                  {Line({1, 0}, {1, 1})},
                  {Line({1 + 1e-6, 1}, {0, 1})},
                  {Line({0, 1}, {1e-5, 0})}};
  Model model = PlaneModel(-2, 2, -2, 2);
  AddOpenLoop(model, outline);
  const FaceTrim trim = FaceTrim::Build(model, 0);
  for (double v : {1e-7, 2e-6, 0.5e-5, 0.999999, 1.0}) {
    EXPECT_FALSE(Inside(trim, -0.5, v)) << v;
    EXPECT_FALSE(Inside(trim, 1.5, v)) << v;
  }
  EXPECT_TRUE(Inside(trim, 0.5, 0.5));
  EXPECT_EQ(trim.piece_count(), 7u);  // three of the four corners have a gap
}

TEST(TrimIndex, RoundingAtJointsNeedsNoExtraPiece) {
  Outline outline = Circle({0.1, 0.3}, 0.7);
  const std::size_t pieces = TrimOf({outline}).piece_count();
  for (Curve& curve : outline[0])
    for (Vec3& p : curve) p.x = std::nextafter(p.x, 1.0), p.y = std::nextafter(p.y, -1.0);
  EXPECT_EQ(TrimOf({outline}).piece_count(), pieces);
}

TEST(TrimIndex, FeaturesOfABillionthKeepTheirShape) {
  const double size = 1e-9;
  const FaceTrim trim = TrimOf({Polygon({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}), Circle({0.5, 0.5}, size)});
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const double angle = random.Uniform(0, 2 * kPi), r = size * random.Uniform(0, 2);
    if (std::fabs(r - size) < 1e-5 * size) continue;
    EXPECT_EQ(Inside(trim, 0.5 + r * std::cos(angle), 0.5 + r * std::sin(angle)), r > size) << r / size;
  }
  EXPECT_EQ(trim.Classify(0.4, 0.6, 0.4, 0.6), RectClass::kMixed);
  EXPECT_EQ(trim.Classify(0.4, 0.49, 0.4, 0.6), RectClass::kInside);
}

TEST(TrimIndex, TenThousandSegments) {
  // A gear in polar coordinates: whether a point is inside is known without looking at the loop.
  constexpr int kTeeth = 5000;
  std::vector<Vec2> corners;
  for (int i = 0; i < 2 * kTeeth; ++i) {
    const double angle = i * kPi / kTeeth, r = i % 2 == 0 ? 1.0 : 0.9;
    corners.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  const FaceTrim trim = TrimOf({Polygon(corners)});
  EXPECT_EQ(trim.piece_count(), 10000u);
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const double u = random.Uniform(-1.1, 1.1), v = random.Uniform(-1.1, 1.1), r = std::hypot(u, v);
    if (r > 0.8999 && r < 1.0001) continue;
    EXPECT_EQ(Inside(trim, u, v), r < 0.95);
  }
  EXPECT_EQ(trim.Classify(-0.6, 0.6, -0.6, 0.6), RectClass::kInside);
}

TEST(TrimIndex, CurvesThatDegenerateToLinesAndPoints) {
  // Segments of degree 5 along the axes, a collapsed segment, and a cubic with a cusp.
  const auto straight = [](Vec2 a, Vec2 b) {
    Curve curve;
    for (int i = 0; i <= 5; ++i) {
      const Vec2 p = a + (i / 5.0) * (b - a);
      curve.push_back({p.x, p.y, 1});
    }
    return curve;
  };
  const FaceTrim trim = TrimOf({{{straight({0.1, 0.1}, {0.9, 0.1})},
                                 {straight({0.9, 0.1}, {0.9, 0.1})},
                                 {straight({0.9, 0.1}, {0.9, 0.9})},
                                 {{{0.9, 0.9, 1}, {-0.5, 0.5, 1}, {1.5, 0.5, 1}, {0.1, 0.9, 1}}},
                                 {straight({0.1, 0.9}, {0.1, 0.1})}}});
  EXPECT_TRUE(Inside(trim, 0.5, 0.2));
  EXPECT_FALSE(Inside(trim, 0.5, 0.95));
  EXPECT_FALSE(Inside(trim, 0.5, 0.05));
  EXPECT_TRUE(Inside(trim, 0.1 + 1e-12, 0.5));
  EXPECT_FALSE(Inside(trim, 0.1 - 1e-12, 0.5));
}

TEST(TrimIndex, NoLoopsMeansTheWholeGrid) {
  const FaceTrim trim = FaceTrim::Build(PlaneModel(-2, 2, -1, 1), 0);
  EXPECT_TRUE(trim.whole());
  EXPECT_TRUE(Inside(trim, 1.99, 0.99));
  EXPECT_FALSE(Inside(trim, 2.01, 0));
  EXPECT_EQ(trim.Classify(-1.9, 1.9, -0.9, 0.9), RectClass::kInside);
  EXPECT_EQ(trim.Classify(-1.9, 2.1, -0.9, 0.9), RectClass::kMixed);
}

TEST(TrimIndex, BorderOfTheGridIsWholeAndASmallerLoopIsNot) {
  EXPECT_TRUE(TrimOf({Polygon({{-2, -2}, {2, -2}, {2, 2}, {-2, 2}})}).whole());
  EXPECT_FALSE(TrimOf({Polygon({{-2, -2}, {1.99, -2}, {1.99, 2}, {-2, 2}})}).whole());
  EXPECT_FALSE(TrimOf({Polygon({{-2, -2}, {2, -2}, {2, 2}})}).whole());
  EXPECT_FALSE(TrimOf({Polygon({{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}), Circle({0, 0}, 0.1)}).whole());
}

TEST(TrimIndex, SphereWithSeamAndPoles) {
  const Model model = SphereModel();
  const FaceTrim trim = FaceTrim::Build(model, 0);
  EXPECT_TRUE(trim.whole());
  for (double u : {1e-9, 1.0, 2 * kPi - 1e-9})
    for (double v : {-kPi / 2 + 1e-9, 0.0, kPi / 2 - 1e-9}) {
      EXPECT_TRUE(Inside(trim, u, v)) << u << " " << v;
      EXPECT_TRUE(trim.Query(u, v, 0, 0).certain);
    }
  EXPECT_FALSE(Inside(trim, -1e-9, 0));
  // Next to the pole, the seam's band extends all around; at the equator, it is as wide as rounding.
  EXPECT_EQ(trim.Query(1, 0, 0, 0).coedge, kNoIndex);
  EXPECT_EQ(trim.Query(1e-12, 0, 0, 0).coedge, kNoIndex);
  const TrimAnswer seam = trim.Query(1e-16, 0.1, 0, 0);
  EXPECT_EQ(seam.coedge, 3u);
  const TrimAnswer pole = trim.Query(1, kPi / 2, 0, 0);
  EXPECT_FALSE(pole.certain);
  EXPECT_EQ(model.coedges[pole.coedge].edge, 0u);
  EXPECT_NE(pole.other_coedge, kNoIndex);
  // Except in a thin frame, rectangles are known to be inside.
  EXPECT_EQ(trim.Classify(1e-3, 2 * kPi - 1e-3, -kPi / 2 + 1e-3, kPi / 2 - 1e-3), RectClass::kInside);
}

TEST(TrimIndex, SlitsBoundNothing) {
  // A square with a square hole. A bridge, which is followed in both directions, joins the two.
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, {{Line({0, 0}, {1, 0})},
                  {Line({1, 0}, {1, 1})},
                  {Line({1, 1}, {0, 1})},
                  {Line({0, 1}, {0, 0})},
                  {Line({0, 0}, {0.4, 0.4})},  // bridge
                  {Line({0.4, 0.4}, {0.4, 0.6})},
                  {Line({0.4, 0.6}, {0.6, 0.6})},
                  {Line({0.6, 0.6}, {0.6, 0.4})},
                  {Line({0.6, 0.4}, {0.4, 0.4})},
                  {Line({0.4, 0.4}, {0, 0})}});  // and back
  model.coedges[9].edge = 4;
  model.coedges[9].reversed = true;
  model.trim_segments[9].edge_begin = 1;
  model.trim_segments[9].edge_end = 0;
  const FaceTrim trim = FaceTrim::Build(model, 0);
  for (int i = 1; i < 100; ++i) {
    const double x = 0.004 * i;
    const TrimAnswer on = trim.Query(x, x, 1e-9, 1e-9);
    EXPECT_TRUE(on.inside);
    EXPECT_TRUE(on.certain);
    EXPECT_TRUE(Inside(trim, x, x + 1e-16));
  }
  EXPECT_FALSE(Inside(trim, 0.5, 0.5));
  EXPECT_EQ(trim.Classify(0.1, 0.3, 0.1, 0.3), RectClass::kInside);
}

TEST(TrimIndex, BandFollowsTheMetric) {
  // On a cylinder of radius 10, 1 mm around the axis is 0.1 rad, and 1 mm along the axis is 1.
  Model model = HalfCylinderModel(10, 5);
  AddLoop(model, Polygon({{0.5, 1}, {2.5, 1}, {2.5, 4}, {0.5, 4}}), 0.01);
  const FaceTrim trim = FaceTrim::Build(model, 0);
  const auto in_band = [&](double u, double v, double scale = 1) {
    return trim.Query(u, v, 0, 0, scale).coedge;
  };
  EXPECT_EQ(in_band(0.5 + 0.0009, 2), 3u);
  EXPECT_EQ(in_band(0.5 + 0.0022, 2), kNoIndex);
  EXPECT_EQ(in_band(1, 1 - 0.009), 0u);
  EXPECT_EQ(in_band(1, 1 - 0.022), kNoIndex);
  EXPECT_EQ(in_band(1, 1 - 0.022, 4), 0u);
  EXPECT_EQ(in_band(1, 1 - 0.009, 0), kNoIndex);
  // In the band, the p-curve's answer is still certain, and rectangles are mixed.
  EXPECT_TRUE(trim.Query(1, 1.009, 0, 0).certain);
  EXPECT_EQ(trim.Classify(1, 1.1, 1.009, 1.2), RectClass::kMixed);
  EXPECT_EQ(trim.Classify(1, 1.1, 1.022, 1.2), RectClass::kInside);
  EXPECT_EQ(trim.Classify(1, 1.1, 1.022, 1.2, 4), RectClass::kMixed);
}

TEST(TrimIndex, MaterialSideFollowsTheCountNotTheFile) {
  const Outline square = Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), hole = Circle({0.5, 0.5}, 0.2);
  const auto left = [](const FaceTrim& trim, double u, double v) {
    const TrimAnswer answer = trim.Query(u, v, 1e-6, 1e-6);
    EXPECT_NE(answer.coedge, kNoIndex);
    return answer.material_left;
  };
  const FaceTrim good = TrimOf({square, Reversed(hole)}), bad = TrimOf({Reversed(square), hole});
  for (Vec2 q : {Vec2{0.5, 0}, Vec2{1, 0.5}, Vec2{0.5, 1}, Vec2{0, 0.5}, Vec2{0.7, 0.5}, Vec2{0.5, 0.3}}) {
    EXPECT_TRUE(left(good, q.x, q.y)) << q.x << " " << q.y;
    EXPECT_FALSE(left(bad, q.x, q.y)) << q.x << " " << q.y;
  }
}

TEST(TrimIndex, CornersNameBothCoedges) {
  const FaceTrim trim = TrimOf({Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}})}, 1e-3);
  // The point is next to (1, 0), where coedge 0 ends and coedge 1 begins.
  const TrimAnswer corner = trim.Query(1 - 0.0005, 0.0004, 0, 0);
  EXPECT_EQ(corner.coedge, 0u);
  EXPECT_EQ(corner.other_coedge, 1u);
  EXPECT_TRUE(corner.other_is_next);
  EXPECT_NEAR(corner.edge_parameter, 1 - 0.0005, 1e-12);
  EXPECT_NEAR(corner.other_edge_parameter, 0.0004, 1e-12);
  const TrimAnswer beyond = trim.Query(1.0004, -0.0005, 0, 0);
  EXPECT_TRUE((beyond.coedge == 0 && beyond.other_coedge == 1) ||
              (beyond.coedge == 1 && beyond.other_coedge == 0));
  const TrimAnswer first = trim.Query(0.0004, 0.0005, 0, 0);
  EXPECT_EQ(first.coedge, 3u);
  EXPECT_EQ(first.other_coedge, 0u);
  EXPECT_TRUE(first.other_is_next);
  EXPECT_EQ(trim.Query(0.5, 0.0005, 0, 0).other_coedge, kNoIndex);
}

TEST(TrimIndex, BothSidesOfANarrowWedgeAreAsked) {
  // The point is far from the corner, but the bands of the two sides still overlap.
  const FaceTrim trim = TrimOf({Polygon({{0, 0}, {1, 0}, {1, 0.001}})}, 1e-3);
  const TrimAnswer wedge = trim.Query(0.5, 0.0001, 0, 0);
  EXPECT_EQ(wedge.coedge, 0u);
  EXPECT_EQ(wedge.other_coedge, 2u);
  EXPECT_FALSE(wedge.other_is_next);
  EXPECT_NEAR(wedge.other_edge_parameter, 0.5, 1e-5);
}

TEST(TrimIndex, EdgeParameterRunsWithTheEdge) {
  Model model = PlaneModel(-2, 2, -2, 2);
  AddLoop(model, Circle({0, 0}, 1), 1e-3);
  const FaceTrim trim = FaceTrim::Build(model, 0);
  // Four rational quarters. The middle of each is at the middle of its parameter range.
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double angle = (quarter + 0.5) * kPi / 2;
    const TrimAnswer answer = trim.Query(1.0005 * std::cos(angle), 1.0005 * std::sin(angle), 0, 0);
    EXPECT_EQ(answer.coedge, 0u);
    EXPECT_NEAR(answer.edge_parameter, quarter + 0.5, 1e-9);
    EXPECT_EQ(answer.other_coedge, kNoIndex);
  }
}

}  // namespace
}  // namespace facetless
