// Pixel sets against a plain set, for widths on both sides of a word.
#include "render/view/refinement.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <utility>

namespace facetless {
namespace {

TEST(SampleGrid, IsAsEvenAsItCanBe) {
  for (int samples = 1; samples <= 64; ++samples) {
    const SampleGrid grid = EvenSampleGrid(samples);
    EXPECT_EQ(grid.count(), samples);
    EXPECT_GE(grid.x, grid.y);
    for (int y = grid.y + 1; y * y <= samples; ++y) EXPECT_NE(samples % y, 0);
  }
  EXPECT_EQ(EvenSampleGrid(8).x, 4);
  EXPECT_EQ(EvenSampleGrid(7).y, 1);
}

TEST(PixelSet, HoldsWhatIsAddedAndNumbersIt) {
  std::mt19937 random(5);
  for (int width = 1; width <= 200; ++width) {
    const int height = 1 + static_cast<int>(random() % 9);
    const auto any = [&](int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); };
    PixelSet set(width, height), other(width, height);
    std::set<std::pair<int, int>> expected;  // row, column
    for (int k = any(2 * width); k > 0; --k) {
      const int column = any(width), row = any(height);
      (k % 2 ? set : other).Add(column, row);
      expected.insert({row, column});
    }
    set.Add(other);
    set.Finish();
    ASSERT_EQ(set.size(), expected.size());
    std::uint32_t rank = 0;
    for (const auto& [row, column] : expected) {
      EXPECT_TRUE(set.Has(column, row));
      EXPECT_EQ(set.pixels()[rank], static_cast<std::uint32_t>(row * width + column));
      EXPECT_EQ(set.Rank(column, row), rank++);
    }
    for (int k = 0; k < 50; ++k) {
      const int column = any(width + 4) - 2, row = any(height + 4) - 2, column_end = column + any(width + 2),
                row_end = row + any(height + 2);
      bool has = false;
      for (const auto& [i, j] : expected) has |= column <= j && j < column_end && row <= i && i < row_end;
      EXPECT_EQ(set.HasAnyIn(column, column_end, row, row_end), has);
    }
  }
}

TEST(PixelSet, PlacesSamplesRowByRow) {
  const SampleGrid grid{3, 2};
  const SamplePlace first = PlaceOfSample(/*pixel=*/27, /*width=*/10, grid, 0),
                    last = PlaceOfSample(27, 10, grid, 5);
  EXPECT_EQ(first.column, 21);
  EXPECT_EQ(first.row, 4);
  EXPECT_EQ(last.column, 23);
  EXPECT_EQ(last.row, 5);
}

}  // namespace
}  // namespace facetless
