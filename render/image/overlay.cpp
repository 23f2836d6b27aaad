#include "render/image/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "render/image/paint.h"
#include "render/image/text.h"

namespace facetless {
namespace {

constexpr Rgb8 kInk = {40, 40, 44}, kSeam = {252, 252, 250};
constexpr double kSeamCover = 0.85;
constexpr double kBarShare = 0.25;  // largest length of the bar, as a share of the picture's width
// An axis whose image is shorter than this share of its length counts as running along the view.
constexpr double kAlongView = 0.12;

struct Axis {
  const char* letter;
  Rgb8 color;
  Vec3 direction;
};
constexpr Axis kAxes[] = {
    {"X", {190, 40, 40}, {1, 0, 0}}, {"Y", {30, 120, 40}, {0, 1, 0}}, {"Z", {35, 85, 200}, {0, 0, 1}}};

// The sizes of the overlay, which all depend on the size of the text.
struct Layout {
  double text, stroke, seam, margin;

  Layout(int width, int height) {
    text = std::floor(std::clamp(std::min(width, height) / 44.0, 8.0, 64.0));
    stroke = std::max(2.0, std::round(text / 5));
    seam = std::max(1.0, std::round(text / 8));
    margin = std::round(1.4 * text);
  }
};

void Write(Image8& image, Vec2 at, const char* words, const Rgb8& color, const Layout& layout) {
  TextStyle style;
  style.size_px = layout.text;
  const double weight = style.weight;
  style.weight = weight + 2 * layout.seam / layout.text;
  std::copy(kSeam.begin(), kSeam.end(), style.color);
  DrawText(image, at.x, at.y, words, style);
  style.weight = weight;
  std::copy(color.begin(), color.end(), style.color);
  DrawText(image, at.x, at.y, words, style);
}

// Writes a text that is centred at `center`.
void WriteCentered(Image8& image, Vec2 center, const char* words, const Rgb8& color, const Layout& layout) {
  TextStyle style;
  style.size_px = layout.text;
  Write(image, {center.x - 0.5 * TextWidth(words, style), center.y + 0.5 * layout.text}, words, color,
        layout);
}

void DrawAxes(Image8& image, int height, const CameraFrame& frame, const Layout& layout) {
  const double length = 2.8 * layout.text, around = length + 1.6 * layout.text;
  const Vec2 origin{std::round(layout.margin + around), std::round(height - layout.margin - around)};
  struct Seen {
    const Axis* axis;
    Vec2 on_screen;
    double depth;
  };
  std::array<Seen, 3> seen;
  Vec2 sum;
  for (int i = 0; i < 3; ++i) {
    const Vec3 d = kAxes[i].direction;
    seen[i] = {&kAxes[i], {Dot(d, frame.right), Dot(d, frame.down)}, Dot(d, frame.forward)};
    sum = sum + seen[i].on_screen;
  }
  std::stable_sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.depth > b.depth; });

  // Draw all outlines first, so that no outline covers another axis.
  for (const Seen& axis : seen)
    DrawStroke(image, origin, origin + length * axis.on_screen, layout.stroke + 2 * layout.seam, kSeam,
               kSeamCover);
  for (const auto& [axis, on_screen, depth] : seen) {
    const double shown = Length(on_screen);
    if (shown >= kAlongView) {
      DrawStroke(image, origin, origin + length * on_screen, layout.stroke, axis->color);
      WriteCentered(image, origin + (length + 0.95 * layout.text / shown) * on_screen, axis->letter,
                    axis->color, layout);
      continue;
    }
    const double radius = 1.3 * layout.stroke;
    DrawStroke(image, origin, origin, 2 * (radius + layout.seam), kSeam, kSeamCover);
    DrawStroke(image, origin, origin, 2 * radius, axis->color);
    if (depth > 0) DrawStroke(image, origin, origin, 1.1 * radius, kSeam);
    // Put its letter on the side away from the two other axes.
    const double other = Length(sum);
    const Vec2 away = other > 0 ? (-1.35 * layout.text / other) * sum : Vec2{};
    WriteCentered(image, origin + away, axis->letter, axis->color, layout);
  }
}

void DrawScaleBar(Image8& image, int height, const CameraFrame& frame, const Layout& layout) {
  const ScaleBar bar = LongestScaleBar(kBarShare * image.width * frame.pixel_x);
  const double length = std::max(1.0, std::round(bar.length_mm / frame.pixel_x));
  const double right = image.width - layout.margin, left = right - length;
  const double bottom = height - layout.margin, top = bottom - layout.stroke;
  const double tick = std::round(0.7 * layout.text);
  // Draw the bar with a tick at each end, and an outline around all three.
  const std::pair<Vec2, Vec2> areas[] = {{{left, top}, {right, bottom}},
                                         {{left, bottom - tick}, {left + layout.stroke, top}},
                                         {{right - layout.stroke, bottom - tick}, {right, top}}};
  const Vec2 seam{layout.seam, layout.seam};
  for (const auto& [low, high] : areas) FillRectangle(image, low - seam, high + seam, kSeam);
  for (const auto& [low, high] : areas) FillRectangle(image, low, high, kInk);
  TextStyle style;
  style.size_px = layout.text;
  const double half = 0.5 * TextWidth(bar.label, style);
  const double center = std::min(0.5 * (left + right), image.width - layout.seam - 2 - half);
  Write(image, {center - half, bottom - tick - 0.45 * layout.text}, bar.label.c_str(), kInk, layout);
}

}  // namespace

ScaleBar LongestScaleBar(double most_mm) {
  // Find the power of ten step by step, because results of pow() differ between processors.
  int exponent = 0;
  double power = 1;
  for (; power * 10 <= most_mm && exponent < 300; ++exponent) power *= 10;
  for (; power > most_mm && exponent > -300; --exponent) power /= 10;
  int digit = 1;
  for (const int next : {2, 5})
    if (next * power <= most_mm) digit = next;

  struct Unit {
    const char* name;
    int exponent;  // of ten, mm
  };
  constexpr Unit kUnits[] = {{"nm", -6}, {"µm", -3}, {"mm", 0}, {"m", 3}, {"km", 6}};
  const Unit* unit = &kUnits[0];
  for (const Unit& larger : kUnits)
    if (exponent >= larger.exponent) unit = &larger;
  const int zeros = exponent - unit->exponent;
  ScaleBar bar;
  bar.length_mm = digit * power;
  // Write zeros out if there are few of them.
  char label[48];
  if (zeros >= 0 && zeros < 4) {
    int number = digit;
    for (int i = 0; i < zeros; ++i) number *= 10;
    std::snprintf(label, sizeof label, "%d %s", number, unit->name);
  } else {
    std::snprintf(label, sizeof label, "%de%d %s", digit, zeros, unit->name);
  }
  bar.label = label;
  return bar;
}

void DrawOverlay(Image8& image, int height, const CameraFrame& frame, const OverlayOptions& options) {
  if (std::min(image.width, height) < kLeastOverlay) return;
  const Layout layout(image.width, height);
  if (options.axes) DrawAxes(image, height, frame, layout);
  if (options.scale_bar && frame.projection == Projection::kOrthographic)
    DrawScaleBar(image, height, frame, layout);
}

}  // namespace facetless
