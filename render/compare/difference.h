// The difference between two traced views: every number of a view's `difference`.
//
//     Result<Difference> difference = ComputeDifference({direct, baseline, direct_image, baseline_image,
//     frame, model}); if (difference) Print(difference.value().deviation_mm.max);
//
//  1. Both buffers must belong to the same camera. Sizes are checked first, and NaN is an error.
//  2. Signs are baseline − direct: a positive depth difference means that the mesh lies farther from the eye.
//  3. depth_mm is over every pixel that both hit. deviation_mm and normal_deg leave out *border* pixels,
//     whose share is reported: pixels where the two tracers look past different sides of an edge. There the
//     depth jumps from one surface to another, and says nothing about how far the two are apart. A pixel is a
//     border pixel if a shift by one pixel explains it: (a) the tracers show different faces, and one of them
//     shows at a neighbour the face that the other shows here; or (b) a jump (features.h) runs between it and
//     a neighbour in one image, and what the other image shows here is nearer to that neighbour's depth than
//     to this pixel's. A face that the mesh lacks is no border: nothing within a pixel explains it, and it
//     counts.
//  4. deviation_mm = |depth difference| · |N · D|, D the ray at depth 1: the distance between the surfaces,
//     to first order (too large within some pixels of a silhouette, where the surface bends away from the
//     ray).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/image/film.h"
#include "render/image/metrics.h"
#include "render/model/model.h"
#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

// Statistics of absolute values, except `mean`, which is signed for depth. Percentiles are by nearest rank,
// so they are values that occur.
struct Spread {
  double mean = 0, mean_abs = 0, rms = 0, p50 = 0, p95 = 0, p99 = 0, max = 0;
  std::uint64_t count = 0;     // 0: all numbers are 0 and meaningless
  int max_x = -1, max_y = -1;  // the pixel of `max`
};

struct Silhouette {
  std::uint64_t pixels = 0;  // hit by exactly one tracer
  std::uint64_t only_direct = 0, only_baseline = 0;
  double max_distance_px =
      0;  // largest distance from such a pixel to the nearest pixel that the other tracer
          // hits; +inf if the other tracer hits nothing
};

struct FaceDifference {
  std::uint32_t id = 0;  // placed face, as the direct image shows it
  std::string name;
  std::uint64_t pixels = 0;             // pixels that show the face in the direct image
  std::uint64_t missed_pixels = 0;      // … and the baseline shows nothing there
  std::uint64_t other_face_pixels = 0;  // … and the baseline shows another face there (0 for a foreign mesh)
  std::uint64_t border_pixels = 0;
  double depth_mm_max = 0;                                                 // over all pixels that both hit
  double deviation_mm_max = 0, deviation_mm_mean = 0, normal_deg_max = 0;  // without border pixels
};

struct Difference {
  ColorMetrics color;
  Silhouette silhouette;
  Spread depth_mm, deviation_mm, normal_deg;
  double noise_mm = 0;  // rounding of float32 positions; smaller differences are not significant
  std::uint64_t both_hit = 0;
  std::uint64_t border_pixels = 0;      // of both_hit
  std::uint64_t other_face_pixels = 0;  // of both_hit: the tracers show different faces
  std::uint64_t direct_hits = 0, baseline_hits = 0;
  std::uint64_t
      oriented_pixels = 0,
      opposite_pixels =
          // pixels of closed solids, without border pixels; those of them where the mesh shows its other side
      0;
  double border_share = 0, other_face_share = 0;  // of both_hit
  bool faces_known = false;                       // the mesh has the face ids of the model
  std::vector<FaceDifference> faces;  // deviation_mm_max descending, then depth_mm_max, missed_pixels, id
};

struct DifferenceInput {
  const SampleBuffer& direct;
  const SampleBuffer& baseline;
  const Image8& direct_image;
  const Image8& baseline_image;
  const CameraFrame& frame;
  const Model& model;
  bool faces_known = false;  // Mesh::from_model
  double noise_mm = 0;
  ColorMetricOptions color;
};

// Computes the difference. Errors: kSizeMismatch, kNotFinite (names the pixel), kBadUsage (options).
Result<Difference> ComputeDifference(const DifferenceInput& input);

// For each pixel, 1 if it is a border pixel (law 3).
std::vector<std::uint8_t> BorderPixels(const SampleBuffer& direct, const SampleBuffer& baseline,
                                       const CameraFrame& frame, bool faces_known);

}  // namespace facetless
