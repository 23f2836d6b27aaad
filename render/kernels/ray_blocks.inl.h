// The visit of ray blocks (ray_blocks.h), written once and compiled for each instruction set: eight floats are one
// register of AVX2.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/kernels/ray_blocks.h"

#if !defined(FACETLESS_SCALAR_KERNEL)
#include <hwy/highway.h>
#endif

namespace facetless {

#if defined(FACETLESS_SCALAR_KERNEL)
namespace kernel_scalar {
namespace {

struct Eight {
  float raw[kBlockLanes];
};
using Bits = unsigned;

template <typename F>
Eight Each(F&& f) {
  Eight r;
  for (int i = 0; i < kBlockLanes; ++i) r.raw[i] = f(i);
  return r;
}
template <typename F>
Bits EachBit(F&& f) {
  Bits bits = 0;
  for (int i = 0; i < kBlockLanes; ++i) bits |= static_cast<Bits>(f(i) ? 1u : 0u) << i;
  return bits;
}
inline Eight Load(const float* p) {
  return Each([&](int i) { return p[i]; });
}
inline Eight All(float x) {
  return Each([&](int) { return x; });
}
inline void Save(Eight a, float* p) {
  for (int i = 0; i < kBlockLanes; ++i) p[i] = a.raw[i];
}
inline Eight operator+(Eight a, Eight b) {
  return Each([&](int i) { return a.raw[i] + b.raw[i]; });
}
inline Eight operator-(Eight a, Eight b) {
  return Each([&](int i) { return a.raw[i] - b.raw[i]; });
}
inline Eight operator*(Eight a, Eight b) {
  return Each([&](int i) { return a.raw[i] * b.raw[i]; });
}
inline Eight operator/(Eight a, Eight b) {
  return Each([&](int i) { return a.raw[i] / b.raw[i]; });
}
inline Eight Fma(Eight a, Eight b, Eight c) {
  return Each([&](int i) { return std::fma(a.raw[i], b.raw[i], c.raw[i]); });
}
inline Eight Abs(Eight a) {
  return Each([&](int i) { return std::fabs(a.raw[i]); });
}
inline Eight Greater(Eight a, Eight b) {
  return Each([&](int i) { return a.raw[i] > b.raw[i] ? a.raw[i] : b.raw[i]; });
}
inline Eight Smaller(Eight a, Eight b) {
  return Each([&](int i) { return a.raw[i] < b.raw[i] ? a.raw[i] : b.raw[i]; });
}
inline Bits Less(Eight a, Eight b) {
  return EachBit([&](int i) { return a.raw[i] < b.raw[i]; });
}
inline Bits LessOrEqual(Eight a, Eight b) {
  return EachBit([&](int i) { return a.raw[i] <= b.raw[i]; });
}

#else
namespace kernel_avx2 {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kBlockLanes>;
struct Eight {
  hn::Vec<Tag> raw;
};
using Bits = unsigned;

HWY_INLINE Eight Load(const float* p) {
  return {hn::LoadU(Tag(), p)};
}
HWY_INLINE Eight All(float x) {
  return {hn::Set(Tag(), x)};
}
HWY_INLINE void Save(Eight a, float* p) {
  hn::StoreU(a.raw, Tag(), p);
}
HWY_INLINE Eight operator+(Eight a, Eight b) {
  return {hn::Add(a.raw, b.raw)};
}
HWY_INLINE Eight operator-(Eight a, Eight b) {
  return {hn::Sub(a.raw, b.raw)};
}
HWY_INLINE Eight operator*(Eight a, Eight b) {
  return {hn::Mul(a.raw, b.raw)};
}
HWY_INLINE Eight operator/(Eight a, Eight b) {
  return {hn::Div(a.raw, b.raw)};
}
HWY_INLINE Eight Fma(Eight a, Eight b, Eight c) {
  return {hn::MulAdd(a.raw, b.raw, c.raw)};
}
HWY_INLINE Eight Abs(Eight a) {
  return {hn::Abs(a.raw)};
}
// Nothing that is compared here is a NaN.
HWY_INLINE Eight Greater(Eight a, Eight b) {
  return {hn::Max(a.raw, b.raw)};
}
HWY_INLINE Eight Smaller(Eight a, Eight b) {
  return {hn::Min(a.raw, b.raw)};
}
HWY_INLINE Bits ToBits(hn::Mask<Tag> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Tag(), mask, bytes);
  return bytes[0];
}
HWY_INLINE Bits Less(Eight a, Eight b) {
  return ToBits(hn::Lt(a.raw, b.raw));
}
HWY_INLINE Bits LessOrEqual(Eight a, Eight b) {
  return ToBits(hn::Le(a.raw, b.raw));
}
#endif

// The smallest component of a direction that boxes are tested with. Over any length that a float can hold, a smaller
// one moves the ray by less than the boxes' margin.
constexpr double kLeastComponent = 0x1p-60;
// Beyond this many radii, the ray's nearest point is no longer accurate to the roundoff of a float.
constexpr double kFarthest = 0x1p24;

struct BoxRay {
  Eight origin[3], near_inverse[3], far_inverse[3];
  int near_side[3];
  float length;
};

inline BoxRay MakeBoxRay(const RayBlocks& blocks, const BlockRay& ray) {
  BoxRay box;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis];
    const double component =
        std::fabs(d) < kLeastComponent ? (d < 0 ? -kLeastComponent : kLeastComponent) : d;
    const double inverse = 1 / component;
    box.origin[axis] = All(static_cast<float>(ray.origin[axis] - blocks.center[axis]));
    // The roundings of the inverse, of the difference and of their product are below 2^-22 together.
    box.near_inverse[axis] = All(static_cast<float>(inverse * (1 - 0x1p-21)));
    box.far_inverse[axis] = All(static_cast<float>(inverse * (1 + 0x1p-21)));
    box.near_side[axis] = d < 0 ? 1 : 0;
  }
  const double most = 0x1p120;
  box.length = static_cast<float>(std::min(ray.length * (1 + 0x1p-20), most));
  return box;
}

// Returns the children whose boxes the ray meets, and sets `enter` to the distances at which the ray enters them.
inline Bits MeetChildren(const RayNode& node, const BoxRay& ray, float* enter) {
  const auto pass = [&](int axis, bool near) {
    const int side = near ? ray.near_side[axis] : 1 - ray.near_side[axis];
    return (Load(node.side[side][axis]) - ray.origin[axis]) *
           (near ? ray.near_inverse[axis] : ray.far_inverse[axis]);
  };
  const Eight in = Greater(Greater(pass(0, true), pass(1, true)), Greater(pass(2, true), All(0)));
  const Eight out =
      Smaller(Smaller(pass(0, false), pass(1, false)), Smaller(pass(2, false), All(ray.length)));
  Save(in, enter);
  return LessOrEqual(in, out);
}

// Tests the pieces of a block. Returns the open lanes, and sets *blocked if a piece is proven to block the ray. If
// `every` is set, such a piece is open, too, and `near` is set for each lane.
inline Bits TestBlock(const RayBlock& block, const BlockRay& ray, bool every, bool* blocked, float* near) {
  // Move the ray to the point that is nearest to the block's centre.
  double start[3], to_center = 0;
  for (int axis = 0; axis < 3; ++axis) {
    start[axis] = ray.origin[axis] - block.center[axis];
    to_center -= start[axis] * ray.direction[axis];
  }
  const double radius = block.radius;
  const Bits used = (1u << block.count) - 1;
  if (!(std::fabs(to_center) <= kFarthest * radius)) {
    // The block is missed if it is behind the start or beyond the end. Otherwise, it is too small for single
    // precision, and all of its pieces are open.
    if (every) Save(All(0), near);
    return to_center < -2 * radius || to_center > ray.length + 2 * radius ? 0 : used;
  }
  Eight o[3], d[3];
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double moved = std::fma(to_center, ray.direction[axis], start[axis]);
    square += moved * moved;
    o[axis] = All(static_cast<float>(moved));
    d[axis] = All(static_cast<float>(ray.direction[axis]));
  }
  if (square > radius * radius * (1 + 0x1p-16)) return 0;
  // The interval of tau. Its ends are limited to a few radii, because no root lies beyond them.
  const double guard = 0x1p-20 * radius, own = std::max(guard, 0x1p13 * ray.own_error);
  const double low = std::max(-to_center, -4 * radius), high = std::min(ray.length - to_center, 4 * radius);
  if (high < low) return 0;

