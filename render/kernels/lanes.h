// Lanes: a vector of Reals and its masks, for kernels that are written once and compiled for each instruction
// set and precision.
//
//  1. Every operation rounds according to IEEE 754 and gives the same bits in each lane on every target.
//     Fused operations are explicit and always fused, and no operation depends on how a target handles NaN in
//     min and max.
//  2. The target follows from the compiler flags of the file that includes this: Highway's AVX2 or AVX-512,
//     or one lane of plain C++ with FACETLESS_SCALAR_KERNEL. A Real is a double, or a float with
//     FACETLESS_FLOAT_KERNEL. Everything is in a namespace of its own for each target, so that no two files
//     define the same symbol.
//  3. A Wide holds doubles in every kernel. It is used for depths, for which a float is not precise enough.
//     Its masks are bits.
#pragma once

#include <cmath>
#include <cstdint>

#if !defined(FACETLESS_SCALAR_KERNEL)
#include <hwy/highway.h>
#endif

#if defined(FACETLESS_FLOAT_KERNEL)
#define FACETLESS_KERNEL(target) kernel_##target##_float
#else
#define FACETLESS_KERNEL(target) kernel_##target
#endif

#if defined(FACETLESS_SCALAR_KERNEL)
#define FACETLESS_KERNEL_NAMESPACE FACETLESS_KERNEL(scalar)
namespace facetless::FACETLESS_KERNEL_NAMESPACE {

#if defined(FACETLESS_FLOAT_KERNEL)
using Real = float;
#else
using Real = double;
#endif
inline constexpr int kLanes = 1;

struct Mask {
  bool raw = false;
};
struct Lane {
  Real raw = 0;
};
inline void Store(Lane v, Real* p) {
  *p = v.raw;
}
inline Lane Set(double x) {
  return {static_cast<Real>(x)};
}
inline Lane operator+(Lane a, Lane b) {
  return {a.raw + b.raw};
}
inline Lane operator-(Lane a, Lane b) {
  return {a.raw - b.raw};
}
inline Lane operator*(Lane a, Lane b) {
  return {a.raw * b.raw};
}
inline Lane operator/(Lane a, Lane b) {
  return {a.raw / b.raw};
}
inline Lane Fma(Lane a, Lane b, Lane c) {
  return {std::fma(a.raw, b.raw, c.raw)};
}  // a·b + c
inline Lane Fnma(Lane a, Lane b, Lane c) {
  return {std::fma(-a.raw, b.raw, c.raw)};
}  // c − a·b
inline Lane Abs(Lane a) {
  return {std::fabs(a.raw)};
}
// a·(x − x0) + b·(y − y0), computed in double.
inline Lane Local(const double* x, double x0, double a, const double* y, double y0, double b) {
  return {static_cast<Real>(std::fma(b, *y - y0, a * (*x - x0)))};
}
inline Mask operator<(Lane a, Lane b) {
  return {a.raw < b.raw};
}
inline Mask operator<=(Lane a, Lane b) {
  return {a.raw <= b.raw};
}
inline Mask operator&(Mask a, Mask b) {
  return {a.raw && b.raw};
}
inline Mask operator|(Mask a, Mask b) {
  return {a.raw || b.raw};
}
inline Mask AndNot(Mask a, Mask b) {
  return {!a.raw && b.raw};
}  // b without a
inline Lane Select(Mask m, Lane yes, Lane no) {
  return m.raw ? yes : no;
}
inline Mask FromBits(unsigned bits) {
  return {(bits & 1) != 0};
}
inline unsigned ToBits(Mask m) {
  return m.raw ? 1u : 0u;
}
inline bool None(Mask m) {
  return !m.raw;
}
inline Lane Sqrt(Lane a) {
  return {std::sqrt(a.raw)};
}
inline void StoreWide(Lane v, double* p) {
  *p = v.raw;
}
inline Lane LoadNarrow(const double* p) {
  return {static_cast<Real>(*p)};
}

inline constexpr int kWideLanes = 1;
struct Wide {
  double raw = 0;
};
inline Wide Load(const double* p) {
  return {*p};
}
inline void Store(Wide v, double* p) {
  *p = v.raw;
}
inline Wide SetWide(double x) {
  return {x};
}
inline Wide operator+(Wide a, Wide b) {
  return {a.raw + b.raw};
}
inline Wide operator*(Wide a, Wide b) {
  return {a.raw * b.raw};
}
inline unsigned Less(Wide a, Wide b) {
  return a.raw < b.raw ? 1u : 0u;
}
inline unsigned LessOrEqual(Wide a, Wide b) {
  return a.raw <= b.raw ? 1u : 0u;
}
inline Wide Select(unsigned bits, Wide yes, Wide no) {
  return (bits & 1) ? yes : no;
}
inline Wide Greater(Wide a, Wide b) {
  return {a.raw > b.raw ? a.raw : b.raw};
}
inline double Greatest(Wide a) {
  return a.raw;
}
// Stores the last 32 bits of integers below 2^51.
inline void StoreInteger(Wide v, std::uint32_t* p) {
  *p = static_cast<std::uint32_t>(static_cast<std::int64_t>(v.raw));
}

#else
#if HWY_STATIC_TARGET == HWY_AVX2
#define FACETLESS_KERNEL_NAMESPACE FACETLESS_KERNEL(avx2)
#elif HWY_STATIC_TARGET <= HWY_AVX3
#define FACETLESS_KERNEL_NAMESPACE FACETLESS_KERNEL(avx512)
#else
#error "a vector kernel needs a target with fused operations"
#endif
namespace facetless::FACETLESS_KERNEL_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if defined(FACETLESS_FLOAT_KERNEL)
using Real = float;
using Tag = hn::CappedTag<float, 8>;  // a packet
#else
using Real = double;
using Tag = hn::ScalableTag<double>;
#endif
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(Tag()));

