// What is drawn into a finished picture: a scale bar and the model's axes.
//
//  1. Both stand on the picture's lower border: axes on the left, the bar on the right. Sizes follow from the
//     picture's; one with less than kLeastOverlay pixels on a side has no room and stays as it is.
//  2. Dark or coloured strokes in a light seam: they can be read on light, on dark and on nothing (a
//     transparent picture).
//  3. The bar is 1, 2 or 5 times a power of ten long, at most a quarter of the width, in nm, µm, mm, m or km;
//     on whole pixels, so that it is right to half a pixel.
//  4. Axes are those of the model as the camera sees it: the nearest is on top, and one that runs along the
//     view is a dot (towards the viewer) or a ring.
#pragma once

#include <string>

#include "render/image/film.h"
#include "render/view/camera.h"

namespace facetless {

inline constexpr int kLeastOverlay = 96;

struct OverlayOptions {
  bool axes = false, scale_bar = false;
};

// Over the upper `height` rows of the image, which the frame was made for. A perspective frame has no scale:
// no bar is drawn.
void DrawOverlay(Image8& image, int height, const CameraFrame& frame, const OverlayOptions& options);

// The longest bar of at most `most_mm`: its length and what is written on it. Requires most_mm > 0.
struct ScaleBar {
  double length_mm = 0;
  std::string label;
};
ScaleBar LongestScaleBar(double most_mm);

}  // namespace facetless