  const auto row = [&](int r, const Eight* v) {
    return Fma(Load(block.row[r][0]), v[0], Fma(Load(block.row[r][1]), v[1], Load(block.row[r][2]) * v[2]));
  };
  const Eight dx = row(0, d), dy = row(1, d), dz = row(2, d);
  const auto place = [&](int r) {
    return Fma(Load(block.row[r][0]), o[0],
               Fma(Load(block.row[r][1]), o[1], Fma(Load(block.row[r][2]), o[2], Load(block.offset[r]))));
  };
  const Eight ox = place(0), oy = place(1), oz = place(2);
  const Eight h = Load(block.h), size_z = Abs(dz), least = Load(block.least_dz);
  const Bits steep = LessOrEqual(least, size_z);
  // Rays that are nearly parallel to the slab: law 6.
  const Bits beside = Less(Fma(All(static_cast<float>(1.001 * radius)), least, h), Abs(oz));
  const Eight divisor = Greater(size_z, least);
  // tau0 = −o_z/d_z; where the ray is not steep, its value is not used.
  const Eight one = All(1), zero = All(0);
  const Eight safe = dz * (one / (divisor * divisor));  // sign(d_z)/|d_z|, within two roundings
  const Eight tau = zero - oz * safe;
  const Eight k = h / divisor;
  const Eight x = Abs(Fma(tau, dx, ox)), y = Abs(Fma(tau, dy, oy));
  const Eight mx = k * Abs(dx), my = k * Abs(dy);
  const Bits misses = Less(one + mx, x) | Less(one + my, y) |
                      Less(tau + k, All(static_cast<float>(low - guard))) |
                      Less(All(static_cast<float>(high + guard)), tau - k);
  // The trim line: law 3.
  const Eight a = Load(block.line_a), b = Load(block.line_b);
  const Eight value = Fma(a, Fma(tau, dx, ox), Fma(b, Fma(tau, dy, oy), Load(block.line_c)));
  const Eight width = Fma(Abs(a), mx, Fma(Abs(b), my, Load(block.line_w)));
  const Bits holds = LessOrEqual(Load(block.line_dz), size_z);
  const Bits away = Less(value, zero - width) & holds;
  const Bits kept = Less(width, value) & holds;
  const Bits inside = Less(x + mx, Load(block.inner_x)) & Less(y + my, Load(block.inner_y)) &
                      Less(All(static_cast<float>(low + own)), tau - k) &
                      Less(tau + k, All(static_cast<float>(high - guard))) &
                      LessOrEqual(Abs(tau), All(static_cast<float>(1.25 * radius)));
  if (every) {
    // A lower bound of the distance of the points in the slab. Rounding is below 2^-22 of it.
    const Eight distance = tau - k + All(static_cast<float>(to_center - guard));
    Save(distance - Abs(distance) * All(0x1p-21f), near);
    if (steep != 0xffu)
      for (int lane = 0; lane < kBlockLanes; ++lane)
        if ((steep >> lane & 1) == 0) near[lane] = 0;
  } else if ((inside & kept & steep & used) != 0) {
    *blocked = true;
    return 0;
  }
  return used & ~(steep & (misses | away)) & ~(~steep & beside);
}

}  // namespace

