// BlockTree: the pieces of a model as ray blocks (kernels/ray_blocks.h): thick parallelograms in blocks of eight, and a
// tree of boxes with eight children per node over them.
//
//     const auto make = [&](std::uint32_t id, Vec3 from, PieceShape* shape) { … };
//     std::optional<BlockTree> tree = BlockTree::Build(boxes, make);
//     if (tree) visit_blocks(tree->blocks(), ray, &visit);
//
//  1. The tree is made from a binary tree that is divided by the surface area heuristic (accel/bvh.h). Its nodes are
//     merged until each has up to eight children. A subtree of at most eight pieces becomes a block.
//  2. The values that the kernel requires (kernels/ray_blocks.h, laws 5 and 6) are computed here in double, from the
//     rounded rows.
//  3. Boxes are stored in single precision, relative to the scene's centre, and widened by kBoxMargin of its size, for
//     rays that start within twice its size of the centre.
//  4. A piece is open for every ray if it is too small or too far from the centre of its block for single precision, or
//     if its sides do not span a parallelogram.
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

// For a piece that is trimmed by a line, rays whose cosine with the piece's normal is below this do not use the line.
inline constexpr double kSteep = 1.0 / 8;

// The shape of a piece. Points are relative to the point `from` that MakeShape receives.
struct PieceShape {
  int degree_u = 1, degree_v = 1;
  std::vector<Vec3> points;  // control points, mm; v runs fastest
  double error = 0;          // the exact piece lies within this distance of that of the control points, mm
  TrimLine line;             // in the piece's native parameters
  bool steep_only = false;   // the line holds only for rays whose cosine with the normal is at least kSteep
  // Bounds of the difference between the native parameter and s or t, in units in which the piece runs from −1 to 1.
  // The parameters differ if weights vary, or if the native parameter is an angle.
  double uneven_s = 0, uneven_t = 0;
};

class BlockTree {
 public:
  using MakeShape = std::function<void(std::uint32_t id, Vec3 from, PieceShape* shape)>;

  // Builds the tree over boxes, each of which holds its piece. Returns nothing if the tree is too deep for the kernel's
  // stack.
  static std::optional<BlockTree> Build(std::span<const Box3> boxes, const MakeShape& make);

  // The result is valid until this object is moved or destroyed.
  RayBlocks blocks() const;
  // Whether a ray may start at this point (law 3).
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
