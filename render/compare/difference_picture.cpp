#include "render/compare/difference_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "render/base/parallel.h"
#include "render/image/color_map.h"
#include "render/image/text.h"
#include "render/shade/features.h"

namespace facetless {
namespace {

using Rgb = std::array<std::uint8_t, 3>;
constexpr Rgb kBackground = {222, 221, 217}, kPaper = {250, 249, 246}, kInk = {40, 40, 44};
constexpr Rgb kOnlyDirect = {24, 24, 28}, kOnlyBaseline = {250, 200, 20};
constexpr Rgb kBorder = {150, 152, 158};  // the same as in the page's heat map
// Lines of the surface are drawn faintly, so that the part can be recognized: kLineLight is the share of the
// light that remains.
constexpr double kLineLight = 0.80, kLineCosine = 0.94;  // creases of more than 20 degrees
constexpr double kSmallestRange = 1e-9;                  // mm, for pictures that agree in every digit

// Rounds up to 1, 2 or 5 times a power of ten.
double RoundUp(double x) {
  double power = kSmallestRange;
  while (10 * power < x) power *= 10;
  for (double digit : {1.0, 2.0, 5.0})
    if (digit * power >= x) return digit * power;
  return 10 * power;
}

// Computes the picture's range by law 2 of the header.
double RobustRange(const SampleBuffer& direct, const SampleBuffer& baseline,
                   const std::vector<std::uint8_t>& border, const Difference& difference) {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < direct.size(); ++i)
    if (!border[i] && std::isfinite(direct.depth[i]) && std::isfinite(baseline.depth[i]))
      sizes.push_back(std::fabs(baseline.depth[i] - direct.depth[i]));
  double range = std::max(difference.noise_mm, kSmallestRange);
  if (!sizes.empty()) {
    const auto place =
        sizes.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), place, sizes.end());
    range = std::max(range, *place);
  }
  return RoundUp(range);
}

void Put(Image8& image, int x, int y, const Rgb& color) {
  std::copy(color.begin(), color.end(), image.at(x, y));
}

void FillBox(Image8& image, int x0, int y0, int x1, int y1, const Rgb& color) {
  for (int y = std::max(y0, 0); y < std::min(y1, image.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, image.width); ++x) Put(image, x, y, color);
}

Rgb Dimmed(const Rgb& color) {
  Rgb out;
  for (int c = 0; c < 3; ++c)
    out[c] = EncodeByte(static_cast<float>(kLineLight * kLineLight * SrgbToLinear(color[c] / 255.0)));
  return out;
}

// Returns true if a line of the direct image runs to the right of pixel (x, y) or below it.
bool OnLine(const SampleBuffer& direct, const CameraFrame& frame, int x, int y) {
  const std::size_t i = static_cast<std::size_t>(y) * direct.width + x;
  return (x + 1 < direct.width && StepBetween(direct, frame, i, i + 1, kLineCosine) != Step::kNone) ||
         (y + 1 < direct.height &&
          StepBetween(direct, frame, i, i + direct.width, kLineCosine) != Step::kNone);
}

void DrawView(Image8& image, const SampleBuffer& direct, const SampleBuffer& baseline,
              const std::vector<std::uint8_t>& border, const CameraFrame& frame, double range) {
  ParallelFor(0, direct.height, [&](int y) {
    for (int x = 0; x < direct.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * direct.width + x;
      const bool in_direct = std::isfinite(direct.depth[i]), in_baseline = std::isfinite(baseline.depth[i]);
      Rgb color = kBackground;
      if (in_direct && in_baseline) {
        color = border[i] ? kBorder : DivergingColor((baseline.depth[i] - direct.depth[i]) / range);
        if (OnLine(direct, frame, x, y)) color = Dimmed(color);
      } else if (in_direct) {
        color = kOnlyDirect;
      } else if (in_baseline) {
        color = kOnlyBaseline;
      }
      Put(image, x, y, color);
    }
  });
}

// Formats a number for people: at most four digits, and a typographic minus.
std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", std::fabs(value));
  return value < 0 ? "−" + std::string(text) : std::string(text);
}

// The legend's dimensions, px; all of them follow from the size of its text.
struct Layout {
  double text = 11;
  int margin = 0, bar_height = 0, height = 0;

  explicit Layout(int width) {
    text = std::clamp(width / 48.0, 7.0, 28.0);
    margin = static_cast<int>(1.2 * text);
    bar_height = static_cast<int>(1.1 * text);
    height = static_cast<int>(8.6 * text);
  }
};

