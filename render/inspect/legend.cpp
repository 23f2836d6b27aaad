#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/image/color_map.h"
#include "render/image/text.h"
#include "render/inspect/picture.h"

namespace facetless {
namespace {

constexpr std::uint8_t kPaper = 244;
constexpr int kTicks = 5;

void FillBox(Image8& image, int x0, int y0, int x1, int y1, const std::array<std::uint8_t, 3>& color) {
  for (int y = std::max(y0, 0); y < std::min(y1, image.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, image.width); ++x)
      std::copy(color.begin(), color.end(), image.at(x, y));
}

// A number with three digits, a typographic minus sign, and an exponent if necessary.
std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", std::fabs(value));
  return (value < 0 ? "−" : "") + std::string(text);
}

Image8 Paper(int width, int height) {
  Image8 image;
  image.width = width;
  image.height = height;
  image.bytes.assign(static_cast<std::size_t>(width) * height * 3, kPaper);
  return image;
}

void DrawCentered(Image8& image, double x, double y, const std::string& words, const TextStyle& style) {
  const double width = TextWidth(words, style);
  DrawText(image, std::clamp(x - width / 2, 2.0, std::max(2.0, image.width - width - 2)), y, words, style);
}

// The legend of a scale: its bar with ticks, and the colours beyond its ends.
Image8 ScaleLegend(const InspectionView& view, int width, double text) {
  const TextStyle style{text};
  Image8 image = Paper(width, static_cast<int>(7.6 * text));
  double y = 1.8 * text;
  DrawCentered(image, width / 2.0, y, view.quantity.name + ", " + view.quantity.unit, style);
  const int top = static_cast<int>(y + 0.8 * text), height = static_cast<int>(1.2 * text);
  const int left = static_cast<int>(2.4 * text), right = width - left;
  for (int x = left; x < right; ++x) {
    const double t = (x - left + 0.5) / (right - left);
    FillBox(image, x, top, x + 1, top + height,
            view.quantity.has_sign ? DivergingColor(2 * t - 1) : SequentialColor(t));
  }
  y = top + height + 1.7 * text;
  for (int tick = 0; tick < kTicks; ++tick) {
    const double share = static_cast<double>(tick) / (kTicks - 1);
    const int x = left + static_cast<int>((right - left - 1) * share);
    FillBox(image, x, top + height, x + 1, top + height + height / 3 + 1, {40, 40, 44});
    DrawCentered(image, x, y, Number(view.range.low + share * (view.range.high - view.range.low)), style);
  }
  const ValueStatistics& s = view.statistics;
  std::string words = "from " + Number(s.min) + " to " + Number(s.max);
  if (s.none > 0) words += ", no number " + std::to_string(s.none) + " px";
  DrawCentered(image, width / 2.0, y + 1.8 * text, s.count > 0 ? words : "no number", style);
  return image;
}

Image8 ClassLegend(const InspectionView& view, const std::string& title, int width, double text) {
  const TextStyle style{text};
  const int line = static_cast<int>(1.9 * text), box = static_cast<int>(1.1 * text);
  Image8 image = Paper(width, static_cast<int>(2.6 * text) + line * static_cast<int>(view.classes.size()));
  DrawCentered(image, width / 2.0, 1.8 * text, title, style);
  double y = 1.8 * text + 0.6 * text;
  for (const InspectionClass& one : view.classes) {
    const int top = static_cast<int>(y), left = static_cast<int>(1.6 * text);
    const auto byte = [](float channel) { return static_cast<std::uint8_t>(channel * 255 + 0.5f); };
    FillBox(image, left, top, left + box, top + box,
            {byte(one.color.r), byte(one.color.g), byte(one.color.b)});
    DrawText(image, left + 1.7 * box, top + 0.95 * box, one.name + ": " + std::to_string(one.pixels) + " px",
             style);
    y += line;
  }
  return image;
}

}  // namespace

Image8 DrawLegend(const InspectionView& view, int width) {
  const int wide = std::max(width, kLeastLegend);
  const double text = std::clamp(wide / 48.0, 9.0, 28.0);
  switch (view.inspection.kind) {
    case InspectionKind::kCurvature:
    case InspectionKind::kThickness:
      return ScaleLegend(view, wide, text);
    case InspectionKind::kDraft:
      return ClassLegend(view, "draft, limit " + Number(view.inspection.limit_deg) + " deg", wide, text);
    case InspectionKind::kBack:
      return ClassLegend(view, "front and back faces", wide, text);
    case InspectionKind::kUnseen:
      return ClassLegend(
          view, "faces with fewer than " + std::to_string(view.inspection.few_pixels) + " px, and back faces",
          wide, text);
    default:
      return {};
  }
}

}  // namespace facetless
