// Tensor-product Bézier nets with several components. net_operations.h has the operations that are applied to
// every net. This file has those that few nets need: extending, and conversion to centred monomials.
//
//  1. A net has (degree_u+1)·(degree_v+1) coefficients in u-major order, with the components of a coefficient
//     next to each other: value[kNetComponents·(k·(degree_v+1) + l) + c].
//  2. Extending a net leaves the coefficients of a border that does not move unchanged.
//  3. All functions multiply and add in a fixed order and give the same bytes on every machine.
//  4. `error[c]` bounds the distance between each coefficient of component c and that of the exact surface.
//     The code that fills a net sets it, and halving adds its own rounding error.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "render/model/model.h"

namespace facetless {

inline constexpr int kMaxNetPoints = (kMaxDegree + 1) * (kMaxDegree + 1);

// The components of a projected net, in this order. view/projection.h defines them.
enum NetComponent : int { kX = 0, kY = 1, kW = 2, kQ = 3, kNetComponents = 4 };

struct BezierNet {
  int degree_u = 1, degree_v = 1;
  double* value = nullptr;  // the caller owns the storage
  double error[kNetComponents] = {};
  int points() const { return (degree_u + 1) * (degree_v + 1); }
  int stride() const { return degree_v + 1; }
  // Component `c` of coefficient `i`.
  double at(int i, NetComponent c) const { return value[kNetComponents * i + c]; }
  double& at(int i, NetComponent c) { return value[kNetComponents * i + c]; }
};

enum class Direction : unsigned char { kU, kV };

// A net that owns its storage, for code that uses many nets one after another.
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

// Re-expresses component `c` of `net` and its error over [−low, 1 + high] of the parameter of one direction.
// Requires low, high >= 0. Both should be small, because extrapolation multiplies rounding errors by
// (1 + 2·(low + high))^degree.
void Extend(BezierNet* net, NetComponent c, Direction direction, double low, double high);

// Row i of the matrix maps the degree+1 Bernstein coefficients over [0,1] to the coefficient of s^i, where
// s = 2t − 1 ∈ [−1,1]. The entries are integers times 2^−degree, and therefore exact.
using MonomialMatrix = std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1>;
const MonomialMatrix& CenteredMonomialMatrix(int degree);

// The largest degree for which loops of constant length are compiled. Most surfaces have no higher degree.
inline constexpr int kMaxFixedDegree = 3;

// The highest degree along v that is a compile-time constant on its own.
inline constexpr int kMaxFixedInnerDegree = 7;

// Calls run.template operator()<P, Q>() with the degrees as compile-time constants if both lie in
// [1, kMaxFixedDegree]. Otherwise P is −1, and Q is degree_v if that lies in [1, kMaxFixedInnerDegree], else −1; −1
// means that the degree is not a constant. The loops along v are the inner ones. Loops of constant length take half the
// time.
template <typename Run>
inline auto ByDegrees(int degree_u, int degree_v, const Run& run) {
  // The switches are nested, because a single key packed from both degrees could collide with another pair.
  const auto with_u = [&]<int P>() {
    switch (degree_v) {
      case 1:
        return run.template operator()<P, 1>();
      case 2:
        return run.template operator()<P, 2>();
      default:
        return run.template operator()<P, 3>();
    }
  };
  const auto with_v = [&] {
    switch (degree_v) {
      case 1:
        return run.template operator()<-1, 1>();
      case 2:
        return run.template operator()<-1, 2>();
      case 3:
        return run.template operator()<-1, 3>();
      case 4:
        return run.template operator()<-1, 4>();
      case 5:
        return run.template operator()<-1, 5>();
      case 6:
        return run.template operator()<-1, 6>();
      case 7:
        return run.template operator()<-1, 7>();
      default:
        return run.template operator()<-1, -1>();
    }
  };
  if (degree_v < 1 || degree_v > kMaxFixedDegree) return with_v();
  switch (degree_u) {
    case 1:
      return with_u.template operator()<1>();
    case 2:
      return with_u.template operator()<2>();
    case 3:
      return with_u.template operator()<3>();
    default:
      return with_v();
  }
}

}  // namespace facetless
