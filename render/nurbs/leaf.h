// Leaf: a piece of a projected patch, with a proof (the certificate) that each ray meets it at most once.
//
// The parameters of a leaf are s, t ∈ [−1,1]. Let `center` be the pixel of (0,0), J the Jacobian of the pixel
// coordinates there, and C = J⁻¹. The ray through pixel r is represented by b = C·(r − center), and the leaf
// stores the centred monomials of
//   G = C·(X − center_x·W, Y − center_y·W)/W(0,0)   and   W/W(0,0),
// so that H(s,t) = G − b·W vanishes exactly where the ray meets the surface, and its Jacobian is close to the
// identity.
//
// Laws of certified leaves:
//  1. Over the enlarged leaf |s|, |t| ≤ kEnlarged and for every ray that can meet it, ‖I − H'‖∞ ≤ kappa < 1
//     and ‖H''‖∞ ≤ the Lipschitz constant behind newton_factor. Hence at most one root per ray.
//  2. A ray with |b|∞ > b_limit misses the enlarged leaf.
//  3. Let x have the residual ρ = ‖H(x)‖∞ + rounding, and let e = ρ·inverse_gap. A root in the enlarged leaf
//     lies within e of x, within newton_factor·e² of the Newton step from x, and within kappa·e of the chord
//     step x − H(x). All three bounds include rounding (law 4). If the ball of radius e about x lies in the
//     enlarged leaf, the root exists, because x ↦ x − H(x) maps the ball into itself.
//  4. `rounding` bounds the difference between H as the kernel evaluates it and H of the exact surface. It
//     includes the error of the net, the conversion to monomials, and the arithmetic of the kernel.
//  5. Newton's iteration from the start x = b converges: newton_factor times the error of the start is below
//     1/2.
//  6. The iteration stops when the error of the root in s and t is at most root_error; the error of the depth
//     is then at most depth_error. Both bounds hold for every root in the leaf.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "render/nurbs/bezier.h"
#include "render/nurbs/leaf_place.h"

namespace facetless {

// The bounds hold over |s|, |t| ≤ kEnlarged, which leaves room for the iterates and for a root on the border.
inline constexpr double kEnlarged = 1.0625;
// The largest ‖I − H'‖ that a leaf may have.
inline constexpr double kMaxKappa = 0.5;
// A leaf also accepts roots that lie outside it by up to this much, or by up to four times root_error if that
// is more. Neighbouring leaves therefore overlap, and no ray passes between them.
inline constexpr double kBorderOverlap = 0x1p-30;
// The largest root_error of a certified leaf. With a larger error, the roots of a leaf could not be told
// apart from those of its neighbours.
inline constexpr double kMaxRootError = 0x1p-9;

// The arithmetic of the kernel that will solve a leaf.
struct KernelArithmetic {
  double epsilon = 0x1p-53;  // unit roundoff
  double tolerance =
      0x1p-42;  // error bound of a root, in s and t and without rounding, at which the iteration stops

  bool is_single() const { return epsilon == 0x1p-24; }  // it reads coefficients as floats
};
inline constexpr KernelArithmetic kDoubleArithmetic{};
inline constexpr KernelArithmetic kFloatArithmetic{0x1p-24, 0x1p-17};

enum LeafFlag : std::uint8_t {
  kLeafWeightVaries = 1,  // W is not constant: H depends on b
  kLeafPerspective = 2,   // depth is W/Q, else Q/W
  kLeafDepthVaries = 4,   // Q is not constant
  kLeafTrimmed = 8,       // a hit must be tested with the face's trim index
};

// The borders of its patch at which a leaf ends.
enum LeafBorder : std::uint8_t {
  kBorderLowU = 1,   // u = 0
  kBorderHighU = 2,  // u = 1
  kBorderLowV = 4,
  kBorderHighV = 8,
};

inline std::uint8_t BordersOf(const ParameterRect& rect) {
  return static_cast<std::uint8_t>(
      (rect.u_mid - rect.u_half == 0 ? kBorderLowU : 0) | (rect.u_mid + rect.u_half == 1 ? kBorderHighU : 0) |
      (rect.v_mid - rect.v_half == 0 ? kBorderLowV : 0) | (rect.v_mid + rect.v_half == 1 ? kBorderHighV : 0));
}

// The samples that a leaf may serve. At least one; columns and rows are below 65536.
struct SampleBox {
  std::uint16_t first_col = 0, last_col = 0, first_row = 0, last_row = 0;

