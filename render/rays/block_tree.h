// BlockTree: the pieces of a model as ray blocks (kernels/ray_blocks.h): thick parallelograms in blocks of eight, and a
// tree of boxes with eight children per node over them.
//
//     std::optional<BlockTree> tree = BlockTree::Build(boxes, center, [&](std::uint32_t id, Vec3 from) { … });
//     visit_blocks(tree->blocks(), ray, &visit);
//
//  1. The tree is a binary one, divided by the surface area heuristic (accel/bvh.h), of which nodes are merged until
//     each has up to eight children. A subtree of at most eight pieces is a block.
//  2. What the kernel requires of rows, margins and h (kernels/ray_blocks.h, laws 5 and 6) is computed here in double,
//     from the rounded rows.
//  3. Boxes are stored in single precision, relative to the scene's centre, and widened by kBoxMargin of its size, for
//     rays that start within twice its size of the centre.
//  4. A piece that single precision cannot tell from its neighbours, or that has no two sides, is open for every ray.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "render/accel/bvh.h"
#include "render/base/vec.h"
#include "render/kernels/ray_blocks.h"
#include "render/nurbs/trim_index.h"

namespace facetless {

// Where a piece is trimmed by a line, rays whose cosine with the piece's normal is below this are open.
inline constexpr double kSteep = 1.0 / 8;

// A piece as its maker describes it, relative to the point `from` that it is asked for.
struct PieceShape {
  int degree_u = 1, degree_v = 1;
  std::vector<Vec3> points;  // control points, v runs fastest
  double error = 0;  // the piece's own points are within this distance of those of these control points, mm
  TrimLine line;     // in the piece's native parameters
  bool steep_only = false;  // the line holds for rays within kSteep of the normal only
  // By how much the surface's parameter may differ from that of these control points, at the same s or t: weights that
  // vary, and native parameters that are angles.
  double uneven_s = 0, uneven_t = 0;
};

class BlockTree {
 public:
  using MakeShape = std::function<void(std::uint32_t id, Vec3 from, PieceShape* shape)>;

  // Builds the tree over boxes, each of which holds its piece. Nothing if it is too deep for the kernel's stack.
  static std::optional<BlockTree> Build(std::span<const Box3> boxes, const MakeShape& make);

  // Valid as long as this object is, and is not moved.
  RayBlocks blocks() const;
  // Whether a ray may start there (law 3).
  bool Reaches(Vec3 start) const;
  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(RayNode) + blocks_.capacity() * sizeof(RayBlock);
  }

 private:
  class Builder;

  std::vector<RayNode> nodes_;
  std::vector<RayBlock> blocks_;
  Vec3 center_;
  double size_ = 0;  // half the longest side of the scene's box
};

}  // namespace facetless
