#include "render/image/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <vector>

#include "render/base/trigonometry.h"
#include "render/base/vec.h"
#include "render/image/paint.h"

namespace facetless {
namespace {

// The glyphs, on a grid where digits and capital letters have the height 6, small letters 3.8, and the
// baseline is at 0. "M x y" begins a stroke, "L x y" continues it, and "A cx cy rx ry from to" is a stroke
// along an ellipse (angles in eighths of a turn, counterclockwise from the right).
struct GlyphSource {
  char32_t code;
  double width;
  const char* strokes;
};
constexpr GlyphSource kGlyphs[] = {
    {U' ', 1.2, ""},
    {U'0', 3.6, "A 1.8 3 1.8 3 0 8"},
    {U'1', 3.6, "M 0.7 4.8 L 2.1 6 L 2.1 0"},
    {U'2', 3.6, "A 1.8 4.2 1.7 1.8 3.6 -0.9 L 0 0 L 3.6 0"},
    {U'3', 3.6, "A 1.7 4.5 1.5 1.5 3.3 -2 A 1.7 1.5 1.8 1.5 2 -3.3"},
    {U'4', 3.6, "M 2.7 0 L 2.7 6 L 0 1.8 L 3.6 1.8"},
    {U'5', 3.6, "M 3.2 6 L 0.6 6 L 0.35 3.2 A 1.7 1.95 1.8 1.95 3 -3.3"},
    {U'6', 3.6, "A 2.6 2 2.6 4 2 4 M 0 1.9 A 1.8 1.9 1.8 1.9 4 12"},
    {U'7', 3.6, "M 0 6 L 3.6 6 L 1.3 0"},
    {U'8', 3.6, "A 1.8 4.5 1.5 1.5 -2 6 A 1.8 1.5 1.8 1.5 2 10"},
    {U'9', 3.6, "A 1.8 4.1 1.8 1.9 0 8 M 3.6 4 A 1 4 2.6 4 0 -2"},
    {U'a', 3.4, "A 1.7 1.9 1.7 1.9 0 8 M 3.4 3.8 L 3.4 0"},
    {U'b', 3.4, "M 0 6 L 0 0 M 0 1.9 A 1.7 1.9 1.7 1.9 4 12"},
    {U'c', 3.0, "A 1.8 1.9 1.8 1.9 1.1 6.9"},
    {U'd', 3.4, "A 1.7 1.9 1.7 1.9 0 8 M 3.4 6 L 3.4 0"},
    {U'e', 3.5, "M 0 2 L 3.5 2 A 1.75 1.95 1.75 1.95 0 6.9"},
    {U'f', 2.2, "M 0 3.8 L 2 3.8 M 0.8 0 L 0.8 4.7 A 2.1 4.7 1.3 1.3 4 2"},
    {U'g', 3.4, "A 1.7 1.9 1.7 1.9 0 8 M 3.4 3.8 L 3.4 -0.2 A 1.7 -0.2 1.7 1.7 0 -3"},
    {U'h', 3.2, "M 0 6 L 0 0 M 0 2.2 A 1.6 2.2 1.6 1.6 4 0 L 3.2 0"},
    {U'i', 0.0, "M 0 3.8 L 0 0 M 0 5.5 L 0 5.5"},
    {U'j', 1.0, "M 1 3.8 L 1 -0.8 A 0 -0.8 1 1.1 0 -2 M 1 5.5 L 1 5.5"},
    {U'k', 3.0, "M 0 6 L 0 0 M 2.8 3.8 L 0 1.4 M 1.1 2.3 L 3 0"},
    {U'l', 0.0, "M 0 6 L 0 0"},
    {U'm', 5.2,
     "M 0 3.8 L 0 0 M 0 2.4 A 1.3 2.4 1.3 1.4 4 0 L 2.6 0 M 2.6 2.4 A 3.9 2.4 1.3 1.4 4 0 L 5.2 0"},
    {U'n', 3.2, "M 0 3.8 L 0 0 M 0 2.2 A 1.6 2.2 1.6 1.6 4 0 L 3.2 0"},
    {U'o', 3.6, "A 1.8 1.9 1.8 1.9 0 8"},
    {U'p', 3.4, "M 0 3.8 L 0 -2 M 0 1.9 A 1.7 1.9 1.7 1.9 4 12"},
    {U'q', 3.4, "A 1.7 1.9 1.7 1.9 0 8 M 3.4 3.8 L 3.4 -2"},
    {U'r', 2.0, "M 0 3.8 L 0 0 M 0 2 A 1.7 2 1.7 1.8 4 1.7"},
    {U's', 2.9, "A 1.45 2.85 1.3 0.95 0.9 6 A 1.45 0.95 1.45 0.95 2 -3.1"},
    {U't', 2.2, "M 0 3.8 L 2.1 3.8 M 0.8 5.2 L 0.8 1.2 A 2 1.2 1.2 1.2 4 6"},
    {U'u', 3.2, "M 0 3.8 L 0 1.6 A 1.6 1.6 1.6 1.6 4 8 M 3.2 3.8 L 3.2 0"},
    {U'v', 3.2, "M 0 3.8 L 1.6 0 L 3.2 3.8"},
    {U'w', 4.8, "M 0 3.8 L 1.2 0 L 2.4 3.5 L 3.6 0 L 4.8 3.8"},
    {U'x', 3.0, "M 0 3.8 L 3 0 M 3 3.8 L 0 0"},
    {U'y', 3.2, "M 0 3.8 L 1.6 0 M 3.2 3.8 L 1.2 -1.2 L 0.2 -1.9"},
    {U'z', 2.9, "M 0 3.8 L 2.9 3.8 L 0 0 L 2.9 0"},
    {U'µ', 3.2, "M 0 3.8 L 0 -2 M 0 1.6 A 1.6 1.6 1.6 1.6 4 8 M 3.2 3.8 L 3.2 0"},
    {U'A', 4.2, "M 0 0 L 2.1 6 L 4.2 0 M 0.8 2.2 L 3.4 2.2"},
    {U'B', 3.7, "M 0 0 L 0 6 L 2 6 A 2 4.55 1.5 1.45 2 -2 L 0 3.1 M 2 3.1 A 2 1.55 1.7 1.55 2 -2 L 0 0"},
    {U'C', 4.0, "A 2.4 3 2.4 3 1.2 6.8"},
    {U'D', 4.0, "M 1.6 6 L 0 6 L 0 0 L 1.6 0 A 1.6 3 2.4 3 -2 2"},
    {U'E', 3.4, "M 3.4 6 L 0 6 L 0 0 L 3.4 0 M 0 3.1 L 2.9 3.1"},
    {U'F', 3.4, "M 3.4 6 L 0 6 L 0 0 M 0 3.1 L 2.9 3.1"},
    {U'G', 4.3, "A 2.4 3 2.4 3 1.2 7 M 2.6 2.8 L 4.3 2.8 L 4.3 0.9"},
    {U'H', 4.0, "M 0 6 L 0 0 M 4 6 L 4 0 M 0 3.1 L 4 3.1"},
    {U'I', 1.6, "M 0 6 L 1.6 6 M 0 0 L 1.6 0 M 0.8 0 L 0.8 6"},
    {U'J', 2.6, "M 2.6 6 L 2.6 1.7 A 1.3 1.7 1.3 1.7 0 -4"},
    {U'K', 3.9, "M 0 6 L 0 0 M 3.7 6 L 0 2.3 M 1.3 3.6 L 3.9 0"},
    {U'L', 3.2, "M 0 6 L 0 0 L 3.2 0"},
    {U'M', 4.8, "M 0 0 L 0 6 L 2.4 1.5 L 4.8 6 L 4.8 0"},
    {U'N', 4.0, "M 0 0 L 0 6 L 4 0 L 4 6"},
    {U'O', 4.8, "A 2.4 3 2.4 3 0 8"},
    {U'P', 3.6, "M 0 0 L 0 6 L 1.9 6 A 1.9 4.4 1.7 1.6 2 -2 L 0 2.8"},
    {U'Q', 4.8, "A 2.4 3 2.4 3 0 8 M 2.8 1.6 L 4.7 -0.4"},
    {U'R', 3.7, "M 0 0 L 0 6 L 1.9 6 A 1.9 4.4 1.7 1.6 2 -2 L 0 2.8 M 1.7 2.8 L 3.7 0"},
    {U'S', 3.7, "A 1.8 4.5 1.7 1.5 0.9 6 A 1.8 1.5 1.9 1.5 2 -3.2"},
    {U'T', 4.0, "M 0 6 L 4 6 M 2 6 L 2 0"},
    {U'U', 4.0, "M 0 6 L 0 2 A 2 2 2 2 4 8 M 4 6 L 4 2"},
    {U'V', 4.2, "M 0 6 L 2.1 0 L 4.2 6"},
    {U'W', 6.0, "M 0 6 L 1.5 0 L 3 5.4 L 4.5 0 L 6 6"},
    {U'X', 4.0, "M 0 6 L 4 0 M 4 6 L 0 0"},
    {U'Y', 4.0, "M 0 6 L 2 3 L 4 6 M 2 3 L 2 0"},
    {U'Z', 3.8, "M 0 6 L 3.8 6 L 0 0 L 3.8 0"},
    {U'_', 3.4, "M 0 -0.8 L 3.4 -0.8"},
    {U'.', 0.0, "M 0 0 L 0 0"},
    {U',', 0.3, "M 0.3 0.1 L 0 -1.1"},
    {U':', 0.0, "M 0 3.5 L 0 3.5 M 0 0.1 L 0 0.1"},
    {U'-', 1.8, "M 0 2.2 L 1.8 2.2"},
    {U'−', 3.0, "M 0 2.8 L 3 2.8"},
    {U'+', 3.0, "M 0 2.8 L 3 2.8 M 1.5 1.3 L 1.5 4.3"},
    {U'±', 3.0, "M 0 3.3 L 3 3.3 M 1.5 1.8 L 1.5 4.8 M 0 0.5 L 3 0.5"},
    {U'×', 2.6, "M 0 1.2 L 2.6 3.8 M 0 3.8 L 2.6 1.2"},
    {U'/', 2.2, "M 0 -0.6 L 2.2 6.4"},
    {U'%', 5.0, "A 1 4.9 1 1.1 0 8 A 4 1.1 1 1.1 0 8 M 4.1 6 L 0.9 0"},
    {U'(', 1.2, "A 3 2.3 2.8 4.6 3 5"},
    {U')', 1.2, "A -1.8 2.3 2.8 4.6 1 -1"},
};
constexpr double kUnitsPerSize = 6, kGap = 1.35;

struct Segment {
  Vec2 from, to;
};
struct Glyph {
  double width = 0;
  std::vector<Segment> segments;
};

// The point at `eighths` of a turn on the unit circle, by the rational form in the tangent of half the angle.
Vec2 OnCircle(double eighths) {
  // Reduce the angle to a quarter turn around the nearest axis, where the tangent is small.
  const double quarter = std::floor(eighths / 2 + 0.5);
  const double t = PolyTan((eighths - 2 * quarter) * (std::numbers::pi / 8));
  Vec2 p{(1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)};
  for (int turn = (static_cast<int>(quarter) % 4 + 4) % 4; turn > 0; --turn) p = {-p.y, p.x};
  return p;
}

Glyph Parse(const GlyphSource& source) {
  Glyph glyph;
  glyph.width = source.width;
  char* rest = const_cast<char*>(source.strokes);
  const auto number = [&] { return std::strtod(rest, &rest); };
  Vec2 pen;
  while (*rest != 0) {
    const char command = *rest++;  // a blank is ignored
    if (command == 'M') {
      pen.x = number();
      pen.y = number();
    } else if (command == 'L') {
      Vec2 to;
      to.x = number();
      to.y = number();
      glyph.segments.push_back({pen, to});
      pen = to;
    } else if (command == 'A') {
      const double cx = number(), cy = number(), rx = number(), ry = number(), from = number(), to = number();
      const int steps = std::max(2, static_cast<int>(std::ceil(std::fabs(to - from) * 4)));
      for (int i = 0; i <= steps; ++i) {
        const Vec2 direction = OnCircle(from + (to - from) * i / steps);
        const Vec2 p{cx + rx * direction.x, cy + ry * direction.y};
        if (i > 0) glyph.segments.push_back({pen, p});
        pen = p;
      }
    }
  }
  return glyph;
}

const std::map<char32_t, Glyph>& Glyphs() {
  static const std::map<char32_t, Glyph> glyphs = [] {
    std::map<char32_t, Glyph> all;
    for (const GlyphSource& source : kGlyphs) all[source.code] = Parse(source);
    return all;
  }();
  return glyphs;
}

// Removes and returns the next code point of a UTF-8 text. Invalid bytes give U+FFFD.
char32_t Next(std::string_view& text) {
  const unsigned char lead = static_cast<unsigned char>(text[0]);
  const std::size_t length = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
  if (text.size() < length || (lead >= 0x80 && lead < 0xc0)) {
    text.remove_prefix(1);
    return 0xfffd;
  }
  char32_t code = length == 1 ? lead : lead & (0x7f >> length);
  for (std::size_t i = 1; i < length; ++i) code = (code << 6) | (static_cast<unsigned char>(text[i]) & 0x3f);
  text.remove_prefix(length);
  return code;
}

void DrawGlyph(Image8& image, double x, double y, const Glyph& glyph, const TextStyle& style) {
  const double scale = style.size_px / kUnitsPerSize, half = 0.5 * style.weight * style.size_px;
  const double reach = half + 1;
  const Rgb8 color = {style.color[0], style.color[1], style.color[2]};
  const int x0 = std::max(0, static_cast<int>(std::floor(x - reach - scale)));
  const int x1 =
      std::min(image.width - 1, static_cast<int>(std::ceil(x + scale * (glyph.width + 1) + reach)));
  const int y0 = std::max(0, static_cast<int>(std::floor(y - scale * 7 - reach)));
  const int y1 = std::min(image.height - 1, static_cast<int>(std::ceil(y + scale * 3 + reach)));
  for (int py = y0; py <= y1; ++py)
    for (int px = x0; px <= x1; ++px) {
      const Vec2 p{(px + 0.5 - x) / scale, (y - py - 0.5) / scale};
      double nearest = INFINITY;
      for (const Segment& segment : glyph.segments)
        nearest = std::min(nearest, DistanceToSegment(segment.from, segment.to, p));
      const double cover = std::clamp(half + 0.5 - nearest * scale, 0.0, 1.0);
      if (cover > 0) CoverPixel(image.at(px, py), image.channels, color, cover);
    }
}

}  // namespace

bool CanDraw(std::string_view utf8) {
  while (!utf8.empty())
    if (!Glyphs().contains(Next(utf8))) return false;
  return true;
}

double TextWidth(std::string_view utf8, const TextStyle& style) {
  double width = 0;
  while (!utf8.empty()) {
    const auto glyph = Glyphs().find(Next(utf8));
    if (glyph != Glyphs().end()) width += glyph->second.width + kGap;
  }
  return std::max(width - kGap, 0.0) * style.size_px / kUnitsPerSize;
}

void DrawText(Image8& image, double x, double y, std::string_view utf8, const TextStyle& style) {
  while (!utf8.empty()) {
    const auto glyph = Glyphs().find(Next(utf8));
    if (glyph == Glyphs().end()) continue;
    DrawGlyph(image, x, y, glyph->second, style);
    x += (glyph->second.width + kGap) * style.size_px / kUnitsPerSize;
  }
}

}  // namespace facetless
