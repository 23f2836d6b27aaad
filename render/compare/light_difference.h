// The difference of light: compares the shadows and the occlusion of a candidate with those of the reference, at the
// pixel centres of a view.
//
//     Result<LightComparison> light = CompareLight({a.samples, *a.light}, {b.samples, *b.light}, frame, true, picture);
//     if (!light) return light.error();
//
//  1. A pixel is compared if both representations show a surface there, or both show the ground. Along silhouettes, the
//     two may show different surfaces; such pixels count like all others.
//  2. A pixel is *falsely self-shadowed* if the key light reaches the reference there, while the candidate's surface
//     faces the light and the first face on its shadow ray is the face from which the ray starts. On a convex, smooth
//     face, only the facets can cause this. For a mesh without the face ids of the model, it is unknown.
//  3. In the picture, orange marks pixels that are lit only on the reference, blue those that are lit only on the
//     candidate, and purple those that are falsely self-shadowed. On all other compared pixels, orange means that less
//     ambient light arrives on the candidate, and blue that less arrives on the reference; the strength of the colour
//     is four times the difference. The colours lie over a pale picture of the reference.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/result.h"
#include "render/compare/view_light.h"
#include "render/image/film.h"
#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

struct LightDifference {
  std::uint64_t pixels = 0;  // number of pixels that are compared
  bool shadows = false;      // shadows were cast, and the next three members are set
  // Numbers of pixels. The falsely self-shadowed pixels are among those that are lit only on the reference.
  std::uint64_t lit_only_reference = 0, lit_only_candidate = 0;
  std::optional<std::uint64_t> false_self_shadow;  // nothing if the candidate's faces are unknown
  bool occlusion = false;                          // occlusion was cast, and the next three members are set
  // The difference of the share of the ambient light that arrives, reference − candidate, −1 … 1: its mean (above 0 if
  // the candidate is darker), and the mean and the maximum of its magnitude.
  double occlusion_mean = 0;
  double occlusion_mean_abs = 0, occlusion_max = 0;

  // The share of the compared pixels that the key light reaches on one representation and not on the other, 0 … 1.
  double OtherShadowShare() const {
    return pixels > 0
               ? static_cast<double>(lit_only_reference + lit_only_candidate) / static_cast<double>(pixels)
               : 0;
  }
};

struct LitView {
  const SampleBuffer& samples;
  const ViewLight& light;
};

struct LightComparison {
  LightDifference difference;
  Image8 picture;  // law 3; it has the size of the view
};

// Compares the light of two views. `base` is the picture of the reference. `faces_known` says whether the candidate's
// samples have the placed faces of the model. Errors: kSizeMismatch (the views or `base` differ in size, or only one
// view has shadows or occlusion).
Result<LightComparison> CompareLight(const LitView& reference, const LitView& candidate,
                                     const CameraFrame& frame, bool faces_known, const Image8& base);

}  // namespace facetless
