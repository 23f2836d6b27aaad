#include "render/lines/draw_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "render/base/parallel.h"

namespace facetless {
namespace {

constexpr int kKinds = static_cast<int>(kLineClassNames.size());
// The largest deviation of a simplified polyline in an SVG file, pixels. Together with the flatness of the
// lines, the deviation stays below 0.05 px.
constexpr double kSvgTolerance = 0.015;

// A straight piece of a line or of a dash.
struct Stroke {
  double x0, y0, x1, y1;
};

void AddStrokes(const ViewLine& line, const LineStyle& style, std::vector<Stroke>* strokes) {
  double place = 0;  // position within the dash pattern
  const double period = style.dash + style.gap;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    const LinePoint &a = line.points[i - 1], &b = line.points[i];
    const double dx = b.x - a.x, dy = b.y - a.y, length = std::sqrt(dx * dx + dy * dy);
    if (!(length > 0)) continue;
    if (!(style.dash > 0)) {
      strokes->push_back({a.x, a.y, b.x, b.y});
      continue;
    }
    for (double from = 0; from < length;) {
      const double in_period = place - period * std::floor(place / period);
      const bool on = in_period < style.dash;
      const double step = std::min(length - from, std::max((on ? style.dash : period) - in_period, 1e-6));
      if (on)
        strokes->push_back({a.x + dx * (from / length), a.y + dy * (from / length),
                            a.x + dx * ((from + step) / length), a.y + dy * ((from + step) / length)});
      from += step;
      place += step;
    }
  }
}

// Raises the coverage of the pixels of a row to that of the stroke.
void CoverRow(const Stroke& s, double half_width, int y, std::vector<float>* cover) {
  const double reach = half_width + 0.5, dx = s.x1 - s.x0, dy = s.y1 - s.y0, square = dx * dx + dy * dy;
  const double center = y + 0.5;
  // Find the part of the stroke near the row, as an interval of x.
  double low = std::min(s.x0, s.x1), high = std::max(s.x0, s.x1);
  if (std::fabs(dy) > 0) {
    const double at = s.x0 + dx * ((center - reach - s.y0) / dy),
                 other = s.x0 + dx * ((center + reach - s.y0) / dy);
    low = std::max(low, std::min(at, other));
    high = std::min(high, std::max(at, other));
    if (low > high) std::swap(low, high);
  }
  const int width = static_cast<int>(cover->size());
  const int first = static_cast<int>(std::clamp(std::floor(low - reach - 1), 0.0, double(width)));
  const int last = static_cast<int>(std::clamp(std::ceil(high + reach + 1), 0.0, double(width)));
  for (int x = first; x < last; ++x) {
    const double px = x + 0.5 - s.x0, py = center - s.y0;
    const double share = square > 0 ? std::clamp((px * dx + py * dy) / square, 0.0, 1.0) : 0;
    const double off_x = px - share * dx, off_y = py - share * dy;
    const double distance = std::sqrt(off_x * off_x + off_y * off_y);
    const double covered = std::clamp(half_width + 0.5 - distance, 0.0, std::min(1.0, 2 * half_width));
    (*cover)[x] = std::max((*cover)[x], static_cast<float>(covered));
  }
}

void DrawKind(std::span<const ViewLine> lines, LineClass kind, bool visible, Film* film) {
  const LineStyle style = LineStyleFor(kind, visible);
  std::vector<Stroke> strokes;
  for (const ViewLine& line : lines)
    if (line.kind == kind && line.visible == visible) AddStrokes(line, style, &strokes);
  if (strokes.empty()) return;
  // List the strokes by row.
  const double reach = 0.5 * style.width + 0.5;
  std::vector<std::vector<std::uint32_t>> of_row(film->height);
  for (std::uint32_t k = 0; k < strokes.size(); ++k) {
    const Stroke& s = strokes[k];
    const double top = std::floor(std::min(s.y0, s.y1) - reach - 0.5),
                 bottom = std::ceil(std::max(s.y0, s.y1) + reach + 0.5);
    const int first = static_cast<int>(std::clamp(top, 0.0, double(film->height))),
              last = static_cast<int>(std::clamp(bottom, 0.0, double(film->height)));
    for (int y = first; y < last; ++y) of_row[y].push_back(k);
  }
  ParallelFor(0, film->height, [&](int y) {
    if (of_row[y].empty()) return;
    std::vector<float> cover(film->width, 0.0f);
    for (const std::uint32_t k : of_row[y]) CoverRow(strokes[k], 0.5 * style.width, y, &cover);
    for (int x = 0; x < film->width; ++x) {
      if (!(cover[x] > 0)) continue;
      const float share = cover[x] * style.cover;
      auto& pixel = film->pixels[static_cast<std::size_t>(y) * film->width + x];
      for (int c = 0; c < 3; ++c) pixel[c] = pixel[c] * (1 - share) + style.ink[c] * share;
      pixel[3] = pixel[3] * (1 - share) + share;
    }
  });
}

// Marks the points to keep: a point close to the line between two kept points is dropped (Douglas and
// Peucker).
void Simplify(const std::vector<LinePoint>& points, std::size_t first, std::size_t last,
              std::vector<bool>* keep) {
  std::vector<std::pair<std::size_t, std::size_t>> open = {{first, last}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    const LinePoint &a = points[begin], &b = points[end];
    const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    double most = 0;
    std::size_t at = begin;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double px = points[i].x - a.x, py = points[i].y - a.y;
      const double share = square > 0 ? std::clamp((px * dx + py * dy) / square, 0.0, 1.0) : 0;
      const double off_x = px - share * dx, off_y = py - share * dy, off = off_x * off_x + off_y * off_y;
      if (off > most) most = off, at = i;
    }
    if (!(most > kSvgTolerance * kSvgTolerance)) continue;
    (*keep)[at] = true;
    open.emplace_back(begin, at);
    open.emplace_back(at, end);
  }
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  std::string number = text;
  while (number.back() == '0') number.pop_back();
  if (number.back() == '.') number.pop_back();
  return number == "-0" ? "0" : number;
}

