// The difference as a picture: signed millimetres in colour, with a legend.
//
//  1. Blue: the mesh lies nearer to the eye than the surface; red: farther; near white: equal. The colour map
//     is diverging, even in lightness on both sides, and readable with the common colour blindnesses.
//  2. The range is symmetric. Unless given, it is the 99th percentile of |depth difference| without border
//     pixels, rounded up to 1, 2 or 5 times a power of ten, and never below the noise of float32 positions.
//     Larger differences have the colour of the end.
//  3. Pixels that only one tracer hits, and border pixels, have separate colours, which the legend explains.
//     The background is plain.
#pragma once

#include "render/base/result.h"
#include "render/compare/difference.h"
#include "render/image/film.h"

namespace facetless {

struct DifferencePictureOptions {
  double range_mm = 0;  // 0: law 2
  bool legend = true;   // adds a band below: the picture is then taller than the view
};

struct DifferencePicture {
  Image8 image;           // RGB
  double range_mm = 0;    // the value at the ends of the colour bar
  int legend_height = 0;  // pixel rows below the view
};

// Draws the picture. Errors: kSizeMismatch, kNotFinite, kBadUsage.
Result<DifferencePicture> DrawDifference(const SampleBuffer& direct, const SampleBuffer& baseline,
                                         const CameraFrame& frame, const Difference& difference,
                                         const DifferencePictureOptions& options);

}  // namespace facetless
