// Leaf: a piece of a projected patch together with the proof that each ray meets it at most once.
//
// A leaf's own parameters are s, t ∈ [−1,1]. With `center` the pixel of (0,0), J the Jacobian of the pixel
// there and C = J⁻¹, the ray through pixel r is b = C·(r − center), and the leaf keeps the centred monomials
// of
//   G = C·(X − center_x·W, Y − center_y·W)/W(0,0)   and   W/W(0,0),
// so that H(s,t) = G − b·W vanishes exactly where the ray meets the surface, and its Jacobian is close to the
// identity.
//
//  1. Over the enlarged leaf |s|, |t| ≤ kEnlarged and for every ray that can meet it, ‖I − H'‖∞ ≤ kappa < 1
//     and ‖H''‖∞ ≤ the Lipschitz constant behind newton_factor. Hence at most one root per ray.
//  2. A ray with |b|∞ > b_limit misses the enlarged leaf.
//  3. From x with residual ρ = ‖H(x)‖∞ + rounding, a root in the enlarged leaf lies within e = ρ·inverse_gap
//     of x, and within newton_factor·e² of the Newton step from x, and within kappa·e of the chord step x −
//     H(x). All include rounding (Law 4). If the ball of radius e about x lies in the enlarged leaf, the root
//     exists: x ↦ x − H(x) maps the ball into itself.
//  4. `rounding` bounds the error of evaluating H as the kernel does it, against the exact surface: the net's
//     own error, conversion to monomials, and the kernel's arithmetic.
//  5. Newton from the start x = b converges: newton_factor times the start's error is below 1/2.
//  6. The iteration stops where the root is known to root_error in s and t; the depth there is known to
//     depth_error. Both bounds hold for every root in the leaf.
#pragma once

#include <cmath>
#include <cstdint>

#include "render/nurbs/bezier.h"

namespace facetless {

// How far the bounds reach past the leaf, in s and t. Room for iterates and for a root on the border.
inline constexpr double kEnlarged = 1.0625;
// The largest ‖I − H'‖ that a leaf may have.
inline constexpr double kMaxKappa = 0.5;
// Roots this far outside a leaf are its own too, or as far as four errors of a root: neighbouring leaves
// overlap, so that no ray falls between them.
inline constexpr double kBorderOverlap = 0x1p-30;
// A leaf whose roots cannot be told from its neighbours' has no certificate.
inline constexpr double kMaxRootError = 0x1p-9;

// What the kernel that will solve a leaf can do.
struct KernelArithmetic {
  double epsilon = 0x1p-53;    // its unit roundoff
  double tolerance = 0x1p-42;  // a root's error bound, in s and t and without rounding, at which it stops
};
inline constexpr KernelArithmetic kDoubleArithmetic{};
inline constexpr KernelArithmetic kFloatArithmetic{0x1p-24, 0x1p-17};

enum LeafFlag : std::uint16_t {
  kLeafWeightVaries = 1,  // W is not constant: H depends on b
  kLeafPerspective = 2,   // depth = depth_scale·W/Q with Q(0,0) = 1, else depth = depth_scale + Q/W
  kLeafDepthVaries = 4,   // Q is not constant
  kLeafTrimmed = 8,       // a hit must be asked of the face's trim index
  kLeafHard = 16,  // no certificate: coefficients are the Bézier net itself, for the subdivision solver, and
                   // c11, c12, c21, c22 the errors of its X, Y, W, Q
  kLeafSeam =
      32,  // with kLeafHard: one sample beside an edge, and the hit (s_low, t_low) at near_depth that its
           // face may owe the ray (trace/seams.h)
  kLeafOdd = 64,        // with kLeafSeam: the ray should cross the face an odd number of times
  kLeafEdgeOn = 128,    // hard, and its image is a line (edge_on.h): a ray misses it, or nothing is known
  kLeafAtBorder = 256,  // touches a border of its patch: OnPatchBorder may hold
  kLeafGivenUp =
      512,  // hard, and stands for a piece that its patch may not split any further: a ray beside its control
            // points misses it, and of the others nothing is known (kDoubtLimit)
};

struct Leaf {
  // Planes G1, G2, [W if it varies], [Q if it varies] of (degree_u+1)·(degree_v+1) monomials; hard: the
  // values of a BezierNet.
  const double* coefficients = nullptr;
  const float* coefficients32 = nullptr;      // instead of the others, for a kernel in single precision
  double center_x = 0, center_y = 0;          // pixel coordinates relative to the image centre
  double c11 = 0, c12 = 0, c21 = 0, c22 = 0;  // C
  double b_limit = 0, inverse_gap = 0, newton_factor = 0, rounding = 0, root_error = 0;
  double s_low = -1 - kBorderOverlap, s_high = 1 + kBorderOverlap;  // accepted roots
  double t_low = -1 - kBorderOverlap, t_high = 1 + kBorderOverlap;
  double depth_scale = 0;
  double near_depth = 0;                                        // no point of the leaf is nearer
  double depth_error = 0;                                       // mm
  double u_mid = 0.5, u_half = 0.5, v_mid = 0.5, v_half = 0.5;  // of the patch's Bézier parameters in [0,1]
  std::int32_t col_begin = 0, col_end = 0, row_begin = 0,
               row_end = 0;  // half-open range of sample columns and rows
  std::uint32_t placed_face = 0, patch = 0;
  std::uint8_t degree_u = 1, degree_v = 1;
  std::uint16_t flags = 0;

