#include "render/image/film.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "render/base/parallel.h"

namespace facetless {
namespace {

// The n-th root of 0 < a <= 1 by Newton's method, with the same rounding on every machine. From 1, the
// iterates decrease until rounding stops them.
double Root(double a, int n) {
  double y = 1;
  for (;;) {
    double power = 1;
    for (int k = 1; k < n; ++k) power *= y;
    const double next = y + (a / power - y) / n;
    if (!(next < y)) return y;
    y = next;
  }
}

// The thresholds of sRGB encoding: byte k stands for linear light from threshold[k − 1] up to threshold[k].
struct Thresholds {
  static constexpr int kCells = 4096;
  std::array<float, 256> threshold;              // the last one is beyond every number
  std::array<std::uint8_t, kCells + 1> at_cell;  // the byte at the beginning of a cell of 1/4096

  Thresholds() {
    for (int k = 0; k < 255; ++k) threshold[k] = static_cast<float>(SrgbToLinear((k + 0.5) / 255));
    threshold[255] = std::numeric_limits<float>::infinity();
    int byte = 0;
    for (int cell = 0; cell <= kCells; ++cell) {
      while (static_cast<float>(cell) / kCells >= threshold[byte]) ++byte;
      at_cell[cell] = static_cast<std::uint8_t>(byte);
    }
  }
};

const Thresholds& SharedThresholds() {
  static const Thresholds thresholds;
  return thresholds;
}

}  // namespace

double SrgbToLinear(double encoded) {
  const double e = std::clamp(encoded, 0.0, 1.0);
  if (e <= 0.04045) return e / 12.92;
  // ((e + 0.055) / 1.055)^2.4
  const double base = (e + 0.055) / 1.055;
  return base * base * Root(base * base, 5);
}

double LinearToSrgb(double linear) {
  const double l = std::clamp(linear, 0.0, 1.0);
  if (l <= 0.0031308) return 12.92 * l;
  // 1.055 · l^(5/12) − 0.055
  const double twelfth = std::sqrt(std::sqrt(Root(l, 3)));
  const double square = twelfth * twelfth;
  return 1.055 * (square * square * twelfth) - 0.055;
}

std::uint8_t EncodeByte(float linear) {
  const Thresholds& table = SharedThresholds();
  const float l = std::clamp(linear, 0.0f, 1.0f);
  int byte = table.at_cell[static_cast<int>(l * Thresholds::kCells)];
  while (l >= table.threshold[byte]) ++byte;
  return static_cast<std::uint8_t>(byte);
}

Result<Film> Resolve(Film samples, int samples_x, int samples_y) {
  if (samples_x < 1 || samples_y < 1 || samples.width % samples_x != 0 || samples.height % samples_y != 0)
    return Error{ErrorCode::kSizeMismatch, std::to_string(samples.width) + "×" +
                                               std::to_string(samples.height) +
                                               " samples do not make whole pixels of " +
                                               std::to_string(samples_x) + "×" + std::to_string(samples_y)};
  if (samples_x == 1 && samples_y == 1) return samples;
  Film film;
  film.width = samples.width / samples_x;
  film.height = samples.height / samples_y;
  film.pixels.resize(static_cast<std::size_t>(film.width) * film.height);
  const float share = 1.0f / static_cast<float>(samples_x * samples_y);
  ParallelFor(0, film.height, [&](int y) {
    for (int x = 0; x < film.width; ++x) {
      std::array<float, 4> sum = {0, 0, 0, 0};
      for (int j = 0; j < samples_y; ++j)
        for (int i = 0; i < samples_x; ++i) {
          const std::size_t row = static_cast<std::size_t>(y) * samples_y + j;
          const auto& sample =
              samples.pixels[row * samples.width + static_cast<std::size_t>(x) * samples_x + i];
          for (int c = 0; c < 4; ++c) sum[c] += sample[c];
        }
      for (float& c : sum) c *= share;
      film.pixels[static_cast<std::size_t>(y) * film.width + x] = sum;
    }
  });
  return film;
}

namespace {

// Returns whether each of `count` numbers is finite.
bool AllFinite(const float* numbers, std::size_t count) {
  constexpr std::uint32_t kExponent = 0x7f800000;
  bool found = false;
  for (std::size_t i = 0; i < count; ++i)
    found |= (std::bit_cast<std::uint32_t>(numbers[i]) & kExponent) == kExponent;
  return !found;
}

// The first pixel of [first, last) with a number that is not finite; `last` if there is none.
std::size_t FindBadPixel(const Film& film, std::size_t first, std::size_t last) {
  if (AllFinite(film.pixels[first].data(), 4 * (last - first))) return last;
  while (AllFinite(film.pixels[first].data(), 4)) ++first;
  return first;
}

}  // namespace

Result<Image8> Encode(const Film& film) {
  // Refuse values that are not finite, and find out whether any pixel is transparent.
  constexpr std::size_t kBlock = 4096;
  std::atomic<std::size_t> bad{film.pixels.size()};
  std::atomic<bool> opaque{true};
  ParallelForBlocks(0, film.pixels.size(), kBlock, [&](std::size_t first, std::size_t last) {
    const std::size_t found = FindBadPixel(film, first, last);
    std::size_t known = bad.load();
    while (found < last && found < known && !bad.compare_exchange_weak(known, found)) {
    }
    float least = 1;
    for (std::size_t i = first; i < last; ++i) least = std::min(least, film.pixels[i][3]);
    if (least < 1) opaque = false;
  });
  if (bad < film.pixels.size())
    return Error{ErrorCode::kNotFinite, "pixel (" + std::to_string(bad % film.width) + ", " +
                                            std::to_string(bad / film.width) + ") of a film is not a number"};

  Image8 image;
  image.width = film.width;
  image.height = film.height;
  const int channels = image.channels = opaque ? 3 : 4;
  image.bytes.resize(film.pixels.size() * channels);
  ParallelForBlocks(0, film.pixels.size(), kBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto& pixel = film.pixels[i];
      std::uint8_t* out = &image.bytes[i * channels];
      // Neighbouring pixels of the background are mostly equal.
      if (i > first && pixel == film.pixels[i - 1]) {
        std::copy_n(out - channels, channels, out);
        continue;
      }
      const float alpha = std::clamp(pixel[3], 0.0f, 1.0f);
      for (int c = 0; c < 3; ++c) out[c] = alpha > 0 ? EncodeByte(pixel[c] / alpha) : 0;
      if (channels == 4) out[3] = static_cast<std::uint8_t>(alpha * 255.0f + 0.5f);
    }
  });
  return image;
}

}  // namespace facetless
