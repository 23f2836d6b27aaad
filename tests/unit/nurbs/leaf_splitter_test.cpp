// The leaf splitter's bound on work: what is left of a patch is given up by name, and nothing is dropped.
#include "render/nurbs/leaf_splitter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/kernels/net_kernel.h"

namespace facetless {
namespace {

constexpr int kSize = 64;

// A sheet over the whole window that bends too much for one leaf.
std::vector<Leaf> LeavesOfASheet(std::uint64_t max_nodes, CoefficientArena* arena) {
  SplitWindow window;
  window.half_width = window.half_height = kSize / 2;
  window.nets = &kernel_scalar::kNets;
  SplitBudget budget;
  budget.bytes_left = std::int64_t{1} << 30;
  LeafSplitter splitter(window, &budget);
  BezierNet& net = splitter.Begin(3, 3);
  for (int k = 0; k <= 3; ++k) {
    for (int l = 0; l <= 3; ++l) {
      net.at(4 * k + l, kX) = -40 + 80.0 * k / 3 + 25 * std::sin(3.0 * l + k);
      net.at(4 * k + l, kY) = -40 + 80.0 * l / 3 + 25 * std::cos(2.0 * k + l);
      net.at(4 * k + l, kW) = 1;
      net.at(4 * k + l, kQ) = k + l;
    }
  }
  std::fill_n(net.error, int{kNetComponents}, 0.0);
  SplitPatch patch;
  patch.rule = {false, false, true};
  patch.u_map = patch.v_map = SpanParameter(Span{});
  patch.trim_class = RectClass::kInside;
  patch.max_nodes = max_nodes;
  std::vector<Leaf> leaves;
  splitter.Split(patch, &leaves, arena);
  return leaves;
}

bool Holds(const std::vector<Leaf>& leaves, int column, int row) {
  return std::any_of(leaves.begin(), leaves.end(), [&](const Leaf& leaf) {
    return leaf.col_begin <= column && column < leaf.col_end && leaf.row_begin <= row && row < leaf.row_end;
  });
}

TEST(LeafSplitter, GivesUpByNameAndDropsNothing) {
  CoefficientArena arena;
  const std::vector<Leaf> whole = LeavesOfASheet(1 << 20, &arena);
  ASSERT_GT(whole.size(), 100u);
  for (const Leaf& leaf : whole) EXPECT_FALSE(leaf.flags & kLeafGivenUp);
  for (const std::uint64_t max_nodes : {1u, 2u, 7u, 30u, 100u}) {
    const std::vector<Leaf> limited = LeavesOfASheet(max_nodes, &arena);
    const auto given_up = std::count_if(limited.begin(), limited.end(),
                                        [](const Leaf& leaf) { return (leaf.flags & kLeafGivenUp) != 0; });
    EXPECT_GT(given_up, 0) << max_nodes;
    EXPECT_LE(limited.size(), max_nodes + 65);
    for (int row = 0; row < kSize; ++row)
      for (int column = 0; column < kSize; ++column)
        if (Holds(whole, column, row)) {
          ASSERT_TRUE(Holds(limited, column, row)) << max_nodes;
        }
  }
}

// No bound that a sound patch could meet: more pieces than samples, whatever the degrees.
TEST(LeafSplitter, AllowsMorePiecesThanThereAreSamples) {
  for (int degree_u = 1; degree_u <= kMaxDegree; ++degree_u) {
    for (int degree_v = 1; degree_v <= kMaxDegree; ++degree_v) {
      for (const double samples : {0.0, 1.0, 1e3, 1e6, 1e9})
        EXPECT_GT(NodeLimit(samples, degree_u, degree_v), 4 * samples);
    }
  }
}

}  // namespace
}  // namespace facetless