  static SampleBox HalfOpen(int col_begin, int col_end, int row_begin, int row_end) {
    return {static_cast<std::uint16_t>(col_begin), static_cast<std::uint16_t>(col_end - 1),
            static_cast<std::uint16_t>(row_begin), static_cast<std::uint16_t>(row_end - 1)};
  }
  int col_begin() const { return first_col; }
  int col_end() const { return last_col + 1; }
  int row_begin() const { return first_row; }
  int row_end() const { return last_row + 1; }
  double samples() const { return double(col_end() - first_col) * (row_end() - first_row); }
  bool Holds(int column, int row) const {
    return first_col <= column && column <= last_col && first_row <= row && row <= last_row;
  }
};

// The data that a packet's walk needs of a leaf of any kind.
struct LeafHeader {
  double near_depth = 0;  // no point of the leaf is nearer
  SampleBox box;
  std::uint32_t placed_face = 0;
  std::uint8_t degree_u = 1, degree_v = 1;
  std::uint8_t flags = 0;    // bits of LeafFlag
  std::uint8_t borders = 0;  // bits of LeafBorder

  int points() const { return (degree_u + 1) * (degree_v + 1); }
};
static_assert(sizeof(LeafHeader) == 24);

// Its LeafPlace is stored separately, because it is needed only when a root is accepted.
struct CertifiedLeaf : LeafHeader {
  // The planes G1, G2, [W if it varies], [Q if it varies] of points() monomials each. They are floats or
  // doubles, depending on the kernel for which the leaf is made: see CoefficientsOf. The depth is
  // depth_scale·W/Q with Q(0,0) = 1 in perspective, else depth_scale + Q/W.
  const void* coefficients = nullptr;
  double center_x = 0, center_y = 0;          // pixel coordinates relative to the image centre
  double c11 = 0, c12 = 0, c21 = 0, c22 = 0;  // C
  double b_limit = 0, inverse_gap = 0, newton_factor = 0, rounding = 0;
  double depth_scale = 0;
  double depth_error = 0;  // mm

  int planes() const { return 2 + ((flags & kLeafWeightVaries) != 0) + ((flags & kLeafDepthVaries) != 0); }
  double RootError(const KernelArithmetic& kernel) const {
    return kernel.tolerance + 2 * rounding * inverse_gap;
  }
};
static_assert(sizeof(CertifiedLeaf) == 128, "two lines of the cache");

// Requires a leaf whose kernel works in Real.
template <typename Real>
const Real* CoefficientsOf(const CertifiedLeaf& leaf) {
  return static_cast<const Real*>(leaf.coefficients);
}

// The treatment of a leaf that has no certificate.
enum class HardKind : std::uint8_t {
  kSubdivide,
  kEdgeOn,  // its image is a line (edge_on.h): a ray misses it, or the result is unknown
  // It represents a piece that may not be split any further because its patch has reached its work limit. A
  // ray that passes beside its control points misses it; for other rays the result is unknown (kDoubtLimit).
  kGivenUp,
};

struct HardLeaf : LeafHeader {
  const double* net = nullptr;  // as BezierNet::value
  double error[kNetComponents] = {};
  LeafPlace place;
  HardKind kind = HardKind::kSubdivide;
};

struct SeamLeaf : LeafHeader {
  const double* net = nullptr;  // net of the patch, as BezierNet::value
  double s = 0, t = 0;
  std::uint32_t patch = 0;
  bool odd = false;  // the ray should cross the face an odd number of times
};

// The id of a leaf in a view consists of its kind and its index among the leaves of its kind; that of a
// certified leaf is its index alone. kNoIndex is no leaf.
enum class LeafKind : std::uint8_t { kCertified, kHard, kSeam };
inline constexpr int kLeafIndexBits = 30;
inline constexpr std::size_t kMostLeaves = std::size_t{1} << kLeafIndexBits;  // of a kind
inline constexpr std::uint32_t LeafId(LeafKind kind, std::size_t index) {
  return static_cast<std::uint32_t>(kind) << kLeafIndexBits | static_cast<std::uint32_t>(index);
}
inline constexpr LeafKind KindOf(std::uint32_t id) {
  return static_cast<LeafKind>(id >> kLeafIndexBits);
}
inline constexpr std::uint32_t IndexWithin(std::uint32_t id) {
  return id & ((std::uint32_t{1} << kLeafIndexBits) - 1);
}

// Read-only views of the leaves of all kinds.
struct LeafSpans {
  std::span<const CertifiedLeaf> certified;
  std::span<const LeafPlace> places;  // of the certified ones
  std::span<const HardLeaf> hard;
  std::span<const SeamLeaf> seams;

