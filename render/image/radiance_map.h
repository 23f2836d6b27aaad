// Radiance maps: panoramas of the light that arrives from all directions, as EXR or as Radiance RGBE files (.hdr).
//
//     Result<RadianceMap> map = ReadRadianceMap("studio.hdr");
//     if (!map) return map.error();
//     const Vec3 light = map.value().At(0.25, 0.5);
//
//  1. The format is recognised by the content of the file; its name does not matter. Values are linear light; RGBE
//     values are read as red, green and blue of Rec. 709, and divided by the exposure that the file states.
//  2. Values are finite and not negative. Other values are errors, because they would spoil the pictures.
//  3. A lookup interpolates linearly between the four nearest pixels. The only libm function that it uses is floor,
//     which is exact.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/base/vec.h"

namespace facetless {

inline constexpr std::int64_t kMostRadiancePixels = std::int64_t{1} << 26;  // 16,384 × 4,096

struct RadianceMap {
  int width = 0, height = 0;
  std::vector<std::array<float, 3>> pixels;  // row by row, from the top

  // Returns the light at (x, y): x goes from the left to the right and y from the top to the bottom, both 0 … 1. The
  // left border continues at the right one. Beyond the centres of the top and the bottom row, that row is repeated.
  Vec3 At(double x, double y) const;
};

// Reads a file. Errors: kFileUnreadable, kFormatUnknown (neither EXR nor RGBE), kFormatBroken, kNotFinite (a value is
// negative or not finite), kLimitExceeded (more than kMostRadiancePixels, or no memory).
Result<RadianceMap> ReadRadianceMap(const std::string& path);

// Decode the bytes of a file. `path` names the file in error messages. The functions do not check law 2. Errors:
// kFormatBroken, kLimitExceeded.
Result<RadianceMap> DecodeExr(const std::string& path, const std::vector<unsigned char>& bytes);
Result<RadianceMap> DecodeRgbe(const std::string& path, const std::vector<unsigned char>& bytes);

}  // namespace facetless