  double overlap() const { return std::fmax(kBorderOverlap, 4 * root_error); }
  int points() const { return (degree_u + 1) * (degree_v + 1); }
  int planes() const {
    if (flags & kLeafHard) return kNetComponents;
    return 2 + ((flags & kLeafWeightVaries) != 0) + ((flags & kLeafDepthVaries) != 0);
  }
};

// Whether a root lies on a border of its patch, within its error, or beyond it in the overlap. Beyond, the
// surface is the neighbour's, and may turn away there. (Where leaves of one patch overlap, both are the same
// surface.) A side that reaches farther than the overlap does so on purpose, across the gap to an edge, and
// is left out.
inline bool OnPatchBorder(const Leaf& leaf, double s, double t) {
  const double inside = 1 - leaf.root_error, overlap = 1 + leaf.overlap();
  return (s < -inside && leaf.u_mid - leaf.u_half == 0 && leaf.s_low >= -overlap) ||
         (s > inside && leaf.u_mid + leaf.u_half == 1 && leaf.s_high <= overlap) ||
         (t < -inside && leaf.v_mid - leaf.v_half == 0 && leaf.t_low >= -overlap) ||
         (t > inside && leaf.v_mid + leaf.v_half == 1 && leaf.t_high <= overlap);
}

struct DepthRule {
  bool perspective = false;
  bool weight_varies = false;  // W of the net is not constant
  bool depth_varies = false;   // Q of the net is not constant
};

struct Verdict {
  bool certified = false;
  // Where not: the kappa to expect after halving in u or in v. Infinite where the Jacobian at the centre is
  // singular.
  double kappa_halved_u = INFINITY, kappa_halved_v = INFINITY;
};

// How far the depth of a point is off for the net's error alone, depths being at most `far` in magnitude and
// the divisor (Q in perspective, else W) at least `divisor`; infinite where that is no more than its own
// error.
inline double NetDepthError(const BezierNet& net, DepthRule rule, double far, double divisor) {
  const double own = rule.perspective ? net.error[kW] : net.error[kQ];
  const double of_divisor = rule.perspective ? net.error[kQ] : net.error[kW];
  return divisor > of_divisor ? (own + far * of_divisor) / (divisor - of_divisor) : INFINITY;
}

}  // namespace facetless