  std::size_t size() const { return certified.size() + hard.size() + seams.size(); }
  const LeafHeader& Header(std::uint32_t id) const {
    if (KindOf(id) == LeafKind::kCertified) return certified[id];
    if (KindOf(id) == LeafKind::kHard) return hard[IndexWithin(id)];
    return seams[IndexWithin(id)];
  }
  LeafPlace Place(std::uint32_t id) const {
    if (KindOf(id) == LeafKind::kCertified) return places[id];
    if (KindOf(id) == LeafKind::kHard) return hard[IndexWithin(id)].place;
    return {0, seams[IndexWithin(id)].patch, 0, 0};
  }
};

// The leaves of all kinds while they are made.
struct LeafLists {
  std::vector<CertifiedLeaf> certified;
  std::vector<LeafPlace> places;  // of the certified ones
  std::vector<HardLeaf> hard;
  std::vector<SeamLeaf> seams;

  LeafSpans spans() const { return {certified, places, hard, seams}; }
};

// Returns how far outside a leaf its own roots may lie, given the error of a root.
inline double Overlap(double root_error) {
  return 4 * root_error > kBorderOverlap ? 4 * root_error : kBorderOverlap;
}

// Returns whether a root lies on a border of its patch, within its error, or beyond it in the overlap.
// Beyond, the surface is the neighbour's, and may turn away there. (Where leaves of one patch overlap, both
// are the same surface.) A patch that is continued past the border, across the gap to an edge, does not end
// there.
inline bool OnPatchBorder(const CertifiedLeaf& leaf, double root_error, double s, double t) {
  const double inside = 1 - root_error;
  return (s < -inside && (leaf.borders & kBorderLowU)) || (s > inside && (leaf.borders & kBorderHighU)) ||
         (t < -inside && (leaf.borders & kBorderLowV)) || (t > inside && (leaf.borders & kBorderHighV));
}

struct DepthRule {
  bool perspective = false;
  bool weight_varies = false;  // W of the net is not constant
  bool depth_varies = false;   // Q of the net is not constant
};

inline std::uint8_t FlagsOf(DepthRule rule) {
  return static_cast<std::uint8_t>((rule.weight_varies ? kLeafWeightVaries : 0) |
                                   (rule.perspective ? kLeafPerspective : 0) |
                                   (rule.depth_varies ? kLeafDepthVaries : 0));
}

inline DepthRule RuleOf(const LeafHeader& leaf) {
  return {(leaf.flags & kLeafPerspective) != 0, (leaf.flags & kLeafWeightVaries) != 0,
          (leaf.flags & kLeafDepthVaries) != 0};
}

struct NetVerdict {
  bool certified = false;
  // If not certified: the kappa to expect after halving in u or in v; infinite if the Jacobian at the centre
  // is singular.
  double kappa_halved_u = INFINITY, kappa_halved_v = INFINITY;
};

// Bounds the depth error that the net's error alone causes, for depths of magnitude at most `far` and a
// divisor (Q in perspective views, W otherwise) of at least `divisor`. Infinite if `divisor` does not exceed
// its error.
inline double NetDepthError(const BezierNet& net, DepthRule rule, double far, double divisor) {
  const double own = rule.perspective ? net.error[kW] : net.error[kQ];
  const double of_divisor = rule.perspective ? net.error[kQ] : net.error[kW];
  return divisor > of_divisor ? (own + far * of_divisor) / (divisor - of_divisor) : INFINITY;
}

}  // namespace facetless
