#include "render/compare/pixel_data.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "render/base/parallel.h"

namespace facetless {
namespace {

constexpr std::uint32_t kMost24 = (1u << 24) - 1;
// The step of rounding is the mesh's noise divided by this: finer steps would only store the noise.
constexpr double kNoiseSteps = 8;
// The number of bits to drop of the 24 significant bits of a float32.
constexpr int kDroppedBits = 24 - 13, kReducedDroppedBits = 24 - 8;

void Put(Image8& image, std::size_t pixel, std::uint32_t value) {
  std::uint8_t* bytes = &image.bytes[3 * pixel];
  bytes[0] = static_cast<std::uint8_t>(value >> 16);
  bytes[1] = static_cast<std::uint8_t>(value >> 8);
  bytes[2] = static_cast<std::uint8_t>(value);
}

std::uint32_t Get(const std::uint8_t* bytes) {
  return std::uint32_t(bytes[0]) << 16 | std::uint32_t(bytes[1]) << 8 | bytes[2];
}

// Returns the bits of the nearest float whose last `dropped` bits are zero. A carry into the exponent gives
// the correct result.
std::uint32_t RoundedBits(float value, int dropped) {
  const std::uint32_t half = 1u << (dropped - 1);
  return (std::bit_cast<std::uint32_t>(value) + half) & ~((1u << dropped) - 1);
}

// Maps the unit sphere onto a square by the octahedral mapping (division by the 1-norm).
std::uint32_t NormalCode(const std::array<float, 3>& normal) {
  const double x = normal[0], y = normal[1], z = normal[2];
  const double sum = std::fabs(x) + std::fabs(y) + std::fabs(z);
  if (!(sum > 0)) return 0;
  double u = x / sum, v = y / sum;
  if (z < 0) {
    const double folded_u = std::copysign(1 - std::fabs(v), u), folded_v = std::copysign(1 - std::fabs(u), v);
    u = folded_u;
    v = folded_v;
  }
  const auto code = [](double t) { return static_cast<std::uint32_t>(std::lround((t + 1) / 2 * 4095)); };
  return code(u) << 12 | code(v);
}

PixelClass ClassOf(bool direct, bool baseline, bool border) {
  if (direct && baseline) return border ? PixelClass::kBorder : PixelClass::kMeasured;
  if (direct) return PixelClass::kOnlySurface;
  return baseline ? PixelClass::kOnlyMesh : PixelClass::kNothing;
}

bool Hit(const SampleBuffer& samples, std::size_t i) {
  return samples.depth[i] != INFINITY;
}

Result<void> Check(const SampleBuffer& direct, const SampleBuffer& baseline) {
  if (direct.width != baseline.width || direct.height != baseline.height ||
      direct.certificate.size() != direct.size())
    return Error{ErrorCode::kSizeMismatch, "pixel data: the views have different sizes"};
  for (std::size_t i = 0; i < direct.size(); ++i) {
    const bool both = Hit(direct, i) && Hit(baseline, i);
    const double apart = both ? baseline.depth[i] - direct.depth[i] : 0;
    const bool sound = (!Hit(direct, i) || std::isfinite(direct.depth[i])) &&
                       std::fabs(apart) <= std::numeric_limits<float>::max();
    if (!sound) return Error{ErrorCode::kNotFinite, "pixel data: no number at pixel " + std::to_string(i)};
  }
  return {};
}

}  // namespace

const char* PixelPlaneName(PixelPlane plane) {
  constexpr const char* kNames[] = {"pixel-faces", "pixel-depths", "pixel-normals", "pixel-deviation",
                                    "pixel-status"};
  return kNames[static_cast<int>(plane)];
}

double SignedDeviation(const SampleBuffer& direct, const SampleBuffer& baseline, const CameraFrame& frame,
                       std::size_t pixel) {
  const Ray ray = PixelRay(frame, static_cast<double>(pixel % direct.width) + 0.5,
                           static_cast<double>(pixel / direct.width) + 0.5);
  const auto& n = direct.normal[pixel];
  return (baseline.depth[pixel] - direct.depth[pixel]) *
         std::fabs(Dot(Vec3{n[0], n[1], n[2]}, ray.direction));
}

Result<PixelData> MakePixelData(const SampleBuffer& direct, const SampleBuffer& baseline,
                                const CameraFrame& frame, bool faces_known, double noise_mm) {
  if (auto sound = Check(direct, baseline); !sound) return sound.error();
  PixelData data;
  for (Image8& plane : data.planes) {
    plane.width = direct.width;
    plane.height = direct.height;
    plane.bytes.assign(3 * direct.size(), 0);
  }
  const auto plane = [&](PixelPlane which) -> Image8& { return data.planes[static_cast<int>(which)]; };

  // Find the range of the depths.
  double near = INFINITY, far = -INFINITY;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    if (!Hit(direct, i)) continue;
    near = std::min(near, direct.depth[i]);
    far = std::max(far, direct.depth[i]);
  }
  if (near <= far) {
    data.near_mm = near;
    data.far_mm = far;
  }
  const double per_mm = far > near ? (kMost24 - 1) / (far - near) : 0;

