#include "render/trade/plot.h"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "render/trade/plot_labels.h"
#include "render/trade/quantity_text.h"

namespace facetless {
namespace {

// The size of the drawing in points. A PNG has kPngScale pixels per point, so that it prints sharply.
constexpr double kWidth = 960, kHeight = 600, kPngScale = 2;
constexpr double kLeft = 92, kRight = 28, kTop = 128, kBottom = 74, kNoteHeight = 17, kLegendHeight = 18;
constexpr double kBandWidth = 118, kBandGap = 14;

struct Rgb {
  double r, g, b;
};
constexpr Rgb kInk = {0.12, 0.14, 0.16}, kSoft = {0.40, 0.43, 0.46}, kGrid = {0.88, 0.88, 0.87},
              kFinerGrid = {0.945, 0.945, 0.94}, kBand = {0.955, 0.95, 0.935}, kLimit = {0.55, 0.12, 0.35};
// Colours that differ in lightness, so that people with any common form of colour blindness can tell them
// apart. There are five colours and four shapes, so that the pairs repeat after twenty series.
constexpr Rgb kSeries[] = {
    {0.07, 0.40, 0.56}, {0.80, 0.36, 0.05}, {0.00, 0.52, 0.38}, {0.62, 0.22, 0.52}, {0.36, 0.30, 0.10}};
constexpr std::size_t kShapes = 4;

const Rgb& SeriesColor(std::size_t series) {
  return kSeries[series % std::size(kSeries)];
}

// Returns the height that the legend needs beyond the two lines that always have room. Letters are assumed to
// be wide, so that the drawing never needs more lines than this.
double MoreLegend(const LogPlot& plot) {
  constexpr double kLetter = 8, kEntry = 40, kRoom = kWidth - kLeft - kRight;
  double x = 0;
  int lines = 1;
  const auto add = [&](const std::string& text) {
    const double width = kLetter * static_cast<double>(text.size()) + kEntry;
    if (x > 0 && x + width > kRoom) {
      ++lines;
      x = 0;
    }
    x += width;
  };
  for (const PlotSeries& series : plot.series) add(series.name);
  add(plot.front_title);
  return std::max(0, lines - 2) * kLegendHeight;
}

// A logarithmic axis from `low` to `high`, drawn from `begin` to `end`.
struct Axis {
  double low = 1, high = 10, begin = 0, end = 1;
  double At(double value) const {
    return begin +
           (std::log10(value) - std::log10(low)) / (std::log10(high) - std::log10(low)) * (end - begin);
  }
};

// Returns the range of `values`, widened by a fraction of a decade so that markers stay clear of the border.
void Fit(Axis& axis, const std::vector<double>& values, double least_decades) {
  constexpr double kMargin = 0.18;
  double low = INFINITY, high = 0;
  for (const double value : values) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (values.empty()) low = high = 1;
  double low_log = std::log10(low) - kMargin, high_log = std::log10(high) + kMargin;
  const double missing = std::max(0.0, least_decades - (high_log - low_log));
  axis.low = std::pow(10, low_log - missing / 2);
  axis.high = std::pow(10, high_log + missing / 2);
}

struct Tick {
  double value;
  bool major;
};

// Returns the ticks: powers of ten; between them 2 and 5 as major ticks where there are few, or all multiples
// as minor ticks.
std::vector<Tick> Ticks(const Axis& axis) {
  const double decades = std::log10(axis.high / axis.low);
  const bool fine = decades < 2.2;
  std::vector<Tick> ticks;
  const int step = decades > 9 ? 2 : 1;
  for (int power = static_cast<int>(std::floor(std::log10(axis.low))); std::pow(10, power) <= axis.high;
       ++power)
    for (int digit = 1; digit < 10; ++digit) {
      const double value = digit * std::pow(10, power);
      if (value < axis.low || value > axis.high) continue;
      const bool power_of_ten = digit == 1 && power % step == 0;
      if (digit > 1 && decades > 6) continue;
      ticks.push_back({value, power_of_ten || (fine && (digit == 2 || digit == 5))});
    }
  return ticks;
}

std::string TickText(double value, PlotUnit unit) {
  switch (unit) {
    case PlotUnit::kMillimetres:
      return NumberText(value);
    case PlotUnit::kMilliseconds:
      return TimeText(value);
    case PlotUnit::kBytes:
      break;
  }
  return MemoryText(value);
}

// Draws the plot on any Cairo surface.
class Drawing {
 public:
  Drawing(cairo_t* cairo, const LogPlot& plot) : cr_(cairo), plot_(plot) {
    cairo_select_font_face(cr_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    more_ = MoreLegend(plot);
    top_ = kTop + more_;
    bottom_ = kHeight - kBottom + more_;
    bool floored = false;
    std::vector<double> xs, ys;
    for (const PlotPoint& point : plot.points) {
      if (point.x > plot.x_floor) {
        xs.push_back(point.x);
      } else {
        floored = true;
      }
      ys.push_back(point.y);
    }
    if (plot.x_limit && *plot.x_limit > plot.x_floor) xs.push_back(*plot.x_limit);
    band_ = floored;
    Fit(x_, xs, 1);
    Fit(y_, ys, 1);
    x_.begin = kLeft + (band_ ? kBandWidth + kBandGap : 0);
    x_.end = kWidth - kRight;
    y_.begin = bottom_;
    y_.end = top_;
  }

  void Draw() {
    Paper();
    Grid();
    Frame();
    Limit();
    Chains();
    Front();
    Markers();
    Labels();
    Titles();
  }

 private:
  void Color(const Rgb& color) { cairo_set_source_rgb(cr_, color.r, color.g, color.b); }

  void Line(double x0, double y0, double x1, double y1, const Rgb& color, double width) {
    Color(color);
    cairo_set_line_width(cr_, width);
    cairo_move_to(cr_, x0, y0);
    cairo_line_to(cr_, x1, y1);
    cairo_stroke(cr_);
  }

  cairo_text_extents_t Extents(const std::string& text, double size) {
    cairo_set_font_size(cr_, size);
    cairo_text_extents_t extents;
    cairo_text_extents(cr_, text.c_str(), &extents);
    return extents;
  }

  // Writes a text. With `align` 0 it begins at x, with 0.5 it is centred at x, with 1 it ends at x; y is the
  // baseline.
  void Text(double x, double y, const std::string& text, double size, const Rgb& color, double align = 0,
            bool bold = false) {
    cairo_select_font_face(cr_, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    const double width = Extents(text, size).x_advance;
    Color(color);
    cairo_move_to(cr_, x - align * width, y);
    cairo_show_text(cr_, text.c_str());
    cairo_select_font_face(cr_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  }

  bool InBand(const PlotPoint& point) const { return !(point.x > plot_.x_floor); }
  double X(const PlotPoint& point) const { return InBand(point) ? kLeft + kBandWidth / 2 : x_.At(point.x); }
  double Y(const PlotPoint& point) const { return y_.At(point.y); }

  void Paper() {
    cairo_set_source_rgb(cr_, 1, 1, 1);
    cairo_paint(cr_);
    if (!band_) return;
    Color(kBand);
    cairo_rectangle(cr_, kLeft, top_, kBandWidth, bottom_ - top_);
    cairo_fill(cr_);
  }

  void Grid() {
    for (const Tick& tick : Ticks(x_)) {
      const double x = x_.At(tick.value);
      Line(x, top_, x, bottom_, tick.major ? kGrid : kFinerGrid, 1);
      if (tick.major) Text(x, bottom_ + 18, TickText(tick.value, PlotUnit::kMillimetres), 12.5, kInk, 0.5);
    }
    for (const Tick& tick : Ticks(y_)) {
      const double y = y_.At(tick.value);
      if (band_) Line(kLeft, y, kLeft + kBandWidth, y, tick.major ? kGrid : kFinerGrid, 1);
      Line(x_.begin, y, x_.end, y, tick.major ? kGrid : kFinerGrid, 1);
      if (tick.major) Text(kLeft - 9, y + 4.5, TickText(tick.value, plot_.y_unit), 12.5, kInk, 1);
    }
    if (!(plot_.pixels_per_mm > 0)) return;
    Axis pixels = x_;
    pixels.low *= plot_.pixels_per_mm;
    pixels.high *= plot_.pixels_per_mm;
    for (const Tick& tick : Ticks(pixels)) {
      if (!tick.major) continue;
      const double x = pixels.At(tick.value);
      Line(x, top_ - 5, x, top_, kSoft, 1);
      Text(x, top_ - 9, NumberText(tick.value) + " px", 11.5, kSoft, 0.5);
    }
  }

  void Frame() {
    Line(x_.begin, bottom_, x_.end, bottom_, kInk, 1.2);
    Line(kLeft, top_, kLeft, bottom_, kInk, 1.2);
    if (!band_) return;
    Line(kLeft, bottom_, kLeft + kBandWidth, bottom_, kInk, 1.2);
    // Draw the break of the axis: two strokes across the gap.
    for (const double x : {kLeft + kBandWidth, x_.begin})
      Line(x - 4, bottom_ + 6, x + 4, bottom_ - 6, kInk, 1.2);
    const double middle = kLeft + kBandWidth / 2;
    Text(middle, bottom_ + 18, "0", 12.5, kInk, 0.5);
    Text(middle, bottom_ + 33, "or below " + NumberText(plot_.x_floor), 10.5, kSoft, 0.5);
  }

  void Limit() {
    if (!plot_.x_limit || !(*plot_.x_limit > plot_.x_floor)) return;
    const double x = x_.At(*plot_.x_limit);
    const double dashes[] = {5, 4};
    cairo_set_dash(cr_, dashes, 2, 0);
    Line(x, top_, x, bottom_, kLimit, 1.2);
    cairo_set_dash(cr_, nullptr, 0, 0);
    const double width = Extents(plot_.x_limit_label, 11.5).x_advance;
    const bool right = x + 7 + width < x_.end;
    limit_box_ = {right ? x + 5 : x - 5 - width, top_ + 3, width + 4, 16};
    Text(right ? x + 6 : x - 6, top_ + 15, plot_.x_limit_label, 11.5, kLimit, right ? 0 : 1);
  }

  void Chains() {
    for (const auto& chain : plot_.chains)
      for (std::size_t i = 1; i < chain.size(); ++i) {
        const PlotPoint &a = plot_.points[chain[i - 1]], &b = plot_.points[chain[i]];
        Rgb color = SeriesColor(b.series);
        for (double* channel : {&color.r, &color.g, &color.b}) *channel = 1 - 0.35 * (1 - *channel);
        Line(X(a), Y(a), X(b), Y(b), color, 1.5);
      }
  }

  // Draws the front as steps: from the error of one point to that of the next, the cost of the first is the
  // smallest.
  void Front() {
    if (plot_.front.empty()) return;
    Color(kInk);
    cairo_set_line_width(cr_, 1.6);
    for (std::size_t i = 0; i < plot_.front.size(); ++i) {
      const double x = X(plot_.points[plot_.front[i]]), y = Y(plot_.points[plot_.front[i]]);
      if (i == 0) {
        cairo_move_to(cr_, x_.end, y);
      } else {
        cairo_line_to(cr_, X(plot_.points[plot_.front[i - 1]]), y);
      }
      cairo_line_to(cr_, x, y);
    }
    cairo_stroke(cr_);
  }

  void Polygon(std::initializer_list<std::pair<double, double>> corners) {
    for (const auto& [x, y] : corners) cairo_line_to(cr_, x, y);
    cairo_close_path(cr_);
  }

  void Marker(double x, double y, std::size_t series, bool filled) {
    constexpr double kRadius = 5.5;
    cairo_new_path(cr_);
    switch (series % kShapes) {
      case 0:
        cairo_arc(cr_, x, y, kRadius, 0, 2 * M_PI);
        break;
      case 1:
        cairo_rectangle(cr_, x - kRadius + 0.5, y - kRadius + 0.5, 2 * kRadius - 1, 2 * kRadius - 1);
        break;
      case 2:
        Polygon({{x, y - 1.2 * kRadius},
                 {x + 1.15 * kRadius, y + 0.8 * kRadius},
                 {x - 1.15 * kRadius, y + 0.8 * kRadius}});
        break;
      default:
        Polygon({{x, y - 1.25 * kRadius},
                 {x + 1.25 * kRadius, y},
                 {x, y + 1.25 * kRadius},
                 {x - 1.25 * kRadius, y}});
    }
    if (filled) {
      Color(SeriesColor(series));
    } else {
      cairo_set_source_rgb(cr_, 1, 1, 1);
    }
    cairo_fill_preserve(cr_);
    Color(SeriesColor(series));
    cairo_set_line_width(cr_, 1.8);
    cairo_stroke(cr_);
  }

  void Markers() {
    // Draw the points of the front last, on top.
    for (const bool filled : {false, true})
      for (const PlotPoint& point : plot_.points)
        if (point.filled == filled) Marker(X(point), Y(point), point.series, filled);
  }

  // Points of one series that coincide share a label with their names one below the other.
  std::vector<std::vector<std::size_t>> Clusters() const {
    constexpr double kNear = 8;
    std::vector<std::vector<std::size_t>> clusters;
    for (std::size_t i = 0; i < plot_.points.size(); ++i) {
      const PlotPoint& point = plot_.points[i];
      const auto found = std::find_if(clusters.begin(), clusters.end(), [&](const auto& cluster) {
        const PlotPoint& first = plot_.points[cluster.front()];
        return first.series == point.series && std::hypot(X(first) - X(point), Y(first) - Y(point)) < kNear;
      });
      if (found == clusters.end()) {
        clusters.push_back({i});
      } else {
        found->push_back(i);
      }
    }
    return clusters;
  }

  void Labels() {
    constexpr double kSize = 12.5, kLine = 15;
    const std::vector<std::vector<std::size_t>> clusters = Clusters();
    std::vector<LabelRequest> requests;
    std::vector<PlotBox> obstacles = {limit_box_};
    for (const auto& cluster : clusters) {
      const PlotPoint& first = plot_.points[cluster.front()];
      double width = 0;
      for (const std::size_t i : cluster) width = std::max(width, LabelWidth(plot_.points[i], kSize));
      requests.push_back({X(first), Y(first), width + 4, kLine * static_cast<double>(cluster.size()) + 1});
    }
    for (const PlotPoint& point : plot_.points) obstacles.push_back({X(point) - 7, Y(point) - 7, 14, 14});
    AddLineObstacles(obstacles);
    const std::vector<LabelPlace> places =
        PlaceLabels(requests, obstacles, {kLeft + 2, top_ + 2, x_.end - kLeft - 4, bottom_ - top_ - 4});
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!places[k].leader) continue;
      const PlotBox& box = places[k].box;
      Line(requests[k].x, requests[k].y, std::clamp(requests[k].x, box.x, box.x + box.width),
           std::clamp(requests[k].y, box.y + 2, box.y + box.height - 2),
           SeriesColor(plot_.points[clusters[k].front()].series), 0.8);
    }
    for (std::size_t k = 0; k < places.size(); ++k) {
      const PlotBox& box = places[k].box;
      // Draw a pale ground, so that lines do not cross the letters.
      cairo_set_source_rgba(cr_, 1, 1, 1, 0.8);
      cairo_rectangle(cr_, box.x, box.y, box.width, box.height);
      cairo_fill(cr_);
      // Beside the point, the text begins or ends at the side that faces it.
      const bool left = box.x + box.width < requests[k].x;
      double y = box.y + kSize - 1;
      for (const std::size_t i : clusters[k]) {
        const PlotPoint& point = plot_.points[i];
        Text(left ? box.x + box.width - 2 : box.x + 2, y, point.label, kSize, SeriesColor(point.series),
             left ? 1 : 0, point.filled);
        y += kLine;
      }
    }
    // Draw the markers again, because leaders may have crossed them.
    Markers();
  }

  double LabelWidth(const PlotPoint& point, double size) {
    cairo_select_font_face(cr_, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           point.filled ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    return Extents(point.label, size).x_advance;
  }

  // Returns boxes along the steps of the front, which labels avoid.
  void AddLineObstacles(std::vector<PlotBox>& obstacles) const {
    for (std::size_t i = 0; i + 1 < plot_.front.size(); ++i) {
      const PlotPoint &a = plot_.points[plot_.front[i]], &b = plot_.points[plot_.front[i + 1]];
      obstacles.push_back({X(a) - 1, std::min(Y(a), Y(b)), 2, std::fabs(Y(a) - Y(b))});
      obstacles.push_back({std::min(X(a), X(b)), Y(b) - 1, std::fabs(X(a) - X(b)), 2});
    }
  }

  void Titles() {
    Text(kLeft, 30, plot_.title, 18, kInk, 0, true);
    Text(kLeft, 50, plot_.subtitle, 12.5, kSoft);
    // Draw the legend, in one line if there is room.
    double x = kLeft + 6, y_legend = 74;
    const auto wrap = [&](double width) {
      if (x + width <= x_.end || x == kLeft + 6) return;
      x = kLeft + 6;
      y_legend += kLegendHeight;
    };
    for (std::size_t i = 0; i < plot_.series.size(); ++i) {
      const double width = 12 + Extents(plot_.series[i].name, 13).x_advance * 1.1 + 26;
      wrap(width);
      Marker(x, y_legend, i, true);
      Text(x + 12, y_legend + 4.5, plot_.series[i].name, 13, SeriesColor(i), 0, true);
      x += width;
    }
    wrap(29 + Extents(plot_.front_title, 12.5).x_advance);
    Line(x, y_legend, x + 22, y_legend, kInk, 1.6);
    Text(x + 29, y_legend + 4.5, plot_.front_title, 12.5, kSoft);
    Text(x_.end, bottom_ + 40, plot_.x_title, 13, kInk, 1);
    cairo_save(cr_);
    cairo_translate(cr_, 20, (top_ + bottom_) / 2);
    cairo_rotate(cr_, -M_PI / 2);
    Text(0, 0, plot_.y_title, 13, kInk, 0.5);
    cairo_restore(cr_);
    double y = kHeight + more_ - 12;
    for (const std::string& note : plot_.notes) {
      Text(kLeft, y, note, 11.5, kSoft);
      y += kNoteHeight;
    }
  }

  cairo_t* cr_;
  const LogPlot& plot_;
  Axis x_, y_;
  double top_ = 0, bottom_ = 0;
  double more_ = 0;  // MoreLegend
  bool band_ = false;
  PlotBox limit_box_;
};

double PaperHeight(const LogPlot& plot) {
  return kHeight + MoreLegend(plot) +
         (plot.notes.empty() ? 0 : static_cast<double>(plot.notes.size() - 1) * kNoteHeight);
}

Result<void> Check(const LogPlot& plot) {
  for (const PlotPoint& point : plot.points)
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !(point.y > 0) ||
        point.series >= plot.series.size())
      return Error{ErrorCode::kBadUsage,
                   "the point '" + point.label + "' cannot be drawn on a logarithmic plot"};
  return {};
}

cairo_status_t Append(void* closure, const unsigned char* bytes, unsigned int length) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(bytes), length);
  return CAIRO_STATUS_SUCCESS;
}

using Surface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;
using Context = std::unique_ptr<cairo_t, void (*)(cairo_t*)>;

Result<void> DrawOn(cairo_surface_t* surface, const LogPlot& plot, double scale) {
  const Context context(cairo_create(surface), cairo_destroy);
  cairo_scale(context.get(), scale, scale);
  Drawing(context.get(), plot).Draw();
  if (const cairo_status_t status = cairo_status(context.get()); status != CAIRO_STATUS_SUCCESS)
    return Error{ErrorCode::kInternal,
                 std::string("the plot cannot be drawn: ") + cairo_status_to_string(status)};
  return {};
}

Error CannotWrite(cairo_status_t status) {
  return {ErrorCode::kInternal, std::string("the plot cannot be written: ") + cairo_status_to_string(status)};
}

}  // namespace

