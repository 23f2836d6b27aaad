// Tensor-product Bézier nets of several components, and their two elementary operations: halving,
// extending, and the change to centred monomials.
//
//  1. A net holds `components` planes of (degree_u+1)·(degree_v+1) coefficients, u-major:
//     value[c][k·(degree_v+1) + l].
//  2. Halving is de Casteljau's at 1/2: both halves share the coefficients of the new border bit by bit.
//     Extending leaves the coefficients of a border that it doesn't move as they are.
//  3. Everything here is plain multiplication and addition in a fixed order: the same bytes on every machine.
//  4. `error[c]` bounds how far each coefficient of component c lies from that of the exact surface: whoever
//     fills a net states it, and halving adds its own rounding.
#pragma once

#include <array>
#include <cstddef>

namespace facetless {

inline constexpr int kMaxDegree = 25;  // OpenCASCADE's limit
inline constexpr int kMaxNetPoints = (kMaxDegree + 1) * (kMaxDegree + 1);

// Components of a projected net, in this order. See trace/projection.h for what they mean.
enum NetComponent : int { kX = 0, kY = 1, kW = 2, kQ = 3, kNetComponents = 4 };

struct BezierNet {
  int degree_u = 1, degree_v = 1;
  double* value[kNetComponents] = {};  // storage belongs to the caller
  double error[kNetComponents] = {};
  int points() const { return (degree_u + 1) * (degree_v + 1); }
  int stride() const { return degree_v + 1; }
};

enum class Direction : unsigned char { kU, kV };

// The largest magnitude; NaN if there is one after it.
double MaxAbs(const double* values, int count);

// Halves `net` at the middle of one direction into `low` and `high`, which have its degrees and storage of
// their own, and their errors.
void Halve(const BezierNet& net, Direction direction, BezierNet* low, BezierNet* high);

// Re-expresses component `c` of `net`, and its error, over [−low, 1 + high] of one direction's parameter; low, high >= 0, and
// small, because extrapolation magnifies rounding by (1 + 2·(low + high))^degree.
void Extend(BezierNet* net, NetComponent c, Direction direction, double low, double high);

// Row i of the matrix that takes the degree+1 Bernstein coefficients over [0,1] to the coefficient of s^i,
// where s = 2t − 1 ∈ [−1,1]. Entries are integers times 2^−degree, hence exact.
using MonomialMatrix = std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1>;
const MonomialMatrix& CenteredMonomialMatrix(int degree);

// out[i·stride + j] = coefficient of s^i·t^j of the component `in`. `out` may not alias `in`.
void ToCenteredMonomials(const double* in, int degree_u, int degree_v, double* out);

// Calls run.template operator()<P, Q>() with the degrees as constants where both are at most 3, as most surfaces' are, and
// with −1 for both otherwise: loops that the compiler knows the length of cost half.
template <typename Run>
inline auto ByDegrees(int degree_u, int degree_v, const Run& run) {
  switch (degree_u * 8 + degree_v) {
    case 1 * 8 + 1:
      return run.template operator()<1, 1>();
    case 1 * 8 + 2:
      return run.template operator()<1, 2>();
    case 2 * 8 + 1:
      return run.template operator()<2, 1>();
    case 2 * 8 + 2:
      return run.template operator()<2, 2>();
    case 1 * 8 + 3:
      return run.template operator()<1, 3>();
    case 3 * 8 + 1:
      return run.template operator()<3, 1>();
    case 2 * 8 + 3:
      return run.template operator()<2, 3>();
    case 3 * 8 + 2:
      return run.template operator()<3, 2>();
    case 3 * 8 + 3:
      return run.template operator()<3, 3>();
    default:
      return run.template operator()<-1, -1>();
  }
}

}  // namespace facetless
