#include "bench/scene_surfaces.h"

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace facetless {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

Vec4 Weighted(Vec3 p, double w) {
  return {w * p.x, w * p.y, w * p.z, w};
}

std::vector<Span> UnitSpans(int count) {
  std::vector<Span> spans(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    spans[static_cast<std::size_t>(i)] = {static_cast<double>(i), i + 1.0, SpanMap::kLinear};
  return spans;
}

Model Placed(ModelBuilder builder) {
  builder.AddInstance({});
  return std::move(builder).Finish().value();
}

void AddUniformBspline(ModelBuilder& builder, int columns, int rows,
                       const std::function<Vec4(int, int)>& net) {
  // This matrix converts the four B-spline control points of a span to its Bézier points, times 6.
  constexpr double kToBezier[4][4] = {{1, 4, 1, 0}, {0, 4, 2, 0}, {0, 2, 4, 0}, {0, 1, 4, 1}};
  std::vector<Vec4> points;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j)
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) {
          Vec4 sum{0, 0, 0, 0};
          bool polynomial = true;
          for (int a = 0; a < 4; ++a)
            for (int b = 0; b < 4; ++b) {
              const double share = kToBezier[k][a] * kToBezier[l][b] / 36;
              const Vec4 p = net(i + a, j + b);
              polynomial = polynomial && p.w == 1;
              sum = {sum.x + share * p.x, sum.y + share * p.y, sum.z + share * p.z, sum.w + share * p.w};
            }
          if (polynomial) sum.w = 1;  // the shares add up to 1 only up to rounding
          points.push_back(sum);
        }
  builder.AddFace({SurfaceKind::kBspline, 3, 3, UnitSpans(columns), UnitSpans(rows), points});
}

void AddTube(ModelBuilder& builder, int around, int along, double height,
             const std::function<Vec3(double, double)>& at, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<double> weights(static_cast<std::size_t>(around * (along + 3)), 1);
  if (seed != 0)
    for (double& weight : weights) weight = 0.75 + 0.5 * static_cast<double>(engine() >> 11) * 0x1p-53;
  AddUniformBspline(builder, around, along, [&](int i, int j) {
    const double angle = 2 * kPi * (i % around) / around, share = (j - 1.0) / along;
    const Vec3 p = at(angle, share);
    return Weighted({p.x, p.y, p.z + height * share}, weights[(i % around) * (along + 3) + j]);
  });
}

}  // namespace facetless
