// The flattening and the bounding volume hierarchy of W. Martin, E. Cohen, R. Fish and P. Shirley, "Practical
// Ray Tracing of Trimmed NURBS Surfaces" (2000), for the patches of a scene.
//
//  1. Each patch is divided along u and v until each piece is nearly flat: n = C·max|c''|·(Δt)^(3/2) /
//     avg|c'|^(1/2) pieces, the maximum over the rows of its control net. This bounds the curvature times the
//     arc length to the power 3/2. A piece has a parameter rectangle, in whose middle Newton's iteration
//     starts, and the box of its own control net, which contains it.
//  2. The pieces of a patch form a binary tree, halved alternately along u and v. Above, patches are grouped
//     by halving along the longest side of the box around their boxes' centres.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/patch_scene.h"
#include "render/base/vec.h"

namespace facetless {

// The paper's constant C, for lengths in millimetres. Newton's iteration needs two or three steps on such
// pieces, as in the paper.
inline constexpr double kFlattening = 1;

struct PatchPiece {
  std::uint32_t patch = 0;
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  Box3 box;
};

struct PatchTreeNode {
  Box3 box;
  std::uint32_t first = 0;  // inner node: the left child, which the right one follows; leaf node: the piece
  bool leaf = false;
};

struct PatchTree {
  std::vector<PatchPiece> pieces;
  std::vector<PatchTreeNode> nodes;  // the root is the first
  std::size_t bytes() const {
    return pieces.size() * sizeof(PatchPiece) + nodes.size() * sizeof(PatchTreeNode);
  }
};

PatchTree BuildPatchTree(const std::vector<ScenePatch>& patches, double flattening);

// Replaces the boxes of the tree by those of the same pieces of other patches, for example the projected
// ones.
void ReplaceBoxes(PatchTree& tree, const std::vector<ScenePatch>& projected);

}  // namespace facetless