std::string EscapedXml(const std::string& text) {
  std::string xml;
  for (const char c : text) {
    if (c == '<') {
      xml += "&lt;";
    } else if (c == '&') {
      xml += "&amp;";
    } else if (static_cast<unsigned char>(c) >= 0x20) {
      xml += c;
    }
  }
  return xml;
}

std::string Hex(const float (&ink)[3]) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", EncodeByte(ink[0]), EncodeByte(ink[1]),
                EncodeByte(ink[2]));
  return text;
}

}  // namespace

LineStyle LineStyleFor(LineClass kind, bool visible) {
  LineStyle style;
  switch (kind) {
    case LineClass::kSeam:
      style.width = 0.6;
      style.cover = 0.35f;
      break;
    case LineClass::kSmooth:
      style.width = 0.8;
      style.cover = 0.45f;
      break;
    case LineClass::kFeature:
      break;
    case LineClass::kBoundary:
    case LineClass::kSilhouette:
      style.width = 1.5;
      break;
    case LineClass::kCut:
      style.width = 1.9;
      break;
  }
  if (!visible) {
    style.width *= 0.7;
    style.cover *= 0.5f;
    style.dash = 5;
    style.gap = 3;
  }
  return style;
}

void DrawLines(std::span<const ViewLine> lines, Film* film) {
  for (const bool visible : {false, true})
    for (int kind = 0; kind < kKinds; ++kind) DrawKind(lines, static_cast<LineClass>(kind), visible, film);
}

std::string LinesSvg(std::span<const ViewLine> lines, int width_px, int height_px, double mm_per_px,
                     const std::string& title) {
  const std::string size = std::to_string(width_px) + " " + std::to_string(height_px);
  std::string svg =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " +
      size + "\"";
  char text[160];
  if (mm_per_px > 0) {
    std::snprintf(text, sizeof text, " width=\"%.6gmm\" height=\"%.6gmm\"", mm_per_px * width_px,
                  mm_per_px * height_px);
  } else {
    std::snprintf(text, sizeof text, " width=\"%d\" height=\"%d\"", width_px, height_px);
  }
  svg += text;
  svg += ">\n<title>" + EscapedXml(title) + "</title>\n";
  if (mm_per_px > 0) {
    std::snprintf(text, sizeof text, "<!-- one pixel of the view box is %.17g mm -->\n", mm_per_px);
    svg += text;
  }
  svg += "<style>\npath { fill: none; stroke-linecap: round; stroke-linejoin: round }\n";
  std::string groups;
  for (const bool visible : {false, true}) {
    for (int k = 0; k < kKinds; ++k) {
      const LineClass kind = static_cast<LineClass>(k);
      std::string paths;
      for (const ViewLine& line : lines) {
        if (line.kind != kind || line.visible != visible) continue;
        std::vector<bool> keep(line.points.size(), false);
        keep.front() = keep.back() = true;
        Simplify(line.points, 0, line.points.size() - 1, &keep);
        paths += "<path d=\"M";
        bool first = true;
        for (std::size_t i = 0; i < line.points.size(); ++i) {
          if (!keep[i]) continue;
          paths += (first ? "" : "L") + Number(line.points[i].x) + " " + Number(line.points[i].y);
          first = false;
        }
        paths += "\"/>\n";
      }
      if (paths.empty()) continue;
      const LineStyle style = LineStyleFor(kind, visible);
      const std::string name = kLineClassNames[k];
      svg += "." + name + (visible ? ".visible" : ".hidden") + " { stroke: " + Hex(style.ink) +
             "; stroke-width: " + Number(style.width) + "; stroke-opacity: " + Number(style.cover);
      if (style.dash > 0) svg += "; stroke-dasharray: " + Number(style.dash) + " " + Number(style.gap);
      svg += " }\n";
      groups += "<g class=\"" + name + (visible ? " visible" : " hidden") + "\">\n" + paths + "</g>\n";
    }
  }
  svg += "</style>\n" + groups + "</svg>\n";
  return svg;
}

}  // namespace facetless
