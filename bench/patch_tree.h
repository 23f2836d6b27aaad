// The flattening and the bounding volume hierarchy of W. Martin, E. Cohen, R. Fish and P. Shirley, "Practical
// Ray Tracing of Trimmed NURBS Surfaces" (2000), over the patches of a scene.
//
//  1. Each patch is cut into so many pieces along u and v that each is nearly flat: n = C·max|c''|·(Δt)^(3/2)
//     / avg|c'|^(1/2) over the rows of its control net, which bounds curvature times arc length to the power
//     3/2. A piece is a parameter rectangle, whose middle starts Newton's iteration, and the box of its own
//     control net, which holds it.
//  2. The pieces of a patch form a binary tree, halved along u and v by turns; patches are joined above by
//     halving along the longest side of their boxes' centres.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/patch_scene.h"
#include "render/base/vec.h"

namespace facetless {

// The paper's C, for lengths in millimetres: pieces on which Newton needs two or three steps, as it did
// there.
inline constexpr double kFlattening = 1;

struct PatchPiece {
  std::uint32_t patch = 0;
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  Box3 box;
};

struct PatchTreeNode {
  Box3 box;
  std::uint32_t first = 0;  // inner: the left child, the right one follows it; leaf: the piece
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

// The same tree with boxes of the same pieces of other patches: the first ones, projected.
void ReplaceBoxes(PatchTree& tree, const std::vector<ScenePatch>& projected);

}  // namespace facetless