struct Mask {
  hn::Mask<Tag> raw;
};
struct Lane {
  hn::Vec<Tag> raw;
};
HWY_INLINE void Store(Lane v, Real* p) {
  hn::StoreU(v.raw, Tag(), p);
}
HWY_INLINE Lane Set(double x) {
  return {hn::Set(Tag(), static_cast<Real>(x))};
}
HWY_INLINE Lane operator+(Lane a, Lane b) {
  return {hn::Add(a.raw, b.raw)};
}
HWY_INLINE Lane operator-(Lane a, Lane b) {
  return {hn::Sub(a.raw, b.raw)};
}
HWY_INLINE Lane operator*(Lane a, Lane b) {
  return {hn::Mul(a.raw, b.raw)};
}
HWY_INLINE Lane operator/(Lane a, Lane b) {
  return {hn::Div(a.raw, b.raw)};
}
HWY_INLINE Lane Fma(Lane a, Lane b, Lane c) {
  return {hn::MulAdd(a.raw, b.raw, c.raw)};
}
HWY_INLINE Lane Fnma(Lane a, Lane b, Lane c) {
  return {hn::NegMulAdd(a.raw, b.raw, c.raw)};
}
HWY_INLINE Lane Abs(Lane a) {
  return {hn::Abs(a.raw)};
}
using WideTag = hn::ScalableTag<double>;
HWY_INLINE hn::Vec<WideTag> LocalWide(const double* x, double x0, double a, const double* y, double y0,
                                      double b) {
  const WideTag d;
  const auto dx = hn::Sub(hn::LoadU(d, x), hn::Set(d, x0)), dy = hn::Sub(hn::LoadU(d, y), hn::Set(d, y0));
  return hn::MulAdd(hn::Set(d, b), dy, hn::Mul(hn::Set(d, a), dx));
}
HWY_INLINE Lane Local(const double* x, double x0, double a, const double* y, double y0, double b) {
#if !defined(FACETLESS_FLOAT_KERNEL)
  return {LocalWide(x, x0, a, y, y0, b)};
#elif HWY_STATIC_TARGET == HWY_AVX2
  const hn::Rebind<float, WideTag> half;
  return {hn::Combine(Tag(), hn::DemoteTo(half, LocalWide(x + 4, x0, a, y + 4, y0, b)),
                      hn::DemoteTo(half, LocalWide(x, x0, a, y, y0, b)))};
#else
  return {hn::DemoteTo(Tag(), LocalWide(x, x0, a, y, y0, b))};
#endif
}
HWY_INLINE Mask operator<(Lane a, Lane b) {
  return {hn::Lt(a.raw, b.raw)};
}
HWY_INLINE Mask operator<=(Lane a, Lane b) {
  return {hn::Le(a.raw, b.raw)};
}
HWY_INLINE Mask operator&(Mask a, Mask b) {
  return {hn::And(a.raw, b.raw)};
}
HWY_INLINE Mask operator|(Mask a, Mask b) {
  return {hn::Or(a.raw, b.raw)};
}
HWY_INLINE Mask AndNot(Mask a, Mask b) {
  return {hn::AndNot(a.raw, b.raw)};
}
HWY_INLINE Lane Select(Mask m, Lane yes, Lane no) {
  return {hn::IfThenElse(m.raw, yes.raw, no.raw)};
}
HWY_INLINE Mask FromBits(unsigned bits) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
  return {hn::LoadMaskBits(Tag(), bytes)};
}
HWY_INLINE unsigned ToBits(Mask m) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Tag(), m.raw, bytes);
  return bytes[0];
}
HWY_INLINE bool None(Mask m) {
  return hn::AllFalse(Tag(), m.raw);
}
HWY_INLINE Lane Sqrt(Lane a) {
  return {hn::Sqrt(a.raw)};
}

