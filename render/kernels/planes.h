// Planes: the four components (X, Y, W, Q) of one point of a projected net, for code that treats them alike.
// The code is written once and compiled for each instruction set.
//
//  1. Every operation rounds according to IEEE 754 and gives the same bits on every target. No operation is
//     fused.
//  2. The target follows from the compiler flags of the file that includes this: Highway's AVX2, or plain C++
//     with FACETLESS_SCALAR_KERNEL. Everything is in a namespace of its own for each target.
#pragma once

#include <cmath>

#include "render/nurbs/bezier.h"

#if !defined(FACETLESS_SCALAR_KERNEL)
#include <hwy/highway.h>
#endif

#if defined(FACETLESS_SCALAR_KERNEL)
#define FACETLESS_PLANES_NAMESPACE kernel_scalar
namespace facetless::FACETLESS_PLANES_NAMESPACE {

struct Planes {
  double raw[kNetComponents];
};
template <typename Operation>
inline Planes Each(const Operation& operation) {
  return {{operation(0), operation(1), operation(2), operation(3)}};
}
inline Planes LoadPlanes(const double* p) {
  return {{p[0], p[1], p[2], p[3]}};
}
inline void Store(Planes a, double* p) {
  for (int c = 0; c < kNetComponents; ++c) p[c] = a.raw[c];
}
inline Planes Same(double x) {
  return {{x, x, x, x}};
}
// One component, copied to all four places.
template <NetComponent C>
inline Planes Spread(Planes a) {
  return Same(a.raw[C]);
}
// X and Y of the first, W and Q of the second.
inline Planes Join(Planes xy, Planes wq) {
  return {{xy.raw[0], xy.raw[1], wq.raw[2], wq.raw[3]}};
}
inline Planes operator+(Planes a, Planes b) {
  return Each([&](int c) { return a.raw[c] + b.raw[c]; });
}
inline Planes operator-(Planes a, Planes b) {
  return Each([&](int c) { return a.raw[c] - b.raw[c]; });
}
inline Planes operator*(Planes a, Planes b) {
  return Each([&](int c) { return a.raw[c] * b.raw[c]; });
}
inline Planes operator/(Planes a, Planes b) {
  return Each([&](int c) { return a.raw[c] / b.raw[c]; });
}
inline Planes Abs(Planes a) {
  return Each([&](int c) { return std::fabs(a.raw[c]); });
}
// The minimum and the maximum, as std::min and std::max: a NaN in b is ignored.
inline Planes Min(Planes a, Planes b) {
  return Each([&](int c) { return b.raw[c] < a.raw[c] ? b.raw[c] : a.raw[c]; });
}
inline Planes Max(Planes a, Planes b) {
  return Each([&](int c) { return a.raw[c] < b.raw[c] ? b.raw[c] : a.raw[c]; });
}
// The maximum, in which a NaN in b is kept.
inline Planes Grown(Planes a, Planes b) {
  return Each([&](int c) { return b.raw[c] <= a.raw[c] ? a.raw[c] : b.raw[c]; });
}

#else
#if HWY_STATIC_TARGET != HWY_AVX2
#error "planes are built for AVX2 and for plain C++"
#endif
#define FACETLESS_PLANES_NAMESPACE kernel_avx2
namespace facetless::FACETLESS_PLANES_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using PlanesTag = hn::FixedTag<double, kNetComponents>;
struct Planes {
  hn::Vec<PlanesTag> raw;
};
HWY_INLINE Planes LoadPlanes(const double* p) {
  return {hn::LoadU(PlanesTag(), p)};
}
HWY_INLINE void Store(Planes a, double* p) {
  hn::StoreU(a.raw, PlanesTag(), p);
}
HWY_INLINE Planes Same(double x) {
  return {hn::Set(PlanesTag(), x)};
}
template <NetComponent C>
HWY_INLINE Planes Spread(Planes a) {
  const PlanesTag d;
  const auto half = C < kW ? hn::ConcatLowerLower(d, a.raw, a.raw) : hn::ConcatUpperUpper(d, a.raw, a.raw);
  return {hn::Broadcast<C % 2>(half)};
}
HWY_INLINE Planes Join(Planes xy, Planes wq) {
  return {hn::ConcatUpperLower(PlanesTag(), wq.raw, xy.raw)};
}
HWY_INLINE Planes operator+(Planes a, Planes b) {
  return {hn::Add(a.raw, b.raw)};
}
HWY_INLINE Planes operator-(Planes a, Planes b) {
  return {hn::Sub(a.raw, b.raw)};
}
HWY_INLINE Planes operator*(Planes a, Planes b) {
  return {hn::Mul(a.raw, b.raw)};
}
HWY_INLINE Planes operator/(Planes a, Planes b) {
  return {hn::Div(a.raw, b.raw)};
}
HWY_INLINE Planes Abs(Planes a) {
  return {hn::Abs(a.raw)};
}
HWY_INLINE Planes Min(Planes a, Planes b) {
  return {hn::IfThenElse(hn::Lt(b.raw, a.raw), b.raw, a.raw)};
}
HWY_INLINE Planes Max(Planes a, Planes b) {
  return {hn::IfThenElse(hn::Lt(a.raw, b.raw), b.raw, a.raw)};
}
HWY_INLINE Planes Grown(Planes a, Planes b) {
  return {hn::IfThenElse(hn::Le(b.raw, a.raw), a.raw, b.raw)};
}
#endif

}  // namespace facetless::FACETLESS_PLANES_NAMESPACE
