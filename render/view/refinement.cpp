#include "render/view/refinement.h"

#include <algorithm>
#include <bit>

namespace facetless {

SampleGrid EvenSampleGrid(int samples) {
  SampleGrid grid{samples, 1};
  for (int y = 1; y * y <= samples; ++y)
    if (samples % y == 0) grid = {samples / y, y};
  return grid;
}

PixelSet::PixelSet(int width, int height)
    : width_(width),
      height_(height),
      stride_((static_cast<std::size_t>(width) + 63) / 64),
      words_(stride_ * static_cast<std::size_t>(height)) {}

bool PixelSet::HasAnyIn(int column, int column_end, int row, int row_end) const {
  column = std::max(column, 0);
  row = std::max(row, 0);
  column_end = std::min(column_end, width_);
  row_end = std::min(row_end, height_);
  if (column >= column_end) return false;
  const std::size_t first = static_cast<std::size_t>(column >> 6),
                    last = static_cast<std::size_t>((column_end - 1) >> 6);
  const std::uint64_t from = ~std::uint64_t{0} << (column & 63),
                      until = ~std::uint64_t{0} >> (63 - ((column_end - 1) & 63));
  for (int i = row; i < row_end; ++i) {
    const std::uint64_t* words = words_.data() + static_cast<std::size_t>(i) * stride_;
    for (std::size_t k = first; k <= last; ++k) {
      std::uint64_t word = words[k];
      if (k == first) word &= from;
      if (k == last) word &= until;
      if (word != 0) return true;
    }
  }
  return false;
}

void PixelSet::Add(const PixelSet& other) {
  for (std::size_t k = 0; k < words_.size(); ++k) words_[k] |= other.words_[k];
}

void PixelSet::Finish() {
  before_.resize(words_.size());
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < words_.size(); ++k) {
    before_[k] = count;
    count += static_cast<std::uint32_t>(std::popcount(words_[k]));
  }
  pixels_.clear();
  pixels_.reserve(count);
  for (std::size_t k = 0; k < words_.size(); ++k) {
    const std::size_t row = k / stride_, column = k % stride_ * 64;
    for (std::uint64_t rest = words_[k]; rest != 0; rest &= rest - 1)
      pixels_.push_back(static_cast<std::uint32_t>(row * static_cast<std::size_t>(width_) + column +
                                                   static_cast<std::size_t>(std::countr_zero(rest))));
  }
}

std::uint32_t PixelSet::Rank(int column, int row) const {
  const std::uint64_t below = Word(column, row) & ((std::uint64_t{1} << (column & 63)) - 1);
  return before_[WordIndex(column, row)] + static_cast<std::uint32_t>(std::popcount(below));
}

}  // namespace facetless
