// Tensor-product Bézier nets of several components. What is done to every one of them is in net_operations.h;
// here is what is done to few: extending, and the matrices of the change to centred monomials.
//
//  1. A net holds (degree_u+1)·(degree_v+1) coefficients, u-major, each with its components side by side:
//     value[kNetComponents·(k·(degree_v+1) + l) + c].
//  2. Extending leaves the coefficients of a border that it doesn't move as they are.
//  3. Everything here is plain multiplication and addition in a fixed order: the same bytes on every machine.
//  4. `error[c]` bounds how far each coefficient of component c lies from that of the exact surface: whoever
//     fills a net states it, and halving adds its own rounding.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "render/model/model.h"

namespace facetless {

inline constexpr int kMaxNetPoints = (kMaxDegree + 1) * (kMaxDegree + 1);

// Components of a projected net, in this order. See view/projection.h for what they mean.
enum NetComponent : int { kX = 0, kY = 1, kW = 2, kQ = 3, kNetComponents = 4 };

struct BezierNet {
  int degree_u = 1, degree_v = 1;
  double* value = nullptr;  // storage belongs to the caller
  double error[kNetComponents] = {};
  int points() const { return (degree_u + 1) * (degree_v + 1); }
  int stride() const { return degree_v + 1; }
  // Component `c` of coefficient `i`.
  double at(int i, NetComponent c) const { return value[kNetComponents * i + c]; }
  double& at(int i, NetComponent c) { return value[kNetComponents * i + c]; }
};

enum class Direction : unsigned char { kU, kV };

// A net that owns its storage, for work that needs many in turn.
struct OwnedNet {
  BezierNet net;
  std::vector<double> storage;

  void SetDegrees(int degree_u, int degree_v) {
    net.degree_u = degree_u;
    net.degree_v = degree_v;
    const std::size_t count = std::size_t(kNetComponents) * net.points();
    if (storage.size() < count) storage.resize(count);
    net.value = storage.data();
  }
};

// Re-expresses component `c` of `net`, and its error, over [−low, 1 + high] of one direction's parameter;
// low, high >= 0, and small, because extrapolation magnifies rounding by (1 + 2·(low + high))^degree.
void Extend(BezierNet* net, NetComponent c, Direction direction, double low, double high);

// Row i of the matrix that takes the degree+1 Bernstein coefficients over [0,1] to the coefficient of s^i,
// where s = 2t − 1 ∈ [−1,1]. Entries are integers times 2^−degree, hence exact.
using MonomialMatrix = std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1>;
const MonomialMatrix& CenteredMonomialMatrix(int degree);

// The largest degree for which loops of known length are compiled; most surfaces have no higher one.
inline constexpr int kMaxFixedDegree = 3;

// Calls run.template operator()<P, Q>() with the degrees as constants where both lie in [1, kMaxFixedDegree],
// and with −1 for both otherwise: loops that the compiler knows the length of cost half.
template <typename Run>
inline auto ByDegrees(int degree_u, int degree_v, const Run& run) {
  // One switch inside another, because no packed key of the two degrees can then stand for another pair.
  const auto with_u = [&]<int P>() {
    switch (degree_v) {
      case 1:
        return run.template operator()<P, 1>();
      case 2:
        return run.template operator()<P, 2>();
      case 3:
        return run.template operator()<P, 3>();
      default:
        return run.template operator()<-1, -1>();
    }
  };
  switch (degree_u) {
    case 1:
      return with_u.template operator()<1>();
    case 2:
      return with_u.template operator()<2>();
    case 3:
      return with_u.template operator()<3>();
    default:
      return run.template operator()<-1, -1>();
  }
}

}  // namespace facetless
