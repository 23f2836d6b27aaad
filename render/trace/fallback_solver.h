// The fallback solver: all roots of one ray in a leaf that has no certificate, by subdivision.
//
//  1. Pieces whose coefficients of F keep one sign, beyond their rounding, are proven empty. Pieces that can
//     be certified are solved and proven like any leaf. The rest is halved.
//  2. A piece that has shrunk to kFloorSamples on the screen and still holds F = 0 counts as a root without
//     proof: a tangency, a pole, a cusp, met to that precision.
//  3. A leaf seen edge-on is missed by a proven distance, or kDoubtUnresolved; one that was given up (kLeafGivenUp) is
//     proven to be missed, or kDoubtLimit.
//  4. A ray that needs more than kMaxPieces pieces ends with kDoubtUnresolved. Nothing is dropped silently.
//  5. Bounds are those of the exact surface: the net's own error is part of them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/kernels/tile_kernel.h"
#include "render/nurbs/bezier.h"
#include "render/nurbs/leaf.h"
#include "render/nurbs/net_operations.h"

namespace facetless {

inline constexpr double kFloorSamples = 0x1p-36;
inline constexpr int kMaxPieces = 4096;

struct FallbackRoot {
  TileHit hit;                      // s and t of the leaf, not of the piece
  double error_s = 0, error_t = 0;  // how far the root may lie from there
  double jacobian_sign = 0;         // sign of the Jacobian of (u,v) → pixel at the root; 0: not known
  bool proven = true;               // exists, and is the only one in its piece
  bool on_border = false;           // of its patch, within its error (OnPatchBorder)
};

class FallbackSolver {
 public:
  // `nets` must outlive the solver.
  explicit FallbackSolver(const NetOperations& nets);
  ~FallbackSolver();
  // Appends the roots of the ray through (x, y) nearer than `limit` to *roots, in no particular order, those
  // on a border of two pieces possibly twice. Returns kDoubtUnresolved, kDoubtLimit or 0. Requires a leaf with kLeafHard.
  std::uint8_t Solve(const Leaf& leaf, double x, double y, double limit, std::vector<FallbackRoot>* roots);

 private:
  struct Piece;
  const NetOperations& nets_;
  std::vector<std::unique_ptr<Piece>> stack_;  // storage is reused from call to call
};

}  // namespace facetless
