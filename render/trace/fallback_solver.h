// The fallback solver: all roots of one ray in a leaf that has no certificate, by subdivision.
//
//  1. Pieces whose coefficients of F keep one sign, beyond their rounding, are proven empty. Pieces that can
//     be certified are solved and proven like any leaf. The rest is halved.
//  2. A piece that has shrunk to kFloorSamples on the screen and still holds F = 0 counts as a root without
//     proof: a tangency, a pole, a cusp, met to that precision.
//  3. A leaf seen edge-on is missed by a proven distance, or kDoubtUnresolved; one that was given up
//     (HardKind::kGivenUp) is proven to be missed, or kDoubtLimit.
//  4. A leaf that needs more than kMaxPieces pieces for a ray ends with kDoubtUnresolved, and a ray that has
//     used up its RayWork ends with kDoubtLimit. Nothing is dropped silently.
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

// What may still be spent on one ray, in control points looked at: all leaves without a certificate that the
// ray meets share it. The same ray spends the same work on every machine.
class RayWork {
 public:
  // About 2.5 ms of one core. The most that a ray of samples/ or of public CAD files was seen to need is
  // 6,600, in a propeller.
  static constexpr std::int64_t kLimit = std::int64_t{1} << 18;

  void Spend(std::int64_t control_points) { left_ -= control_points; }
  bool exhausted() const { return left_ < 0; }

 private:
  std::int64_t left_ = kLimit;
};

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
  // on a border of two pieces possibly twice. Returns kDoubtUnresolved, kDoubtLimit or 0. `rect` is the leaf's
  // of its patch, `work` the ray's.
  std::uint8_t Solve(const HardLeaf& leaf, const ParameterRect& rect, double x, double y, double limit,
                     RayWork* work, std::vector<FallbackRoot>* roots);

 private:
  struct Piece;
  const NetOperations& nets_;
  std::vector<std::unique_ptr<Piece>> stack_;  // storage is reused from call to call
};

}  // namespace facetless
