// A plot of points on two logarithmic axes, as SVG and PNG from one drawing (cairo).
//
//  1. Points with an x above x_floor are drawn on the logarithmic axis. Points with a smaller x, including
//     zero, are drawn in a separate, labelled band on the left, beyond a break in the axis.
//  2. Series differ in colour and in marker shape, and points on the front are filled while others are
//     hollow, so the plot is legible in greyscale. The background is white.
//  3. Labels avoid each other, the markers and the border as far as there is room. A label that is far from
//     its point has a line to it.
//  4. The same plot gives the same bytes on one machine; fonts and cairo depend on the system.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/base/result.h"

namespace facetless {

enum class PlotUnit : std::uint8_t { kMillimetres, kMilliseconds, kBytes };

struct PlotPoint {
  double x = 0, y = 1;
  std::size_t series = 0;
  std::string label;
  bool filled = true;
};

struct PlotSeries {
  std::string name;
};

struct LogPlot {
  std::string title, subtitle;
  std::string x_title, y_title, front_title;
  PlotUnit y_unit = PlotUnit::kMilliseconds;  // x is millimetres
  double x_floor = 0;
  double pixels_per_mm = 0;       // if above 0, a second scale on top, in pixels
  std::optional<double> x_limit;  // a vertical line at the user's limit
  std::string x_limit_label;
  std::vector<PlotSeries> series;                // any number of series; colours and shapes repeat eventually
  std::vector<PlotPoint> points;                 // y > 0
  std::vector<std::size_t> front;                // points, in the order of its line
  std::vector<std::vector<std::size_t>> chains;  // points to join by a faint line
  std::vector<std::string> notes;                // lines below
};

// The plot as a file. Errors: kBadUsage (a number is not finite, a y is not above 0, or a series does not
// exist); kInternal (cairo failed).
Result<std::string> PlotSvg(const LogPlot& plot);
Result<std::string> PlotPng(const LogPlot& plot);

}  // namespace facetless