Result<std::string> PlotSvg(const LogPlot& plot) {
  if (Result<void> sound = Check(plot); !sound.ok()) return sound.error();
  std::string bytes;
  const Surface surface(cairo_svg_surface_create_for_stream(&Append, &bytes, kWidth, PaperHeight(plot)),
                        cairo_surface_destroy);
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  if (Result<void> drawn = DrawOn(surface.get(), plot, 1); !drawn.ok()) return drawn.error();
  cairo_surface_finish(surface.get());
  if (const cairo_status_t status = cairo_surface_status(surface.get()); status != CAIRO_STATUS_SUCCESS)
    return CannotWrite(status);
  // Cairo numbers its surfaces over the lifetime of the process.
  const std::string id = "id=\"surface";
  if (const std::size_t at = bytes.find(id); at != std::string::npos)
    bytes.erase(at + id.size(), bytes.find('"', at + id.size()) - at - id.size());
  return bytes;
}

Result<std::string> PlotPng(const LogPlot& plot) {
  if (Result<void> sound = Check(plot); !sound.ok()) return sound.error();
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(kPngScale * kWidth),
                                                   static_cast<int>(kPngScale * PaperHeight(plot))),
                        cairo_surface_destroy);
  if (Result<void> drawn = DrawOn(surface.get(), plot, kPngScale); !drawn.ok()) return drawn.error();
  std::string bytes;
  if (const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), &Append, &bytes);
      status != CAIRO_STATUS_SUCCESS)
    return CannotWrite(status);
  return bytes;
}

}  // namespace facetless
