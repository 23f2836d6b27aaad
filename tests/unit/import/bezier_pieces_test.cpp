// Bézier pieces of curves, against closed forms.
#include "import/bezier_pieces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "import/approximate.h"

namespace facetless {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

TEST(ArcPieces, LieOnTheCircleAtTheirNativeAngle) {
  const Vec3 center{3, -2, 5}, x{0, 7, 0}, y{0, 0, 7};
  for (const double last : {0.1, 1.0, std::numbers::pi, 2 * std::numbers::pi, 7.0}) {
    const auto pieces = ArcPieces(center, x, y, -0.3, last, std::numbers::pi / 2);
    EXPECT_EQ(pieces.front().begin, -0.3);
    EXPECT_EQ(pieces.back().end, last);
    for (const CurvePiece& piece : pieces) {
      EXPECT_LE(piece.end - piece.begin, std::numbers::pi / 2 * (1 + 1e-12));
      for (int i = 0; i <= 20; ++i) {
        const double angle = piece.begin + (piece.end - piece.begin) * i / 20;
        const double t = PieceParameter(piece.begin, piece.end, piece.map, angle);
        const Vec3 p = Cartesian(EvaluateBezier(piece.points, t)),
                   q = center + std::cos(angle) * x + std::sin(angle) * y;
        EXPECT_LE(Length(p - q), 16 * 7 * kUlp) << angle;
        EXPECT_NEAR(NativeParameter(piece.begin, piece.end, piece.map, t), angle, 8 * kUlp * 7);
      }
    }
  }
}

TEST(ArcPieces, AFullTurnTakesFourQuartersAndClosesExactlyWherePiecesMeet) {
  const auto pieces = ArcPieces({}, {1, 0, 0}, {0, 1, 0}, 0, 2 * std::numbers::pi, std::numbers::pi / 2);
  ASSERT_EQ(pieces.size(), 4u);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(pieces[i].begin, pieces[i - 1].end);
    EXPECT_EQ(pieces[i].points.front().x, pieces[i - 1].points.back().x);
    EXPECT_EQ(pieces[i].points.front().y, pieces[i - 1].points.back().y);
  }
}

// De Boor's algorithm, implemented directly from its definition, as an oracle.
Vec4 DeBoor(const std::vector<double>& knots, int degree, const std::vector<Vec4>& poles, double x) {
  int span = degree;
  while (span + 2 < static_cast<int>(knots.size()) - degree && x >= knots[span + 1]) ++span;
  return BsplineSpanPoints(knots, degree, poles, span, x, x).front();
}

TEST(BsplinePieces, PointsOfABezierSpanComeOutUnchanged) {
  const std::vector<double> knots{0, 0, 0, 0, 0.3, 0.3, 0.3, 1, 1, 1, 1};
  std::vector<Vec4> poles;
  for (int i = 0; i < 7; ++i) poles.push_back({std::sqrt(2.0 + i), std::sqrt(3.0 * i), 1.0 / (i + 3), 1});
  const auto pieces = BsplinePieces(knots, 3, poles, 0, 1);
  ASSERT_EQ(pieces.size(), 2u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(pieces[0].points[i].x, poles[i].x);
    EXPECT_EQ(pieces[1].points[i].x, poles[i + 3].x);
    EXPECT_EQ(pieces[1].points[i].w, 1);
  }
}

