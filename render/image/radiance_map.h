// Radiance maps: panoramas of the light that arrives from all directions, as EXR or as Radiance RGBE files (.hdr).
//
//     Result<RadianceMap> map = ReadRadianceMap("studio.hdr");
//     if (!map) return map.error();
//     const Vec3 light = map.value().At(0.25, 0.5);
//
//  1. The content decides the format, whatever the name of the file. Values are linear light; RGBE values are read as
//     red, green and blue of Rec. 709.
//  2. Values are finite and not negative: others are errors, since no picture may contain them.
//  3. A lookup interpolates between the four nearest pixels. It uses no libm function.
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

  // The light at x from left to right and y from top to bottom, both 0 … 1. The map continues at its left and right
  // borders; above and below it, the border counts.
  Vec3 At(double x, double y) const;
};

// Errors: kFileUnreadable, kFormatUnknown (neither EXR nor RGBE), kFormatBroken, kNotFinite, kLimitExceeded (more than
// kMostRadiancePixels).
Result<RadianceMap> ReadRadianceMap(const std::string& path);

// Decode the bytes of a file; `path` is its name in errors. Law 2 is not checked.
Result<RadianceMap> DecodeExr(const std::string& path, const std::vector<unsigned char>& bytes);
Result<RadianceMap> DecodeRgbe(const std::string& path, const std::vector<unsigned char>& bytes);

}  // namespace facetless
