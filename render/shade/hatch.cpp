#include "render/shade/hatch.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace facetless {
namespace {

// Unit vectors perpendicular to the lines.
constexpr double kAcross[][2] = {
    {0.7071067811865476, 0.7071067811865476},   // 45°
    {0.7071067811865476, -0.7071067811865476},  // 135°
    {0.5, 0.8660254037844386},                  // 30°
    {0.8660254037844386, -0.5},                 // 120°
    {0.8660254037844386, 0.5},                  // 60°
    {0.5, -0.8660254037844386},                 // 150°
};

}  // namespace

float HatchCover(double x, double y, std::uint32_t solid) {
  const auto& across = kAcross[solid % std::size(kAcross)];
  const double place = (across[0] * x + across[1] * y) / kHatchSpacing;
  const double distance = std::fabs(place - std::floor(place) - 0.5) * kHatchSpacing;
  return static_cast<float>(std::clamp(0.5 * kHatchWidth + 0.5 - distance, 0.0, 1.0));
}

}  // namespace facetless