TEST(BsplinePieces, AgreeWithDeBoorForRandomCurvesOfAllDegrees) {
  const unsigned seed = 7;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int degree = 1; degree <= 25; ++degree) {
    // An unclamped knot vector with some multiple knots.
    std::vector<double> knots{-2};
    while (static_cast<int>(knots.size()) < 3 * degree + 5) {
      const int multiplicity = 1 + static_cast<int>(random() % static_cast<unsigned>(degree));
      const double knot = knots.back() + 0.05 + uniform(random);
      for (int i = 0; i < multiplicity; ++i) knots.push_back(knot);
    }
    std::vector<Vec4> poles;
    for (int i = 0; i < static_cast<int>(knots.size()) - degree - 1; ++i) {
      const double w = 0.2 + uniform(random);
      poles.push_back({w * uniform(random), w * uniform(random), w * uniform(random), w});
    }
    const double first = knots[degree], last = knots[knots.size() - degree - 1];
    const double begin = first + 0.13 * (last - first), end = first + 0.91 * (last - first);
    const auto pieces = BsplinePieces(knots, degree, poles, begin, end);
    ASSERT_FALSE(pieces.empty());
    EXPECT_EQ(pieces.front().begin, begin);
    EXPECT_EQ(pieces.back().end, end);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (i > 0) {
        EXPECT_EQ(pieces[i].begin, pieces[i - 1].end);
        EXPECT_EQ(pieces[i].points.front().x, pieces[i - 1].points.back().x);
      }
      for (const double t : {0.0, 0.31, 0.77}) {
        const double x = pieces[i].begin + t * (pieces[i].end - pieces[i].begin);
        const Vec3 p = Cartesian(EvaluateBezier(pieces[i].points, t)),
                   q = Cartesian(DeBoor(knots, degree, poles, x));
        EXPECT_LE(Length(p - q), 1e-12) << "seed " << seed << " degree " << degree << " piece " << i;
      }
    }
  }
}

TEST(BsplinePieces, TheEndSpansGoOnBeyondTheDomain) {
  // x(t) = t² on [0, 1], and beyond.
  const auto pieces = BsplinePieces(std::vector<double>{0, 0, 0, 1, 1, 1}, 2,
                                    std::vector<Vec4>{{0, 0, 0, 1}, {0, 0, 0, 1}, {1, 0, 0, 1}}, -0.25, 1.5);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].points.front().x, 0.0625, kUlp);
  EXPECT_NEAR(pieces[0].points.back().x, 2.25, 8 * kUlp);
}

TEST(KnotStretches, ASliverOfRoundingJoinsItsNeighbour) {
  const std::vector<double> knots{0, 0, 1, 2, 2};
  const auto stretches = KnotStretches(knots, 1, 1 - 1e-16, 2);
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].span, 2);
}

TEST(ElevateDegree, KeepsTheCurveAndTheWeightsOfPolynomials) {
  std::vector<CurvePiece> pieces{{0, 1, SpanMap::kLinear, {{1, 2, 3, 1}, {4, 1, -1, 1}, {0.1, 0.2, 0.3, 1}}}};
  const std::vector<Vec4> before = pieces[0].points;
  ElevateDegree(pieces, 7);
  ASSERT_EQ(pieces[0].degree(), 7);
  for (const Vec4& p : pieces[0].points) EXPECT_EQ(p.w, 1);
  for (int i = 0; i <= 10; ++i) {
    const double t = i / 10.0;
    EXPECT_LE(Length(Cartesian(EvaluateBezier(before, t)) - Cartesian(EvaluateBezier(pieces[0].points, t))),
              16 * kUlp);
  }
}

TEST(ApproximateCurve, ReachesItsToleranceAndSaysSo) {
  const auto spiral = [](double t) {
    return Vec3{std::exp(t) * std::cos(5 * t), std::exp(t) * std::sin(5 * t), std::cosh(t)};
  };
  double deviation = 0;
  const auto pieces = ApproximateCurve(spiral, {-1, 2}, 1e-9, 10, &deviation);
  EXPECT_LE(deviation, 1e-9);
  double worst = 0;
  for (const CurvePiece& piece : pieces) {
    EXPECT_EQ(piece.degree(), kApproximationDegree);
    for (int i = 0; i <= 50; ++i) {
      const double t = i / 50.0;
      worst = std::fmax(worst, Length(Cartesian(EvaluateBezier(piece.points, t)) -
                                      spiral(piece.begin + t * (piece.end - piece.begin))));
    }
  }
  EXPECT_LE(worst, 2e-9);
}

TEST(ApproximateSurface, RefinesOnlyWhereItMust) {
  // The surface is wavy along u and straight along v.
  const auto wavy = [](double u, double v) { return Vec3{u, v, std::sin(9 * u)}; };
  const ApproximateGrid grid = ApproximateSurface(wavy, {0, 3}, {0, 1}, 1e-10);
  EXPECT_GT(grid.u_breaks.size(), 3u);
  EXPECT_EQ(grid.v_breaks.size(), 2u);
  EXPECT_LE(grid.deviation, 1e-10);
}

}  // namespace
}  // namespace facetless
