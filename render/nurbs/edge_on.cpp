#include "render/nurbs/edge_on.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// Dividing by the weight, the difference to a point and the product with the normal: rounding of the coordinates.
constexpr double kRounding = 8 * 0x1p-53;

}  // namespace

double LineImage::DistanceOf(double px, double py) const {
  return std::fabs(normal_x * (px - x) + normal_y * (py - y));
}

LineImage FitLine(const BezierNet& net) {
  LineImage line;
  const auto image_x = [&](int i) { return net.value[kX][i] / net.value[kW][i]; };
  const auto image_y = [&](int i) { return net.value[kY][i] / net.value[kW][i]; };
  // Take the farthest control point from the first, and what the points are off by.
  line.x = image_x(0);
  line.y = image_y(0);
  double along_x = 0, along_y = 0, length = 0, error = 0;
  for (int i = 0; i < net.points(); ++i) {
    const double x = image_x(i), y = image_y(i), size = std::fabs(x) + std::fabs(y);
    const double far = std::sqrt((x - line.x) * (x - line.x) + (y - line.y) * (y - line.y));
    if (far > length) along_x = x - line.x, along_y = y - line.y, length = far;
    error = std::max(error, (net.error[kX] + net.error[kY] + size * net.error[kW]) / net.value[kW][i] +
                                kRounding * (size + std::fabs(line.x) + std::fabs(line.y)));
  }
  if (!(length > 0)) return line;
  line.normal_x = -along_y / length;
  line.normal_y = along_x / length;
  // The control points hold the patch between two parallels. Both ends of the line are off, and so is each point.
  double farthest = 0;
  for (int i = 0; i < net.points(); ++i)
    farthest = std::max(farthest, line.DistanceOf(image_x(i), image_y(i)));
  line.half_width = farthest + 4 * error;
  line.is_line = farthest <= 4 * error;
  return line;
}

}  // namespace facetless
