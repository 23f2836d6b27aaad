// One shading function for both tracers: a soft two-light studio.
//
//  1. A pixel's colour depends on its normal, its view direction and its face's colour, and on nothing
//     else: no shadow, no secondary ray, no random number. Two tracers that agree in the samples agree in
//     every byte.
//  2. Normals are flipped to the viewer, so open shells look the same from both sides.
//  3. Lights stand still relative to the camera: a warm key from above left, a cool fill from below right,
//     a rim.
//  4. No library's sin, exp or pow is on the way to a pixel; sums and products are in a fixed order.
//  5. Edges, where asked for, are drawn at silhouettes (a jump in depth that the surface's slope does not
//     explain) and where the normals on both sides of a face border differ by more than edge_angle_deg.
//     They are about one pixel wide: with samples_x × samples_y samples per pixel, as many samples.
//  6. Caps of section planes have their solid's colour, hatched (hatch.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/image/film.h"
#include "render/model/model.h"
#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

enum class Background : std::uint8_t { kStudio, kTransparent };  // an even light ivory; alpha 0

struct ShadeOptions {
  Background background = Background::kStudio;
  bool edges = false;
  double edge_angle_deg = 20;        // 0 … 180
  int samples_x = 1, samples_y = 1;  // samples per pixel: the width of edges
  Color fallback;                    // of a face id beyond `colors`
  // Face ids from here on are caps, those of a plane following each other by solid (view/section.h).
  std::uint32_t first_cap = kNoIndex, cap_stride = 1;
  Execution execution;  // shading is short, and is not cancelled
};

// `colors` by placed-face id (sRGB); `frame` is the one that the samples were traced with. Errors:
// kSizeMismatch (buffers of different length), kNotFinite (a hit whose depth or normal is no number: names
// the pixel), kBadUsage (options).
Result<Film> Shade(const SampleBuffer& samples, const CameraFrame& frame, std::span<const Color> colors,
                   const ShadeOptions& options);

// What Shade shows where nothing is hit: red, green, blue times alpha, and alpha; linear.
std::array<float, 4> BackgroundLight(Background background);

// Law 6 alone: hatches the pixel of a cap's sample, x and y from the film's corner; leaves others as they
// are.
void HatchCap(const ShadeOptions& options, std::uint32_t face, double x, double y,
              std::array<float, 4>* pixel);

// Law 5 alone, over a film that somebody else made from the samples. Requires equal sizes.
void DrawFeatureEdges(const SampleBuffer& samples, const CameraFrame& frame, const ShadeOptions& options,
                      Film& film);

}  // namespace facetless
