// The fallback solver. It finds all roots of one ray in a leaf without a certificate, by subdivision.
//
//     FallbackSolver solver(nets);
//     RayWork work;
//     std::vector<FallbackRoot> roots;
//     const std::uint8_t doubt = solver.Solve(leaf, x, y, limit, &work, &roots);
//
//  1. A piece is proven empty if the coefficients of F have one sign, beyond their rounding. A piece that can
//     be certified is solved and proven like any leaf. Any other piece is halved.
//  2. A piece that has shrunk to kFloorSamples on the screen and may still contain F = 0 counts as a root
//     without proof: a tangency, a pole or a cusp, located to that precision.
//  3. For a leaf that is seen edge-on, the result is a proven miss or kDoubtUnresolved. For a leaf that was
//     given up (kLeafGivenUp), it is a proven miss or kDoubtLimit.
//  4. If a leaf needs more than kMaxPieces pieces for a ray, the result is kDoubtUnresolved. If a ray has
//     used up its RayWork, the result is kDoubtLimit. Nothing is dropped silently.
//  5. The bounds hold for the exact surface, because they include the error of the net.
//  6. A proven root is the only one in its piece, enlarged as in leaf.h. If the ray is moved by d samples, the root of
//     the moved ray in that piece, if there is one, lies within spread_s·d and spread_t·d of this root.
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

// The remaining work limit of one ray, in control points examined. All leaves without a certificate that the
// ray meets share it. The same ray needs the same work on every machine.
class RayWork {
 public:
  // About 2.5 ms on one core. The most that any ray in samples/ or in public CAD files needed is 6,600, in a
  // propeller.
  static constexpr std::int64_t kLimit = std::int64_t{1} << 18;

  void Spend(std::int64_t control_points) { left_ -= control_points; }
  bool exhausted() const { return left_ < 0; }

 private:
  std::int64_t left_ = kLimit;
};

struct FallbackRoot {
  TileHit hit;                      // s and t are those of the leaf, not of the piece
  double error_s = 0, error_t = 0;  // bounds of the errors of s and t
  double jacobian_sign = 0;         // sign of the Jacobian of (u,v) → pixel at the root; 0: unknown
  bool proven = true;               // the root exists and is the only one in its piece
  bool on_border = false;           // on a border of its patch, within its error (OnPatchBorder)
  double half_s = 0, half_t = 0;    // of a proven root: half the sides of its piece, in the leaf's parameters
  double spread_s = 0, spread_t = 0;  // of a proven root: law 6, per sample
};

class FallbackSolver {
 public:
  // `nets` must outlive the solver.
  explicit FallbackSolver(const NetOperations& nets);
  ~FallbackSolver();
  // Returns whether the ray through (x, y) misses the leaf, by the control points of the leaf alone. If so, Solve would
  // find nothing, and its work is spent. Five of six rays miss, and for them nothing but the net is read.
  bool Misses(const HardLeaf& leaf, double x, double y, RayWork* work) const;
  // Appends the roots of the ray through (x, y) nearer than `limit` to *roots, in no particular order, those
  // on a border of two pieces possibly twice. Returns kDoubtUnresolved, kDoubtLimit or 0. `rect` is the leaf's
  // of its patch, `work` the ray's. Set `whole` if the leaf was not certified before: a certificate of the whole leaf
  // is then tried first. Without one, a leaf that is seen edge-on is empty if the ray passes beside it, else
  // unresolved.
  std::uint8_t Solve(const HardLeaf& leaf, const ParameterRect& rect, double x, double y, double limit,
                     RayWork* work, std::vector<FallbackRoot>* roots, bool whole = false);

 private:
  struct Piece;
  struct Task;
  Piece& StackAt(std::size_t depth);
  // Solves a piece if it can be certified. Returns false if it says nothing of the ray.
  bool SolveCertified(const Piece& work, const Task& task) const;
  // Takes a piece of kFloorSamples for a root. Returns false if its depth is not known.
  static bool AddUnprovenRoot(const Piece& work, const Task& task);
  // Puts the halves of a piece, which is above the stack at `depth`, on the stack.
  void HalvePiece(const Piece& work, Direction direction, std::size_t depth);

  const NetOperations& nets_;
  std::vector<std::unique_ptr<Piece>> stack_;  // storage is reused from call to call
};

}  // namespace facetless
