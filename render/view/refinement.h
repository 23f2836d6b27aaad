// Adaptive supersampling: which pixels of a view are traced again with several samples, and their samples.
//
//     PixelSet pixels(camera.width_px, camera.height_px);
//     pixels.Add(column, row);
//     pixels.Finish();
//     for (std::size_t k = 0; k < pixels.size(); ++k) Visit(pixels.pixels()[k]);  // Rank of that pixel: k
//
//  1. Every view is traced through its pixel centres first. A PixelPicker then names the pixels in which the
//     centre alone does not determine the colour; only those are traced with a grid of samples.
//  2. The grid of a pixel is that of Camera::Supersampled: sample (i, j) of pixel (column, row) is the pixel
//     (column·grid.x + j, row·grid.y + i) of the supersampled camera.
//  3. The result depends only on the samples of the pixel centres, the grid and the representation, not on the
//     number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/view/camera.h"
#include "render/view/samples.h"

namespace facetless {

struct SampleGrid {
  int x = 1, y = 1;
  int count() const { return x * y; }
};
// The most even factorisation of the number of samples: 4 → 2×2, 8 → 4×2, 7 → 7×1.
SampleGrid EvenSampleGrid(int samples);

// A set of pixels of an image, in which the members are numbered.
class PixelSet {
 public:
  PixelSet(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  void Add(int column, int row) { Word(column, row) |= std::uint64_t{1} << (column & 63); }
  bool Has(int column, int row) const { return Word(column, row) >> (column & 63) & 1; }
  // Returns whether the set has a pixel in [column, column_end) × [row, row_end); the range may exceed the image.
  bool HasAnyIn(int column, int column_end, int row, int row_end) const;
  // Adds all pixels of a set of the same size.
  void Add(const PixelSet& other);

  // Numbers the members, row by row. Required before the functions below, and again after an Add.
  void Finish();
  std::size_t size() const { return pixels_.size(); }
  // row·width + column of each member, ascending.
  std::span<const std::uint32_t> pixels() const { return pixels_; }
  // The index of a member in pixels().
  std::uint32_t Rank(int column, int row) const;

 private:
  std::size_t WordIndex(int column, int row) const {
    return static_cast<std::size_t>(row) * stride_ + static_cast<std::size_t>(column >> 6);
  }
  std::uint64_t& Word(int column, int row) { return words_[WordIndex(column, row)]; }
  std::uint64_t Word(int column, int row) const { return words_[WordIndex(column, row)]; }

  int width_, height_;
  std::size_t stride_;  // words per row
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;  // number of members before each word
  std::vector<std::uint32_t> pixels_;
};

// Chooses the pixels of a view that are traced with several samples.
class PixelPicker {
 public:
  virtual ~PixelPicker() = default;
  // Adds pixels to `set`, which may have members already. `centres` are the samples of the pixel centres.
  virtual void Pick(const SampleBuffer& centres, const CameraFrame& frame, PixelSet* set) = 0;
};

// What a tracer is asked to refine.
struct RefineRequest {
  SampleGrid grid;
  PixelPicker* picker = nullptr;
  // If true, secondary rays start from the samples: the tracer fills uv, depth_error and certificate, if it has them.
  bool ray_starts = false;
};

// The samples of the pixels that were traced again.
struct Refinement {
  SampleGrid grid;
  CameraFrame frame;  // of the supersampled camera
  PixelSet pixels;
  SampleBuffer samples;  // one row per pixel of `pixels`; a row holds the pixel's samples, row by row
};

// The coordinates of sample `k` of a pixel (row·width + column) in the supersampled image.
struct SamplePlace {
  int column, row;
};
inline SamplePlace PlaceOfSample(std::uint32_t pixel, int width, SampleGrid grid, int k) {
  const int column = static_cast<int>(pixel % static_cast<std::uint32_t>(width)),
            row = static_cast<int>(pixel / static_cast<std::uint32_t>(width));
  return {column * grid.x + k % grid.x, row * grid.y + k / grid.x};
}

}  // namespace facetless
