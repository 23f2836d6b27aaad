// A plot of points on two logarithmic axes, as SVG and PNG from one drawing (cairo).
//
//  1. Positive numbers lie where they belong. An x of at most x_floor, zero included, has no place on a
//     logarithmic axis: it is drawn in a band of its own on the left, which says so, behind a break in the
//     axis.
//  2. Series differ in colour and in shape, points on the front are filled and others hollow: it reads in
//     grey, too. The paper is white on any page.
//  3. Labels avoid each other, the markers and the border as far as there is room; one that had to go farther
//     has a line to its point.
//  4. The same plot gives the same bytes, on one machine: fonts and cairo are the system's.
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
  double pixels_per_mm = 0;       // above 0: a second scale, on top, in pixels
  std::optional<double> x_limit;  // a line that the reader asked about
  std::string x_limit_label;
  std::vector<PlotSeries> series;                // any number; colours and shapes repeat after a while
  std::vector<PlotPoint> points;                 // y > 0
  std::vector<std::size_t> front;                // points, in the order of its line
  std::vector<std::vector<std::size_t>> chains;  // points to join by a faint line
  std::vector<std::string> notes;                // lines below
};

// A whole file. Errors: kBadUsage (a number that is not finite, no y above 0, or no such series); kInternal (cairo's reason).
Result<std::string> PlotSvg(const LogPlot& plot);
Result<std::string> PlotPng(const LogPlot& plot);

}  // namespace facetless
