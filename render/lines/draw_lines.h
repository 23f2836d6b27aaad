// Lines drawn over a film, and written as SVG.
//
//  1. A line covers a pixel by its distance to the pixel's centre: fully within half its width less half a
//     pixel, not at all beyond half its width and half a pixel, evenly between. Pieces of one kind cover by
//     their largest, so joints are not doubled. No libm function but sqrt; the same bytes for any number of
//     threads.
//  2. Hidden lines lie below the others, dashed and light. What they are drawn with is in StyleOf, for both.
#pragma once

#include <span>
#include <string>

#include "render/base/result.h"
#include "render/image/film.h"
#include "render/lines/line.h"

namespace facetless {

struct LineStyle {
  double width = 1.2;                       // pixels
  float cover = 1;                          // of what lies below
  float ink[3] = {0.016f, 0.017f, 0.020f};  // linear light
  double dash = 0, gap = 0;                 // pixels; 0: solid
};
LineStyle StyleOf(LineClass kind, bool visible);

// `film` is one of pixels, not of samples; the lines lie in it or near it, as FindLines has them.
void DrawLines(std::span<const ViewLine> lines, Film* film);

// An SVG document: a group for each class, hidden lines apart, the view box in pixels. `mm_per_px`: of an
// orthographic view, written as the document's size in millimetres; 0 for perspective. `title`: UTF-8; markup
// in it is escaped.
std::string LinesSvg(std::span<const ViewLine> lines, int width_px, int height_px, double mm_per_px,
                     const std::string& title);

}  // namespace facetless
