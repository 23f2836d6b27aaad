// The pixel data of a comparison, as pictures that a browser can read. The page derives the read-out under
// the pointer, the heat map and the outlines of faces from them.
//
//  1. A plane is an RGB picture of the view's size whose bytes are numbers, not colours; R is the highest
//     byte.
//  2. kFaces: the placed face that the direct tracer shows, plus 1; 0 where it hits nothing. kDepths: its
//     depth, 1 + round((depth − near) / (far − near) · (2²⁴ − 2)); 0 where it hits nothing. kNormals: its
//     unit normal, octahedral: 12 bits for each of u and v, −1 … 1 onto 0 … 4095 (Cigolle et al. 2014).
//     kDeviation: the upper 24 bits of a float32: deviation_mm of difference.h with the sign of the depth
//     difference, where both tracers hit; 0 elsewhere. kStatus: R is a PixelClass, G a Certificate, B is 1
//     where the tracers show different faces.
//  3. A deviation is rounded to an eighth of the noise of the mesh's positions, and to 13 significant bits.
//     The removed bits are not significant, and would not compress.
//  4. Reduced planes have every stride-th pixel, with fewer bits: 8 of a deviation, 16 of a depth, and 8 each
//     of u and v. They are decoded in the same way.
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
  kBorder,       // both hit, but it is a border pixel (difference.h, law 3), whose deviation is meaningless
  kOnlySurface,  // the direct tracer alone hits
  kOnlyMesh,     // the baseline alone hits
};

enum class PixelPlane : std::uint8_t { kFaces, kDepths, kNormals, kDeviation, kStatus };
constexpr std::size_t kPixelPlanes = 5;
// The name in reports and file names: "pixel-faces", …
const char* PixelPlaneName(PixelPlane plane);
// Returns whether a plane depends on the candidate with which the exact surfaces are compared.
constexpr bool IsOfCandidate(PixelPlane plane) {
  return plane == PixelPlane::kDeviation || plane == PixelPlane::kStatus;
}

struct PixelData {
  std::array<Image8, kPixelPlanes> planes;  // by PixelPlane
  double near_mm = 0, far_mm = 0;           // of kDepths; equal if nothing or one depth is hit
};

// The largest number of pixels of a view with pixel data; a browser could not hold more.
constexpr std::uint64_t kMostPixelData = std::uint64_t{1} << 24;
// The largest number of faces: a pixel has 24 bits for its face, and one value means a miss.
constexpr std::uint32_t kMostPixelFaces = (1u << 24) - 1;

// Makes the pixel data. Errors: kSizeMismatch; kNotFinite (a depth or a normal, or a deviation beyond
// float32).
Result<PixelData> MakePixelData(const SampleBuffer& direct, const SampleBuffer& baseline,
                                const CameraFrame& frame, bool faces_known, double noise_mm);

// The deviation of a pixel that both tracers hit, as in ComputeDifference, with the sign of the depth
// difference.
double SignedDeviation(const SampleBuffer& direct, const SampleBuffer& baseline, const CameraFrame& frame,
                       std::size_t pixel);

// Reduces a plane (law 4). Requires stride ≥ 1.
Image8 ReducedPlane(PixelPlane plane, const Image8& image, int stride);

}  // namespace facetless
