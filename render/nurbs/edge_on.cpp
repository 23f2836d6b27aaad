#include "render/nurbs/edge_on.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// Rounding of the coordinates by the division by the weight, the difference from a point and the product with
// the normal.
constexpr double kRounding = 8 * 0x1p-53;

}  // namespace

double LineImage::DistanceToLine(double px, double py) const {
  return std::fabs(normal_x * (px - x) + normal_y * (py - y));
}

LineImage FitLine(const BezierNet& net) {
  LineImage line;
  for (int i = 0; i < net.points(); ++i)
    if (!(net.at(i, kW) > net.error[kW])) return {.is_line = true, .half_width = INFINITY};
  const auto image_x = [&](int i) { return net.at(i, kX) / net.at(i, kW); };
  const auto image_y = [&](int i) { return net.at(i, kY) / net.at(i, kW); };
  // Find the control point farthest from the first one, and the errors of the points.
  line.x = image_x(0);
  line.y = image_y(0);
  double along_x = 0, along_y = 0, length = 0, error = 0, ends = 0;
  const auto error_of = [&](int i, double size) {
    return (net.error[kX] + net.error[kY] + size * net.error[kW]) / net.at(i, kW) +
           kRounding * (size + std::fabs(line.x) + std::fabs(line.y));
  };
  for (int i = 0; i < net.points(); ++i) {
    const double x = image_x(i), y = image_y(i), size = std::fabs(x) + std::fabs(y);
    const double far = std::sqrt((x - line.x) * (x - line.x) + (y - line.y) * (y - line.y));
    const double own = error_of(i, size);
    if (i == 0 || far > length)
      ends = std::max(i == 0 ? 0 : error_of(0, std::fabs(line.x) + std::fabs(line.y)), own);
    if (far > length) along_x = x - line.x, along_y = y - line.y, length = far;
    error = std::max(error, own);
  }
  if (!(length > 0)) return line;
  line.normal_x = -along_y / length;
  line.normal_y = along_x / length;
  // The control points enclose the patch between two parallel lines. Both ends of the line have errors, and
  // so has each point. Each point is judged by its own error, because the image of a point with a tiny weight
  // may be arbitrarily wrong without affecting the surface.
  double farthest = 0;
  line.is_line = true;
  for (int i = 0; i < net.points(); ++i) {
    const double x = image_x(i), y = image_y(i), distance = line.DistanceToLine(x, y);
    farthest = std::max(farthest, distance);
    line.is_line = line.is_line && distance <= 4 * std::max(ends, error_of(i, std::fabs(x) + std::fabs(y)));
  }
  line.half_width = farthest + 4 * error;
  return line;
}

}  // namespace facetless
