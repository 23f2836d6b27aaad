// Ray blocks: what tells most rays apart from most pieces of surface without solving for a root.
//
// A piece of surface is enclosed in a thick parallelogram. Three affine functions of space, x, y and z, have |x| <= 1,
// |y| <= 1 and |z| <= h at all of its control points, and so on all of the piece. Along its four borders the control
// points have x <= -inner_x, x >= inner_x, y <= -inner_y and y >= inner_y. For a ray o + tau·d in these coordinates, let
// tau0 = -o_z/d_z, k = h/|d_z|, and (x0, y0) = (o + tau0·d)_xy.
//
//  1. All roots have |tau - tau0| <= k, so |x| <= 1 implies |x0| <= 1 + k·|d_x|, and likewise for y. A ray for which
//     one of the two is false misses the piece, and so does one whose interval does not meet tau0 ± k.
//  2. Projected along d onto the plane z = 0, a border moves by at most k·(|d_x|, |d_y|). If |x0| < inner_x - k·|d_x|
//     and |y0| < inner_y - k·|d_y|, then each projected border stays on its own side of (x0, y0), and the border as a
//     whole winds once round it, as the parallelogram's does. A continuous image of a square whose border winds round
//     a point covers the point: a root exists. If tau0 ± k lies within the ray's interval, the ray is blocked.
//  3. If the piece is trimmed, a line a·x + b·y + c with a half width w tells what remains of it: the surface is in its
//     face where the value is above w, and trimmed away where it is below -w. At a root the value differs by at most
//     k·(|a·d_x| + |b·d_y|) from that at (x0, y0). A piece that is not trimmed has a = b = 0 and c above w; one
//     without a proven line has an infinite w. Lines hold for rays that are steep enough (line_dz), because the gap
//     between a face and its edge covers more of the surface as a slanted ray sees it.
//  4. What neither law decides is open, and left to the resolver.
//
// Arithmetic. Blocks of eight pieces are tested at once in single precision, in a frame around the block's centre and
// the ray's point nearest to it: the ray's point is computed in double and rounded once, |o| <= radius, and every root
// in the block has |tau| <= radius. The rows of x, y and z are the rounded ones, for which the bounds are computed in
// double, so rounding them is no error. Let u = 2^-24 and |r| the sum of the magnitudes of a row:
//  5. The computed o_x differs from the exact one by at most u·(6·|r|·radius + 4·|offset|), and d_x by u·5·|r|. At any
//     |tau| <= 5/4 radius, the computed x(tau) differs by at most
//       slack = u·(20·|r|·radius + 4·|offset| + 8),
//     which includes the rounding of tau0 and of what is compared with it. The maker of a block divides the rows of x and y by the largest |x| plus its slack, takes the slack from inner_x
//     and inner_y, and adds that of z to h.
//  6. The computed tau0 has |z(tau0)| within the slack of z, so it is off by slack/|d_z|: that is the same as a thicker
//     piece, and part of h. For |d_z| at least `least_dz` = 2^-12·|r_z|, the relative error of d_z is below 2^-9. The
//     maker makes h larger by 2^-8 of itself for that and for the rounding of k and its products, and takes
//     h·5·u·|r_x|/least_dz from inner_x for the error of d_x. Rays with a smaller d_z are open, unless they pass beside
//     the slab: |o_z| > h + radius·least_dz.
//  7. The ends of the interval are kept by `guard`, 2^-20 of the radius, on either side.
//
// All builds give the same bits.
#pragma once

#include <cstdint>

namespace facetless {

inline constexpr int kBlockLanes = 8;

struct alignas(64) RayBlock {
  float row[3][3][kBlockLanes];  // of x, y and z: the coefficients of the point relative to the centre
  float offset[3][kBlockLanes];
  float h[kBlockLanes], inner_x[kBlockLanes], inner_y[kBlockLanes], least_dz[kBlockLanes];
  float line_a[kBlockLanes], line_b[kBlockLanes], line_c[kBlockLanes], line_w[kBlockLanes];
  float line_dz[kBlockLanes];  // the line holds for rays with at least this |d_z|
  double center[3];
  double radius;                     // of a sphere around the centre that holds all pieces; law 5
  std::uint32_t piece[kBlockLanes];  // what the lanes are; unused lanes have h = -1, which no ray meets
  std::uint32_t count = 0;
};

// Up to eight children with their boxes, relative to the scene's centre. Unused lanes have an empty box.
struct alignas(64) RayNode {
  float side[2][3][kBlockLanes];     // low and high
  std::uint32_t child[kBlockLanes];  // a node, or a block with kBlockBit
};
inline constexpr std::uint32_t kBlockBit = std::uint32_t{1} << 31;

struct RayBlocks {
  const RayNode* nodes = nullptr;  // the root is the first
  const RayBlock* blocks = nullptr;
  std::uint32_t node_count = 0;
  double center[3] = {};  // of the scene
};

// A ray in double. Its direction has a length of 1 within a few units in the last place.
struct BlockRay {
  double origin[3], direction[3];
  double length;
  double own_error;  // mm: roots nearer than 2^13 times this are not told from the start
};

// Lanes of a block that are open.
struct OpenLanes {
  std::uint32_t block;
  std::uint32_t lanes;  // bits
};

// The number of open blocks that a ray may collect before the visit ends; the rest of the tree is then open as well.
inline constexpr int kMostOpen = 256;
inline constexpr int kDeepestBlocks = 32;  // levels of nodes

struct BlockVisit {
  bool every = false;     // set by the caller: pieces that block the ray are open, too, and `near` is filled
  bool blocked = false;   // by law 2
  bool overflow = false;  // more than kMostOpen blocks are open
  int open_count = 0;
  OpenLanes open[kMostOpen];
  float near[kMostOpen][kBlockLanes];  // no root of the piece is nearer than this along the ray, mm
};

// Visits the blocks that the ray meets, until one blocks it for certain.
using VisitBlocks = void (*)(const RayBlocks& blocks, const BlockRay& ray, BlockVisit* visit);

namespace kernel_scalar {
void VisitRayBlocks(const RayBlocks& blocks, const BlockRay& ray, BlockVisit* visit);
}
namespace kernel_avx2 {
void VisitRayBlocks(const RayBlocks& blocks, const BlockRay& ray, BlockVisit* visit);
}

}  // namespace facetless
