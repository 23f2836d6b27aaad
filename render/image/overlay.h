// Overlays that are drawn into a finished picture: a scale bar and the axes of the model.
//
//  1. Both are placed at the lower border of the picture, the axes on the left and the bar on the right.
//     Their sizes depend on the size of the picture. A picture with fewer than kLeastOverlay pixels on a side
//     has no room for them and is not changed.
//  2. The strokes are dark or coloured with a light outline, so they are legible on light, dark and
//     transparent pictures.
//  3. The length of the bar is 1, 2 or 5 times a power of ten in nm, µm, mm, m or km, and at most a quarter
//     of the width of the picture. The bar is aligned to whole pixels, so it is accurate to half a pixel.
//  4. The axes are drawn in the orientation of the model, the nearest one on top. An axis along the view
//     direction is drawn as a dot if it points towards the viewer, and as a ring otherwise.
#pragma once

#include <string>

#include "render/image/film.h"
#include "render/view/camera.h"

namespace facetless {

inline constexpr int kLeastOverlay = 96;

struct OverlayOptions {
  bool axes = false, scale_bar = false;
};

// Draws over the upper `height` rows of the image, for which the frame was made. A perspective view has no
// uniform scale, so no bar is drawn.
void DrawOverlay(Image8& image, int height, const CameraFrame& frame, const OverlayOptions& options);

// The length and the label of the longest bar of at most `most_mm`. Requires most_mm > 0.
struct ScaleBar {
  double length_mm = 0;
  std::string label;
};
ScaleBar LongestScaleBar(double most_mm);

}  // namespace facetless
