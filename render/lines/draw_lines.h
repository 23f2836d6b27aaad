// Drawing lines over a film, and writing them as SVG.
//
//     const std::vector<ViewLine> lines = FindLines(scene, camera, frame, samples, frame, {});
//     DrawLines(lines, &film);
//     const std::string svg = LinesSvg(lines, camera.width_px, camera.height_px, frame.pixel_x, "part");
//
//  1. The distance of a line from the centre of a pixel determines how much of the pixel the line covers: all
//     of it up to half the width minus half a pixel, nothing beyond half the width plus half a pixel, and
//     linearly in between. The coverages of pieces of the same kind are combined by their maximum, so joints
//     do not appear darker. sqrt is the only libm function used, and the bytes are the same for any number of
//     threads.
//  2. Hidden lines lie below the others, dashed and lighter. LineStyleFor has the style of both.
#pragma once

#include <span>
#include <string>

#include "render/base/result.h"
#include "render/image/film.h"
#include "render/lines/line.h"

namespace facetless {

struct LineStyle {
  double width = 1.2;                       // pixels
  float cover = 1;                          // coverage of what lies below, 0 … 1
  float ink[3] = {0.016f, 0.017f, 0.020f};  // linear light
  double dash = 0, gap = 0;                 // pixels; 0: solid
};
LineStyle LineStyleFor(LineClass kind, bool visible);

// Draws lines. `film` must consist of pixels, not samples. The lines must lie in the picture or near it, as
// those of FindLines do.
void DrawLines(std::span<const ViewLine> lines, Film* film);

// An SVG document with one group for each class, separate groups for hidden lines, and a view box in pixels.
// `mm_per_px` is the scale of an orthographic view, from which the size of the document in millimetres
// follows; 0 for perspective views. `title` is UTF-8 and is escaped.
std::string LinesSvg(std::span<const ViewLine> lines, int width_px, int height_px, double mm_per_px,
                     const std::string& title);

}  // namespace facetless