void VisitRayBlocks(const RayBlocks& blocks, const BlockRay& ray, BlockVisit* visit) {
  visit->blocked = visit->overflow = false;
  visit->open_count = 0;
  if (blocks.node_count == 0) return;
  const BoxRay box = MakeBoxRay(blocks, ray);
  std::uint32_t stack[kDeepestBlocks * kBlockLanes];
  int waiting = 0;
  std::uint32_t at = 0;
  for (;;) {
    if ((at & kBlockBit) != 0) {
      const std::uint32_t index = at & ~kBlockBit;
      if (visit->open_count == kMostOpen) {
        visit->overflow = true;
        return;
      }
      const Bits open =
          TestBlock(blocks.blocks[index], ray, visit->every, &visit->blocked, visit->near[visit->open_count]);
      if (visit->blocked) return;
      if (open != 0) {
        visit->open[visit->open_count++] = {index, open};
      }
    } else {
      // Continue with the child that the ray enters first; the others wait.
      const RayNode& node = blocks.nodes[at];
      float enter[kBlockLanes];
      Bits met = MeetChildren(node, box, enter);
      if (met != 0) {
        int first = __builtin_ctz(met);
        for (met &= met - 1; met != 0; met &= met - 1) {
          int next = __builtin_ctz(met);
          if (enter[next] < enter[first]) std::swap(next, first);
          stack[waiting++] = node.child[next];
        }
        at = node.child[first];
        continue;
      }
    }
    if (waiting == 0) return;
    at = stack[--waiting];
  }
}

}  // namespace kernel_scalar, or kernel_avx2
}  // namespace facetless
