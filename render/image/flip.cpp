// FLIP for pictures of low dynamic range: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild:
// "FLIP: A Difference Evaluator for Alternating Images", HPG 2020. Section and table numbers are that
// paper's.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/base/parallel.h"
#include "render/image/compare_input.h"
#include "render/image/metrics.h"
#include "render/image/plane.h"

namespace facetless {
namespace {

using Triple = std::array<double, 3>;

// Linear sRGB to XYZ, from the chromaticities of IEC 61966-2-1 and D65 at (0.3127, 0.3290).
constexpr double kToXyz[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                 {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                 {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

Triple Apply(const double (&m)[3][3], const Triple& v) {
  Triple out;
  for (int r = 0; r < 3; ++r) out[r] = m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2];
  return out;
}

struct Matrix {
  double m[3][3];
};
Matrix Inverse(const double (&m)[3][3]) {
  Matrix inverse;
  double determinant = 0;
  for (int c = 0; c < 3; ++c)
    determinant += m[0][c] * (m[1][(c + 1) % 3] * m[2][(c + 2) % 3] - m[1][(c + 2) % 3] * m[2][(c + 1) % 3]);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      inverse.m[c][r] = (m[(r + 1) % 3][(c + 1) % 3] * m[(r + 2) % 3][(c + 2) % 3] -
                         m[(r + 1) % 3][(c + 2) % 3] * m[(r + 2) % 3][(c + 1) % 3]) /
                        determinant;
  return inverse;
}
const Matrix kFromXyz = Inverse(kToXyz);
const Triple kWhite = Apply(kToXyz, {1, 1, 1});

// Convert linear RGB to the opponent space YyCxCz (section 4.1.1), and back.
Triple ToOpponent(const Triple& rgb) {
  const Triple xyz = Apply(kToXyz, rgb);
  const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}
Triple FromOpponent(const Triple& opponent) {
  const double y = (opponent[0] + 16) / 116;
  const double x = y + opponent[1] / 500, z = y - opponent[2] / 200;
  return Apply(kFromXyz.m, {x * kWhite[0], y * kWhite[1], z * kWhite[2]});
}

// Converts linear RGB to CIELAB with chroma scaled by lightness, for the Hunt effect (section 4.1.2).
Triple ToHuntLab(const Triple& rgb) {
  const Triple xyz = Apply(kToXyz, rgb);
  constexpr double kDelta = 6.0 / 29;
  Triple f;
  for (int c = 0; c < 3; ++c) {
    const double t = xyz[c] / kWhite[c];
    f[c] = t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  }
  const double lightness = 116 * f[1] - 16;
  return {lightness, 0.01 * lightness * 500 * (f[0] - f[1]), 0.01 * lightness * 200 * (f[1] - f[2])};
}

double HyAb(const Triple& a, const Triple& b) {
  return std::fabs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

// The colour error, 0 … 1, with large errors compressed (section 4.1.3).
class ColorError {
 public:
  double operator()(const Triple& a, const Triple& b) const {
    const double error = std::pow(HyAb(a, b), kExponent);
    const double knee = kKnee * largest_;
    const double share = error < knee ? error * kKneeValue / knee
                                      : kKneeValue + (error - knee) / (largest_ - knee) * (1 - kKneeValue);
    return std::clamp(share, 0.0, 1.0);
  }

 private:
  static constexpr double kExponent = 0.7, kKnee = 0.4, kKneeValue = 0.95;
  const double largest_ = std::pow(HyAb(ToHuntLab({0, 1, 0}), ToHuntLab({0, 0, 1})), kExponent);
};

// A sum of two Gaussians, the contrast sensitivity of one opponent channel (table 1).
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity kSensitivity[3] = {
    {1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};

// All kernels have the radius of the widest.
int SensitivityRadius(double pixels_per_degree) {
  constexpr double kWidest = 0.04;
  return static_cast<int>(std::ceil(3 * std::sqrt(kWidest / 2) / std::numbers::pi * pixels_per_degree));
}

Plane FilterSensitivity(const Plane& plane, const Sensitivity& s, double pixels_per_degree,
                        const FilterRegion& region) {
  constexpr double kPi = std::numbers::pi;
  const int radius = SensitivityRadius(pixels_per_degree);
  // Each Gaussian is separable. Weight the two by their share of the sum of the kernel.
  double total = 0, weight[2] = {0, 0};
  Taps taps[2];
  for (int k = 0; k < 2; ++k) {
    const double a = k == 0 ? s.a1 : s.a2, b = k == 0 ? s.b1 : s.b2;
    if (a == 0) continue;
    const auto gauss = [&](int i) {
      const double degrees = i / pixels_per_degree;
      return std::exp(-kPi * kPi * degrees * degrees / b);
    };
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) sum += gauss(i);
    for (int i = -radius; i <= radius; ++i) taps[k].push_back(static_cast<float>(gauss(i) / sum));
    weight[k] = a * std::sqrt(kPi / b) * sum * sum;
    total += weight[k];
  }
  Plane out = Filter(plane, taps[0], taps[0], region);
  if (taps[1].empty()) return out;
  const Plane second = Filter(plane, taps[1], taps[1], region);
  const float share[2] = {static_cast<float>(weight[0] / total), static_cast<float>(weight[1] / total)};
  region.ForRuns([&](int y, int begin, int end) {
    float* row = out.row(y);
    const float* other = second.row(y);
    for (int x = begin; x < end; ++x) row[x] = share[0] * row[x] + share[1] * other[x];
  });
  return out;
}

// The Gaussian derivatives of section 4.2.1. The positive and the negative taps of a kernel each sum to 1.
struct FeatureTaps {
  Taps smooth, edge, point;

  explicit FeatureTaps(double pixels_per_degree) {
    const double sigma = Sigma(pixels_per_degree);
    const int radius = Radius(pixels_per_degree);
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
      const double g = std::exp(-(i * i) / (2 * sigma * sigma));
      smooth.push_back(static_cast<float>(g));
      edge.push_back(static_cast<float>(-i * g));
      point.push_back(static_cast<float>((i * i / (sigma * sigma) - 1) * g));
      sum += g;
    }
    for (float& tap : smooth) tap = static_cast<float>(tap / sum);
    Balance(edge);
    Balance(point);
  }
  static int Radius(double pixels_per_degree) {
    return static_cast<int>(std::ceil(3 * Sigma(pixels_per_degree)));
  }

 private:
  static double Sigma(double pixels_per_degree) {
    constexpr double kFeatureWidthDeg = 0.082;
    return 0.5 * kFeatureWidthDeg * pixels_per_degree;
  }
  static void Balance(Taps& taps) {
    double positive = 0, negative = 0;
    for (float tap : taps) (tap > 0 ? positive : negative) += tap;
    for (float& tap : taps) tap = static_cast<float>(tap / (tap > 0 ? positive : -negative));
  }
};

// The largest distance, in pixels, at which any of the filters reads.
int FilterRadius(double pixels_per_degree) {
  return std::max(SensitivityRadius(pixels_per_degree), FeatureTaps::Radius(pixels_per_degree));
}

// The picture in opponent space, filtered by the contrast sensitivity of the eye (section 4.1.1), and its
// unfiltered luminance, 0 … 1.
struct Seen {
  std::array<Plane, 3> opponent;
  Plane luminance;

  Triple at(std::size_t i) const {
    return {opponent[0].values[i], opponent[1].values[i], opponent[2].values[i]};
  }
};
Seen See(const Image8& image, double pixels_per_degree, const FilterRegion& region) {
  Seen seen{LinearChannels(image), Plane(image.width, image.height)};
  std::array<Plane, 3>& planes = seen.opponent;
  // The filters reach beyond the region.
  const int radius = FilterRadius(pixels_per_degree);
  region.Grown(radius, radius).ForRuns([&](int y, int begin, int end) {
    const std::size_t row = static_cast<std::size_t>(y) * image.width;
    for (std::size_t i = row + begin; i < row + end; ++i) {
      const Triple opponent = ToOpponent(seen.at(i));
      seen.luminance.values[i] = static_cast<float>((opponent[0] + 16) / 116);
      for (int c = 0; c < 3; ++c) planes[c].values[i] = static_cast<float>(opponent[c]);
    }
  });
  for (int c = 0; c < 3; ++c)
    planes[c] = FilterSensitivity(planes[c], kSensitivity[c], pixels_per_degree, region);
  return seen;
}

Triple OpponentToHuntLab(const Triple& opponent) {
  Triple rgb = FromOpponent(opponent);
  for (double& channel : rgb) channel = std::clamp(channel, 0.0, 1.0);
  return ToHuntLab(rgb);
}

struct Features {
  Plane edge, point;  // lengths of the gradients
};
Features FindFeatures(const Plane& luminance, const FeatureTaps& taps, const FilterRegion& region) {
  const Plane smooth =
      FilterRows(luminance, taps.smooth, region.Grown(0, static_cast<int>(taps.smooth.size() / 2)));
  const auto length = [&](const Taps& derivative) {
    Plane x = Filter(luminance, derivative, taps.smooth, region);
    const Plane y = FilterColumns(smooth, derivative, region);
    region.ForRuns([&](int row, int begin, int end) {
      float* out = x.row(row);
      const float* other = y.row(row);
      for (int i = begin; i < end; ++i) out[i] = std::sqrt(out[i] * out[i] + other[i] * other[i]);
    });
    return x;
  };
  return {length(taps.edge), length(taps.point)};
}

}  // namespace

Result<std::vector<float>> FlipMap(const Image8& reference, const Image8& test, double pixels_per_degree) {
  if (Result<void> same = CheckSameSize(reference, test); !same.ok()) return same.error();
  if (!(pixels_per_degree >= 1 && pixels_per_degree <= 1000))
    return Error{ErrorCode::kBadUsage, "pixels per degree must lie between 1 and 1000"};

  std::vector<float> map(static_cast<std::size_t>(reference.width) * reference.height);
  // Beyond the reach of the filters from any difference, the error is 0.
  const int radius = FilterRadius(pixels_per_degree);
  const FilterRegion region = FilterRegion(reference, test).Grown(radius, radius);
  if (region.empty()) return map;
  // Run the colour pipeline.
  const Seen a = See(reference, pixels_per_degree, region), b = See(test, pixels_per_degree, region);
  // Run the feature pipeline.
  const FeatureTaps taps(pixels_per_degree);
  const Features fa = FindFeatures(a.luminance, taps, region), fb = FindFeatures(b.luminance, taps, region);

  // Combine both: features amplify the colour error (equation 11).
  const ColorError color_error;
  region.ForRuns([&](int y, int begin, int end) {
    const std::size_t row = static_cast<std::size_t>(y) * reference.width;
    for (std::size_t i = row + begin; i < row + end; ++i) {
      const Triple color_a = a.at(i), color_b = b.at(i);
      const double color =
          color_a == color_b ? 0 : color_error(OpponentToHuntLab(color_a), OpponentToHuntLab(color_b));
      const double feature = std::max(std::fabs(fa.edge.values[i] - fb.edge.values[i]),
                                      std::fabs(fa.point.values[i] - fb.point.values[i]));
      const double amplified = std::sqrt(std::clamp(feature / std::numbers::sqrt2, 0.0, 1.0));
      map[i] = static_cast<float>(std::pow(color, 1 - amplified));
    }
  });
  return map;
}

}  // namespace facetless
