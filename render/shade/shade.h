// The shading function for all tracers: a studio with two soft lights.
//
//     Result<Film> film = Shade(result.samples, result.frame, colors, {.edges = true});
//     if (!film) return film.error();
//
//  1. The colour of a pixel depends only on its normal, its view direction, the colour of its face, and the share of
//     the light that reaches it (ShadeOptions::light; all of the light if no secondary rays were cast). There are no
//     random numbers. Two tracers whose samples are equal give pictures with equal bytes.
//  2. Normals are flipped towards the viewer, so open shells look the same from both sides.
//  3. The lights are fixed relative to the camera: a warm key light from above left, a cool fill light from
//     below right, and a rim light.
//  4. The code does not call sin, exp or pow of a library, and adds and multiplies in a fixed order.
//  5. Edges, if requested, are drawn at silhouettes (a jump in depth that the slope of the surface does not
//     explain), and where the normals on both sides of a face border differ by more than edge_angle_deg. They
//     are about one pixel wide, which is samples_x × samples_y samples.
//  6. Caps of section planes have the colour of their solid and are hatched (hatch.h).
//  7. Where the light of the ground is blocked, the background is darker. On a transparent background, the ground is
//     black, and its alpha is the share of its light that is missing.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/image/film.h"
#include "render/model/model.h"
#include "render/shade/cast_light.h"
#include "render/view/camera.h"
#include "render/view/refinement.h"
#include "render/view/samples.h"

namespace facetless {

enum class Background : std::uint8_t { kStudio, kTransparent };  // an even light ivory; alpha 0

struct ShadeOptions {
  Background background = Background::kStudio;
  bool edges = false;
  double edge_angle_deg = 20;        // 0 … 180
  int samples_x = 1, samples_y = 1;  // samples per pixel, which determine the width of edges
  Color fallback;                    // colour of face ids beyond `colors`
  // Face ids from first_cap on are caps. The caps of each plane are consecutive, ordered by solid
  // (view/section.h).
  std::uint32_t first_cap = kNoIndex, cap_stride = 1;
  // The light that reaches the samples (cast_light.h), one entry for each sample. Null: all light reaches them.
  const SampleLight* light = nullptr;
  Vec3 ground_up;       // normal of the ground, if `light` has one
  Execution execution;  // shading takes little time and is not cancelled
};

// Shades samples. `colors` is indexed by placed-face id (sRGB); `frame` is the frame with which the samples
// were traced. Errors: kSizeMismatch (the buffers or the light have different lengths), kNotFinite (the depth or the
// normal of a hit is not a number; names the pixel), kBadUsage (options).
Result<Film> Shade(const SampleBuffer& samples, const CameraFrame& frame, std::span<const Color> colors,
                   const ShadeOptions& options);

// Shades the samples of refined pixels, and replaces those pixels of `film`, which was shaded from the pixel
// centres of the same view: each becomes the mean of its samples, exactly as if Resolve had made it from all
// samples. `options` are those of Shade; edges are not drawn. Errors: kSizeMismatch (the film or the light has another
// size), kNotFinite (as Shade).
Result<void> ShadeRefinement(const Refinement& refinement, std::span<const Color> colors,
                             const ShadeOptions& options, Film* film);

// The linear light that Shade gives to misses: red, green and blue, multiplied by alpha, and alpha.
std::array<float, 4> BackgroundLight(Background background);

// Applies law 6 alone: hatches the pixel if its sample is a cap, and leaves it unchanged otherwise. x and y
// are relative to the corner of the film.
void HatchCap(const ShadeOptions& options, std::uint32_t face, double x, double y,
              std::array<float, 4>* pixel);

// Applies law 5 alone, over a film that other code made from the samples. Requires equal sizes.
void DrawFeatureEdges(const SampleBuffer& samples, const CameraFrame& frame, const ShadeOptions& options,
                      Film& film);

}  // namespace facetless
