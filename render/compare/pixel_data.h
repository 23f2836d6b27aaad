// What a comparison knows of each pixel, as pictures that a browser can read: the read-out under a pointer,
// the heat map and the outline of a face are made from them.
//
//  1. A plane is an RGB picture of the view's size whose bytes are numbers, not colours; R is the highest
//     byte.
//  2. kFaces: the placed face that the direct tracer shows, plus 1; 0 where it hits nothing. kDepths: its
//     depth, 1 + round((depth − near) / (far − near) · (2²⁴ − 2)); 0 where it hits nothing. kNormals: its
//     unit normal, octahedral: 12 bits for each of u and v, −1 … 1 onto 0 … 4095 (Cigolle et al. 2014).
//     kDeviation: the upper 24 bits of a float32: deviation_mm of difference.h with the sign of the depth
//     difference, where both tracers hit; 0 elsewhere. kStatus: R is a PixelClass, G a Certificate, B is 1
//     where the tracers show different faces.
//  3. A deviation is rounded to an eighth of the noise of the mesh's positions, and to 13 significant bits:
//     what is left out says nothing, and would not compress.
//  4. Reduced planes hold every stride-th pixel, with fewer bits: 8 of a deviation's, 16 of a depth, 8 of
//     each of u and v. They decode the same way.
#pragma once

#include <array>
#include <cstdint>

#include "render/base/result.h"
#include "render/compare/difference.h"
#include "render/image/film.h"

namespace facetless {

enum class PixelClass : std::uint8_t {
  kNothing,      // neither tracer hits
  kMeasured,     // both hit
  kBorder,       // both hit, and law 3 of difference.h says border: the deviation says nothing there
  kOnlySurface,  // the direct tracer alone hits
  kOnlyMesh,     // the baseline alone hits
};

enum class PixelPlane : std::uint8_t { kFaces, kDepths, kNormals, kDeviation, kStatus };
constexpr std::size_t kPixelPlanes = 5;
// As reports and files name them: "pixel-faces", …
const char* PixelPlaneName(PixelPlane plane);
// Whether a plane depends on what the exact surfaces are compared with.
constexpr bool IsOfCandidate(PixelPlane plane) {
  return plane == PixelPlane::kDeviation || plane == PixelPlane::kStatus;
}

struct PixelData {
  std::array<Image8, kPixelPlanes> planes;  // by PixelPlane
  double near_mm = 0, far_mm = 0;           // of kDepths; equal if nothing or one depth is hit
};

// Of views up to so many pixels reports carry pixel data; a browser would not hold more.
constexpr std::uint64_t kMostPixelData = std::uint64_t{1} << 24;
// A pixel has 24 bits for its face, one value of which says that there is none.
constexpr std::uint32_t kMostPixelFaces = (1u << 24) - 1;

// Errors: kSizeMismatch; kNotFinite (a depth or a normal, or a deviation beyond float32).
Result<PixelData> MakePixelData(const SampleBuffer& direct, const SampleBuffer& baseline,
                                const CameraFrame& frame, bool faces_known, double noise_mm);

// What ComputeDifference takes for the deviation of a pixel that both hit, with the sign of the depth
// difference.
double SignedDeviation(const SampleBuffer& direct, const SampleBuffer& baseline, const CameraFrame& frame,
                       std::size_t pixel);

// Law 4. Requires stride ≥ 1.
Image8 ReducedPlane(PixelPlane plane, const Image8& image, int stride);

}  // namespace facetless
