// The leaf splitter's limit of work: the rest of a patch is listed as given up, and nothing is dropped.
#include "render/nurbs/leaf_splitter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/kernels/net_kernel.h"

namespace facetless {
namespace {

constexpr int kSize = 64;

// A sheet over the whole window that is curved too much for one leaf.
LeafLists LeavesOfASheet(std::uint64_t max_nodes, CoefficientArena* arena) {
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
  LeafLists leaves;
  splitter.Split(patch, &leaves, nullptr, arena);
  return leaves;
}

bool Holds(const LeafLists& leaves, int column, int row) {
  const auto holds = [&](const LeafHeader& leaf) { return leaf.box.Holds(column, row); };
  return std::ranges::any_of(leaves.certified, holds) || std::ranges::any_of(leaves.hard, holds);
}

TEST(LeafSplitter, GivesUpByNameAndDropsNothing) {
  CoefficientArena arena;
  const LeafLists whole = LeavesOfASheet(1 << 20, &arena);
  ASSERT_GT(whole.spans().size(), 100u);
  const auto is_given_up = [](const HardLeaf& leaf) { return leaf.kind == HardKind::kGivenUp; };
  EXPECT_TRUE(std::ranges::none_of(whole.hard, is_given_up));
  for (const std::uint64_t max_nodes : {1u, 2u, 7u, 30u, 100u}) {
    const LeafLists limited = LeavesOfASheet(max_nodes, &arena);
    const auto given_up = std::ranges::count_if(limited.hard, is_given_up);
    EXPECT_GT(given_up, 0) << max_nodes;
    EXPECT_LE(limited.spans().size(), max_nodes + 65);
    for (int row = 0; row < kSize; ++row)
      for (int column = 0; column < kSize; ++column)
        if (Holds(whole, column, row)) {
          ASSERT_TRUE(Holds(limited, column, row)) << max_nodes;
        }
  }
}

// The places of leaves say which part of the patch each one covers: together they cover the whole patch,
// without overlap.
TEST(LeafSplitter, PlacesOfLeavesTileThePatch) {
  CoefficientArena arena;
  const LeafLists leaves = LeavesOfASheet(1 << 20, &arena);
  ASSERT_EQ(leaves.places.size(), leaves.certified.size());
  std::vector<LeafPlace> places = leaves.places;
  for (const HardLeaf& leaf : leaves.hard) places.push_back(leaf.place);
  double area = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const ParameterRect a = RectOf(places[i], {});
    area += a.u_half * a.v_half * 4;
    EXPECT_EQ(i < leaves.places.size() ? leaves.certified[i].borders
                                       : leaves.hard[i - leaves.places.size()].borders,
              BordersOf(a));
    for (std::size_t k = 0; k < i; ++k) {
      const ParameterRect b = RectOf(places[k], {});
      EXPECT_TRUE(std::fabs(a.u_mid - b.u_mid) >= a.u_half + b.u_half ||
                  std::fabs(a.v_mid - b.v_mid) >= a.v_half + b.v_half);
    }
  }
  // Pieces beside the window or between the sample centres have no leaf.
  EXPECT_LE(area, 1);
  EXPECT_GT(area, 0.5);
}

// The limit must not affect a sound patch: it allows more pieces than there are samples, for all degrees.
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
