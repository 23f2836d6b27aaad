#include "render/shade/contrast.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/base/parallel.h"

namespace facetless {
namespace {

constexpr int kChannels = 4;

// The row of a film as it is compared: kChannels numbers per pixel, with one more pixel at each end.
void LoadRow(const Film& film, int row, std::vector<float>* out) {
  const int clamped = std::clamp(row, 0, film.height - 1);
  const float* from = film.pixels[static_cast<std::size_t>(clamped) * film.width].data();
  float* to = out->data() + kChannels;
  const int count = kChannels * film.width;
  for (int k = 0; k < count; ++k) {
    const float light = from[k] > 0 ? from[k] : 0;
    to[k] = std::sqrt(light);
  }
  std::copy_n(to, kChannels, out->data());
  std::copy_n(to + count - kChannels, kChannels, to + count);
}

// For each number of the row `here`, the largest difference between twice itself and the sum of two opposite
// neighbours.
void FindBends(const std::vector<float>& above, const std::vector<float>& here,
               const std::vector<float>& below, std::vector<float>* bends) {
  const int count = static_cast<int>(bends->size());
  const float *a = above.data(), *h = here.data(), *b = below.data();
  float* out = bends->data();
  for (int k = 0; k < count; ++k) {
    constexpr int kLeft = 0, kMiddle = kChannels, kRight = 2 * kChannels;
    const float twice = 2 * h[k + kMiddle];
    const float row = std::fabs(h[k + kLeft] + h[k + kRight] - twice),
                column = std::fabs(a[k + kMiddle] + b[k + kMiddle] - twice),
                falling = std::fabs(a[k + kLeft] + b[k + kRight] - twice),
                rising = std::fabs(a[k + kRight] + b[k + kLeft] - twice);
    const float straight = row > column ? row : column, diagonal = falling > rising ? falling : rising;
    out[k] = straight > diagonal ? straight : diagonal;
  }
}

}  // namespace

void AddContrast(const Film& film, PixelSet* pixels) {
  constexpr std::size_t kRows = 32;
  ParallelForBlocks(0, static_cast<std::size_t>(film.height), kRows,
                    [&](std::size_t first, std::size_t last) {
                      const auto width = static_cast<std::size_t>(film.width);
                      std::vector<float> above(kChannels * (width + 2)), here(above.size()),
                          below(above.size()), bends(kChannels * width);
                      LoadRow(film, static_cast<int>(first) - 1, &above);
                      LoadRow(film, static_cast<int>(first), &here);
                      for (std::size_t row = first; row < last; ++row) {
                        LoadRow(film, static_cast<int>(row) + 1, &below);
                        FindBends(above, here, below, &bends);
                        for (std::size_t x = 0; x < width; ++x) {
                          const float* bend = bends.data() + kChannels * x;
                          if (std::max(std::max(bend[0], bend[1]), std::max(bend[2], bend[3])) > kMostBend)
                            pixels->Add(static_cast<int>(x), static_cast<int>(row));
                        }
                        above.swap(here);
                        here.swap(below);
                      }
                    });
}

}  // namespace facetless