void DrawCentered(Image8& image, double x, double y, const std::string& words, const TextStyle& style) {
  const double width = TextWidth(words, style);
  DrawText(image, std::clamp(x - width / 2, 2.0, std::max(2.0, image.width - width - 2)), y, words, style);
}

void DrawLegend(Image8& image, int top, const Layout& layout, const Difference& difference, double range) {
  FillBox(image, 0, top, image.width, image.height, kPaper);
  FillBox(image, 0, top, image.width, top + 1, Dimmed(kBackground));
  TextStyle style;
  style.size_px = layout.text;

  // The title, and the meaning of the colours.
  const double line = 1.75 * layout.text;
  double y = top + layout.margin + layout.text;
  DrawCentered(image, image.width / 2.0, y, "depth of mesh − depth of surface, mm", style);

  // The bar with its ticks.
  const int bar_top = static_cast<int>(y + 0.75 * layout.text);
  const int left = layout.margin * 2, right = image.width - layout.margin * 2;
  for (int x = left; x < right; ++x) {
    const double t = 2 * (x - left + 0.5) / (right - left) - 1;
    FillBox(image, x, bar_top, x + 1, bar_top + layout.bar_height, DivergingColor(t));
  }
  y = bar_top + layout.bar_height + 0.45 * layout.text + layout.text;
  for (int tick = -2; tick <= 2; ++tick) {
    const int x = left + (right - left - 1) * (tick + 2) / 4;
    FillBox(image, x, bar_top + layout.bar_height, x + 1,
            bar_top + layout.bar_height + layout.bar_height / 4 + 1, kInk);
    DrawCentered(image, x, y + 0.1 * layout.text, Number(range * tick / 2), style);
  }

  // The pixels that only one of the two representations hits.
  y += line;
  const std::string only_direct =
      "only surface: " + std::to_string(difference.silhouette.only_direct) + " px";
  const std::string only_mesh = "only mesh: " + std::to_string(difference.silhouette.only_baseline) + " px";
  const std::string borders = "border: " + std::to_string(difference.border_pixels) + " px";
  const int box = static_cast<int>(layout.text);
  double x = left;
  for (const auto& [words, color] : {std::pair{only_direct, kOnlyDirect}, std::pair{only_mesh, kOnlyBaseline},
                                     std::pair{borders, kBorder}}) {
    FillBox(image, static_cast<int>(x), static_cast<int>(y) - box, static_cast<int>(x) + box,
            static_cast<int>(y), color);
    DrawText(image, x + 1.5 * box, y, words, style);
    x += 1.5 * box + TextWidth(words, style) + 2.0 * box;
  }
}

}  // namespace

Result<DifferencePicture> DrawDifference(const SampleBuffer& direct, const SampleBuffer& baseline,
                                         const CameraFrame& frame, const Difference& difference,
                                         const DifferencePictureOptions& options) {
  if (direct.width != baseline.width || direct.height != baseline.height ||
      direct.size() != baseline.size() ||
      direct.size() != static_cast<std::size_t>(direct.width) * direct.height || direct.size() == 0)
    return Error{ErrorCode::kSizeMismatch, "the views have different sizes"};
  if (!(options.range_mm >= 0) || !std::isfinite(options.range_mm))
    return Error{ErrorCode::kBadUsage,
                 "the range of the difference picture must be a positive number of millimetres"};
  for (std::size_t i = 0; i < direct.size(); ++i)
    if (std::isnan(direct.depth[i]) || std::isnan(baseline.depth[i]))
      return Error{ErrorCode::kNotFinite, "the depth at pixel (" + std::to_string(i % direct.width) + ", " +
                                              std::to_string(i / direct.width) + ") is not a number"};

  const Layout layout(direct.width);
  const std::vector<std::uint8_t> border = BorderPixels(direct, baseline, frame, difference.faces_known);
  DifferencePicture picture;
  picture.range_mm =
      options.range_mm > 0 ? options.range_mm : RobustRange(direct, baseline, border, difference);
  picture.legend_height = options.legend ? layout.height : 0;
  picture.image.width = direct.width;
  picture.image.height = direct.height + picture.legend_height;
  picture.image.bytes.resize(static_cast<std::size_t>(picture.image.width) * picture.image.height * 3);
  DrawView(picture.image, direct, baseline, border, frame, picture.range_mm);
  if (options.legend) DrawLegend(picture.image, direct.height, layout, difference, picture.range_mm);
  return picture;
}

}  // namespace facetless
