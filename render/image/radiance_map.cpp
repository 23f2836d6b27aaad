#include "render/image/radiance_map.h"

#include <algorithm>
#include <cmath>

#include "render/image/codec.h"

namespace facetless {
namespace {

bool BeginsWith(const std::vector<unsigned char>& bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
}

}  // namespace

Vec3 RadianceMap::At(double x, double y) const {
  const double column = x * width - 0.5, row = std::clamp(y * height - 0.5, 0.0, height - 1.0);
  const double left = std::floor(column), top = std::floor(row);
  const double across = column - left, down = row - top;
  const auto wrapped = [&](double c) {
    const double turns = std::floor(c / width);
    return static_cast<std::size_t>(std::clamp(c - turns * width, 0.0, width - 1.0));
  };
  const auto pixel = [&](double c, double r) {
    const auto& p =
        pixels[static_cast<std::size_t>(std::min(r, height - 1.0)) * static_cast<std::size_t>(width) +
               wrapped(c)];
    return Vec3{p[0], p[1], p[2]};
  };
  const Vec3 upper = (1 - across) * pixel(left, top) + across * pixel(left + 1, top);
  const Vec3 lower = (1 - across) * pixel(left, top + 1) + across * pixel(left + 1, top + 1);
  return (1 - down) * upper + down * lower;
}

Result<RadianceMap> ReadRadianceMap(const std::string& path) {
  const Result<std::vector<unsigned char>> bytes = ReadImageBytes(path);
  if (!bytes.ok()) return bytes.error();
  constexpr std::string_view kExr = "\x76\x2f\x31\x01";
  const bool exr = BeginsWith(bytes.value(), kExr);
  if (!exr && !BeginsWith(bytes.value(), "#?"))
    return Error{
        ErrorCode::kFormatUnknown,
        path + " is neither an EXR file nor a Radiance file (.hdr); convert the panorama to one of them"};
  Result<RadianceMap> map = exr ? DecodeExr(path, bytes.value()) : DecodeRgbe(path, bytes.value());
  if (!map.ok()) return map;
  for (const auto& pixel : map.value().pixels)
    for (const float value : pixel)
      if (!(value >= 0 && std::isfinite(value)))
        return Error{ErrorCode::kNotFinite, path + ": the light of a pixel is negative or not finite"};
  return map;
}

}  // namespace facetless
