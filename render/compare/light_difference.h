// What another representation does to light: the shadows and the occlusion of a candidate against those of the
// reference, at the pixel centres of a view.
//
//  1. Pixels are compared where both show a surface, or both show the ground. Along silhouettes they may show different
//     surfaces; such pixels count like all others.
//  2. A pixel is *falsely self-shadowed* if the key light reaches the reference there, and the candidate's own ray is
//     blocked by the same face that it starts from. On a smooth face that bulges towards the light, this is the work of
//     facets. It is not known for a mesh without the face ids of the model.
//  3. In the picture, orange marks what only the reference lights, blue what only the candidate lights, and purple false
//     self-shadow. Elsewhere, the difference of the open share of the sky is shown by the same orange and blue, four
//     times enlarged. Everything lies over a pale picture of the reference.
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
  std::uint64_t pixels = 0;  // compared
  bool shadows = false;      // the next three members are known
  std::uint64_t lit_only_reference = 0, lit_only_candidate = 0;
  std::optional<std::uint64_t> false_self_shadow;
  bool occlusion = false;     // the next three members are known
  double occlusion_mean = 0;  // mean of candidate − reference: above 0, the candidate is darker
  double occlusion_mean_abs = 0, occlusion_max = 0;

  // Share of the pixels that are lit on one and dark on the other.
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
  Image8 picture;  // of the size of the view
};

// `base` is the picture of the reference. `faces_known`: the candidate's samples have the placed faces of the model.
// Errors: kSizeMismatch (the views differ in size, or were lit with different options).
Result<LightComparison> CompareLight(const LitView& reference, const LitView& candidate,
                                     const CameraFrame& frame, bool faces_known, const Image8& base);

}  // namespace facetless
