#include "import/step_placements.h"

#include <cmath>

namespace facetless {

LinearMap StandIn(std::size_t index) {
  // The axis has a direction that occurs in no real file. The angles lie between 0.5 and 2.5 radians.
  constexpr double kAxis[3] = {0.36, 0.48, 0.8};
  const double angle = 0.5 + 2.0 * static_cast<double>(index) / static_cast<double>(kMostLinearMaps);
  const double c = std::cos(angle), s = std::sin(angle);
  const auto [x, y, z] = kAxis;
  return {c + x * x * (1 - c),     x * y * (1 - c) - z * s, x * z * (1 - c) + y * s,
          y * x * (1 - c) + z * s, c + y * y * (1 - c),     y * z * (1 - c) - x * s,
          z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)};
}

LinearMap Product(const LinearMap& a, const LinearMap& b) {
  LinearMap out{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c)
      out[3 * r + c] = a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c];
  }
  return out;
}

LinearMap Transposed(const LinearMap& a) {
  return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
}

std::array<double, 3> Apply(const LinearMap& a, const std::array<double, 3>& v) {
  return {a[0] * v[0] + a[1] * v[1] + a[2] * v[2], a[3] * v[0] + a[4] * v[1] + a[5] * v[2],
          a[6] * v[0] + a[7] * v[1] + a[8] * v[2]};
}

bool IsRotation(const LinearMap& a) {
  // Directions in files have at least ten digits.
  constexpr double kRounding = 1e-9;
  const double determinant = a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) +
                             a[2] * (a[3] * a[7] - a[4] * a[6]);
  return std::fabs(determinant - 1) <= kRounding;
}

}  // namespace facetless
