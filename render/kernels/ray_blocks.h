// Ray blocks: decide for most rays and most pieces of surface whether they meet, without solving for a root.
//
//     BlockVisit visit;
//     visit_blocks(tree.blocks(), ray, &visit);
//     if (!visit.blocked && visit.open_count == 0) ++clear;
//
// A piece of surface is enclosed in a thick parallelogram. Three affine functions of space, x, y and z, have |x| <= 1,
// |y| <= 1 and |z| <= h at all of its control points, and therefore on all of the piece. Along its four borders, the
// control points have x <= -inner_x, x >= inner_x, y <= -inner_y and y >= inner_y. For a ray o + tau·d in these
// coordinates, let tau0 = -o_z/d_z, k = h/|d_z|, and (x0, y0) = (o + tau0·d)_xy.
//
//  1. All roots have |tau - tau0| <= k, so |x| <= 1 implies |x0| <= 1 + k·|d_x|, and likewise for y. A ray for which
//     one of the two is false misses the piece, and so does one whose interval does not meet tau0 ± k.
//  2. Projected along d onto the plane z = 0, a border moves by at most k·(|d_x|, |d_y|). If |x0| < inner_x - k·|d_x|
//     and |y0| < inner_y - k·|d_y|, then each projected border stays on its own side of (x0, y0), and the whole border
//     winds once round (x0, y0), as that of the parallelogram does. A continuous image of a square whose border winds
//     round a point covers the point, so a root exists. If tau0 ± k lies within the ray's interval, the ray is blocked.
//  3. For a trimmed piece, a line a·x + b·y + c with a half width w divides the piece: where the value is above w, the
//     surface is in its face, and where it is below -w, the surface is trimmed away. At a root, the value differs by at
//     most k·(|a·d_x| + |b·d_y|) from that at (x0, y0). A piece that is not trimmed has a = b = 0 and c above w; one
//     without a proven line has a huge w. Lines hold only for rays that are steep enough (line_dz), because a slanted
//     ray sees the gap between a face and its edge over more of the surface.
//  4. A piece that these laws do not decide is open, and the caller solves it.
//
// Arithmetic. The eight pieces of a block are tested at once in single precision. The origin of their frame is the
// block's centre, and o is the point of the ray that is nearest to it. This point is computed in double and rounded
// once; |o| <= radius, and every root in the block has |tau| <= radius. The rows of x, y and z are rounded first, and
// the bounds are then computed for the rounded rows in double, so the rounding of the rows causes no error. Let u =
// 2^-24, and let |r| be the sum of the magnitudes of a row:
//  5. The computed o_x differs from the exact one by at most u·(6·|r|·radius + 4·|offset|), and d_x by u·5·|r|. At any
//     |tau| <= 5/4 radius, the computed x(tau) differs by at most
//       slack = u·(20·|r|·radius + 4·|offset| + 8),
//     which includes the rounding of tau0 and of the values that are compared with it. The maker of a block divides the
//     rows of x and y by the largest |x| and |y| plus their slacks, subtracts the slacks from inner_x and inner_y, and
//     adds the slack of z to h.
//  6. At the computed tau0, |z| is at most the slack of z, so tau0 is off by slack/|d_z|. This has the same effect as a
//     thicker piece, and is a part of h. If |d_z| is at least least_dz = 2^-12·|r_z|, the relative error of d_z is
//     below 2^-9. For this error and the rounding of k and its products, the maker enlarges h by 2^-8 of itself. For
//     the error of d_x, the maker subtracts h·5·u·|r_x|/least_dz from inner_x, and likewise for y. For rays with a
//     smaller |d_z|, the piece is open, unless they pass beside the slab: |o_z| > h + radius·least_dz.
//  7. Near the ends of the interval, within 2^-20 of the radius on either side, a ray neither misses a piece because of
//     the interval, nor is blocked. Near its start, a ray is not blocked within 2^13 times BlockRay::own_error either.
//  8. All builds give the same bits.
#pragma once

#include <cstdint>

namespace facetless {

inline constexpr int kBlockLanes = 8;

struct alignas(64) RayBlock {
  float row[3][3][kBlockLanes];  // of x, y and z: the coefficients of the point relative to the centre
  float offset[3][kBlockLanes];  // of x, y and z: the value at the centre
  float h[kBlockLanes], inner_x[kBlockLanes], inner_y[kBlockLanes], least_dz[kBlockLanes];
  float line_a[kBlockLanes], line_b[kBlockLanes], line_c[kBlockLanes], line_w[kBlockLanes];
  float line_dz[kBlockLanes];  // the line holds for rays with at least this |d_z|
  double center[3];
  double radius;                     // radius of a sphere around the centre that holds all pieces; law 5
  std::uint32_t piece[kBlockLanes];  // the ids of the pieces in the lanes
  std::uint32_t count = 0;           // number of used lanes, which are the first ones
};

// A node of the tree: up to eight children with their boxes, relative to the scene's centre. Unused lanes have an empty
// box.
struct alignas(64) RayNode {
  float side[2][3][kBlockLanes];     // the low and the high sides of the boxes
  std::uint32_t child[kBlockLanes];  // the index of a node, or the index of a block with kBlockBit set
};
inline constexpr std::uint32_t kBlockBit = std::uint32_t{1} << 31;

struct RayBlocks {
  const RayNode* nodes = nullptr;  // the first is the root
  const RayBlock* blocks = nullptr;
  std::uint32_t node_count = 0;
  double center[3] = {};  // of the scene, mm
};

// A ray in double. Its direction has a length of 1 within a few units in the last place.
struct BlockRay {
  double origin[3], direction[3];
  double length;     // mm
  double own_error;  // mm; a root within 2^13 times this distance of the start may be the start's own (law 7)
};

// The open pieces of a block.
struct OpenLanes {
  std::uint32_t block;  // index of the block
  std::uint32_t lanes;  // one bit for each open lane
};

// The largest number of blocks with open pieces in one visit. If the ray meets a further block, the visit ends without an
// answer.
inline constexpr int kMostOpen = 256;
inline constexpr int kDeepestBlocks = 32;  // the largest number of levels of nodes

struct BlockVisit {
  bool every =
      false;  // set by the caller: pieces that block the ray are left open, too, and `near` is filled
  bool blocked = false;   // a piece is proven to block the ray (laws 2 and 3)
  bool overflow = false;  // the visit ended because `open` is full; `open` is not complete
  int open_count = 0;     // number of entries of `open`
  OpenLanes open[kMostOpen];
  float near[kMostOpen][kBlockLanes];  // no root of the piece is nearer than this along the ray, mm
};

// Visits the blocks that the ray meets; unless `every` is set, only until a piece is proven to block the ray.
using VisitBlocks = void (*)(const RayBlocks& blocks, const BlockRay& ray, BlockVisit* visit);

namespace kernel_scalar {
void VisitRayBlocks(const RayBlocks& blocks, const BlockRay& ray, BlockVisit* visit);
}
namespace kernel_avx2 {
void VisitRayBlocks(const RayBlocks& blocks, const BlockRay& ray, BlockVisit* visit);
}

}  // namespace facetless