inline constexpr int kWideLanes = static_cast<int>(hn::MaxLanes(WideTag()));
struct Wide {
  hn::Vec<WideTag> raw;
};
HWY_INLINE Wide Load(const double* p) {
  return {hn::LoadU(WideTag(), p)};
}
HWY_INLINE void Store(Wide v, double* p) {
  hn::StoreU(v.raw, WideTag(), p);
}
HWY_INLINE Wide SetWide(double x) {
  return {hn::Set(WideTag(), x)};
}
HWY_INLINE Wide operator+(Wide a, Wide b) {
  return {hn::Add(a.raw, b.raw)};
}
HWY_INLINE Wide operator*(Wide a, Wide b) {
  return {hn::Mul(a.raw, b.raw)};
}
HWY_INLINE unsigned WideBits(hn::Mask<WideTag> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(WideTag(), mask, bytes);
  return bytes[0];
}
HWY_INLINE unsigned Less(Wide a, Wide b) {
  return WideBits(hn::Lt(a.raw, b.raw));
}
HWY_INLINE unsigned LessOrEqual(Wide a, Wide b) {
  return WideBits(hn::Le(a.raw, b.raw));
}
HWY_INLINE Wide Select(unsigned bits, Wide yes, Wide no) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
  return {hn::IfThenElse(hn::LoadMaskBits(WideTag(), bytes), yes.raw, no.raw)};
}
HWY_INLINE Wide Greater(Wide a, Wide b) {
  return {hn::IfThenElse(hn::Lt(b.raw, a.raw), a.raw, b.raw)};
}
HWY_INLINE double Greatest(Wide a) {
  return hn::GetLane(hn::MaxOfLanes(WideTag(), a.raw));
}
HWY_INLINE void StoreInteger(Wide v, std::uint32_t* p) {
  // The sum with 3·2^51 has the integer in its last bits.
  const hn::RebindToUnsigned<WideTag> bits;
  const hn::Rebind<std::uint32_t, WideTag> half;
  const auto sum = hn::Add(v.raw, hn::Set(WideTag(), 0x1.8p52));
  hn::StoreU(hn::TruncateTo(half, hn::BitCast(bits, sum)), half, p);
}

#if !defined(FACETLESS_FLOAT_KERNEL)
HWY_INLINE void StoreWide(Lane v, double* p) {
  Store(v, p);
}
HWY_INLINE Lane LoadNarrow(const double* p) {
  return {hn::LoadU(Tag(), p)};
}
#else
HWY_INLINE void StoreWide(Lane v, double* p) {
#if HWY_STATIC_TARGET == HWY_AVX2
  const hn::Rebind<float, WideTag> half;
  hn::StoreU(hn::PromoteTo(WideTag(), hn::LowerHalf(half, v.raw)), WideTag(), p);
  hn::StoreU(hn::PromoteTo(WideTag(), hn::UpperHalf(half, v.raw)), WideTag(), p + 4);
#else
  hn::StoreU(hn::PromoteTo(WideTag(), v.raw), WideTag(), p);
#endif
}
HWY_INLINE Lane LoadNarrow(const double* p) {
#if HWY_STATIC_TARGET == HWY_AVX2
  const hn::Rebind<float, WideTag> half;
  return {hn::Combine(Tag(), hn::DemoteTo(half, hn::LoadU(WideTag(), p + 4)),
                      hn::DemoteTo(half, hn::LoadU(WideTag(), p)))};
#else
  return {hn::DemoteTo(Tag(), hn::LoadU(WideTag(), p))};
#endif
}
#endif
#endif

}  // namespace facetless::FACETLESS_KERNEL_NAMESPACE