  const std::vector<std::uint8_t> border = BorderPixels(direct, baseline, frame, faces_known);
  const double step = noise_mm / kNoiseSteps;
  ParallelFor(0, direct.height, [&](int y) {
    const std::size_t first = static_cast<std::size_t>(y) * direct.width;
    for (std::size_t i = first; i < first + direct.width; ++i) {
      const bool hit = Hit(direct, i), both = hit && Hit(baseline, i);
      std::uint8_t* status = &plane(PixelPlane::kStatus).bytes[3 * i];
      status[0] = static_cast<std::uint8_t>(ClassOf(hit, Hit(baseline, i), border[i] != 0));
      status[1] = static_cast<std::uint8_t>(direct.certificate[i]);
      status[2] = both && faces_known && direct.face[i] != baseline.face[i];
      if (!hit) continue;
      Put(plane(PixelPlane::kFaces), i, std::min(direct.face[i], kMost24 - 1) + 1);
      Put(plane(PixelPlane::kDepths), i,
          1 + static_cast<std::uint32_t>(std::llround((direct.depth[i] - near) * per_mm)));
      Put(plane(PixelPlane::kNormals), i, NormalCode(direct.normal[i]));
      if (!both) continue;
      const double apart = SignedDeviation(direct, baseline, frame, i);
      const double rounded = step > 0 ? std::round(apart / step) * step : apart;
      Put(plane(PixelPlane::kDeviation), i, RoundedBits(static_cast<float>(rounded), kDroppedBits) >> 8);
    }
  });
  return data;
}

Image8 ReducedPlane(PixelPlane plane, const Image8& image, int stride) {
  Image8 reduced;
  reduced.width = (image.width + stride - 1) / stride;
  reduced.height = (image.height + stride - 1) / stride;
  reduced.bytes.resize(std::size_t(3) * reduced.width * reduced.height);
  for (int y = 0; y < reduced.height; ++y) {
    for (int x = 0; x < reduced.width; ++x) {
      const int from_x = std::min(x * stride + stride / 2, image.width - 1);
      const int from_y = std::min(y * stride + stride / 2, image.height - 1);
      std::uint32_t value = Get(image.at(from_x, from_y));
      if (plane == PixelPlane::kDepths && value > 0) value = std::max(value & 0xffff00u, 1u);
      if (plane == PixelPlane::kNormals) value &= 0xff0ff0u;
      if (plane == PixelPlane::kDeviation)
        value = RoundedBits(std::bit_cast<float>(value << 8), kReducedDroppedBits) >> 8;
      Put(reduced, static_cast<std::size_t>(y) * reduced.width + x, value);
    }
  }
  return reduced;
}

}  // namespace facetless
