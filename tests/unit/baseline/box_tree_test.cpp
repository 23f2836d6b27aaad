#include "render/baseline/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace facetless {
namespace {

struct Visited {
  std::vector<std::uint32_t> boxes;
  double nearest = INFINITY;
  std::uint32_t hit_at = 0xffffffffu;  // the box that reports a hit, at `hit_depth`
  double hit_depth = 0;
};

double VisitBox(void* context, std::uint32_t box) {
  auto& visited = *static_cast<Visited*>(context);
  visited.boxes.push_back(box);
  if (box == visited.hit_at) visited.nearest = visited.hit_depth;
  return visited.nearest;
}

std::vector<ScreenBox> RandomScreenBoxes(int count, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<ScreenBox> boxes;
  for (int i = 0; i < count; ++i) {
    const int column = static_cast<int>(engine() % 200), row = static_cast<int>(engine() % 200);
    boxes.push_back({column, column + 1 + static_cast<int>(engine() % 30), row,
                     row + 1 + static_cast<int>(engine() % 30),
                     1e4 + static_cast<double>(engine() % 1000) / 7});
  }
  return boxes;
}

TEST(BoxTree, VisitsExactlyTheBoxesThatHoldThePixel) {
  constexpr std::uint64_t kSeed = 3;
  const std::vector<ScreenBox> boxes = RandomScreenBoxes(500, kSeed);
  const BoxTree tree = BoxTree::Build(boxes).value();
  EXPECT_GT(tree.bytes(), 0u);
  for (int row = 0; row < 230; row += 7)
    for (int column = 0; column < 230; column += 3) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        if (boxes[i].col_begin <= column && column < boxes[i].col_end && boxes[i].row_begin <= row &&
            row < boxes[i].row_end)
          expected.push_back(i);
      Visited visited;
      tree.Visit(column, row, &VisitBox, &visited);
      std::sort(visited.boxes.begin(), visited.boxes.end());
      ASSERT_EQ(visited.boxes, expected) << column << " " << row;
    }
}

TEST(BoxTree, NeverLeavesOutWhatMayBeNearerThanTheHit) {
  // These depths are far from the origin, and float32 cannot distinguish them.
  std::vector<ScreenBox> boxes;
  for (int i = 0; i < 64; ++i) boxes.push_back({0, 4, 0, 4, 1e6 + i * 1e-9});
  const BoxTree tree = BoxTree::Build(boxes).value();
  for (const std::uint32_t hit : {0u, 31u, 63u}) {
    Visited visited;
    visited.hit_at = hit;
    visited.hit_depth = boxes[hit].near_depth;
    tree.Visit(1, 2, &VisitBox, &visited);
    for (std::uint32_t i = 0; i <= hit; ++i)
      EXPECT_EQ(std::count(visited.boxes.begin(), visited.boxes.end(), i), 1) << i << " of " << hit;
  }
}

TEST(BoxTree, LeavesOutWhatBeginsBehindTheHit) {
  std::vector<ScreenBox> boxes;
  for (int i = 0; i < 1000; ++i) boxes.push_back({0, 4, 0, 4, 100.0 * i});
  const BoxTree tree = BoxTree::Build(boxes).value();
  Visited visited;
  visited.hit_at = 0;
  visited.hit_depth = 50;
  tree.Visit(1, 2, &VisitBox, &visited);
  EXPECT_LT(visited.boxes.size(), 100u);
}

TEST(BoxTree, NeedsABox) {
  const Result<BoxTree> tree = BoxTree::Build({});
  ASSERT_FALSE(tree.ok());
  EXPECT_EQ(tree.error().code, ErrorCode::kNothingUsable);
}

}  // namespace
}  // namespace facetless
