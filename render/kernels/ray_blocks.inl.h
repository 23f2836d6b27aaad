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
struct Mask {
  Bits raw;
};
inline Mask operator&(Mask a, Mask b) {
  return {a.raw & b.raw};
}
inline Mask operator|(Mask a, Mask b) {
  return {a.raw | b.raw};
}
inline Mask Less(Eight a, Eight b) {
  return {EachBit([&](int i) { return a.raw[i] < b.raw[i]; })};
}
inline Mask LessOrEqual(Eight a, Eight b) {
  return {EachBit([&](int i) { return a.raw[i] <= b.raw[i]; })};
}
inline Bits ToBits(Mask a) {
  return a.raw;
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
struct Mask {
  hn::Mask<Tag> raw;
};
HWY_INLINE Mask operator&(Mask a, Mask b) {
  return {hn::And(a.raw, b.raw)};
}
HWY_INLINE Mask operator|(Mask a, Mask b) {
  return {hn::Or(a.raw, b.raw)};
}
HWY_INLINE Mask Less(Eight a, Eight b) {
  return {hn::Lt(a.raw, b.raw)};
}
HWY_INLINE Mask LessOrEqual(Eight a, Eight b) {
  return {hn::Le(a.raw, b.raw)};
}
HWY_INLINE Bits ToBits(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Tag(), mask.raw, bytes);
  return bytes[0];
}
#endif

// The smallest component of a direction that boxes are tested with. Over any length that a float can hold, a smaller
// one moves the ray by less than the boxes' margin.
constexpr double kLeastComponent = 0x1p-60;
// Beyond this many radii, the ray's nearest point is no longer accurate to the roundoff of a float.
constexpr double kFarthest = 0x1p24;

struct BoxRay {
  // A plane at coordinate p of an axis is passed at p·inverse + offset.
  Eight near_inverse[3], far_inverse[3], near_offset[3], far_offset[3];
  int near_side[3], far_side[3];  // where the sides of a node begin, in floats
  Eight length;
};

inline BoxRay MakeBoxRay(const RayBlocks& blocks, const BlockRay& ray) {
  BoxRay box;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis];
    const double component =
        std::fabs(d) < kLeastComponent ? (d < 0 ? -kLeastComponent : kLeastComponent) : d;
    const double inverse = 1 / component;
    // The roundings of the inverse and of the sum are below 2^-22 together. Those of the start and of the offset move the
    // ray by less than the boxes' margin.
    const float origin = static_cast<float>(ray.origin[axis] - blocks.center[axis]);
    const float near = static_cast<float>(inverse * (1 - 0x1p-21)),
                far = static_cast<float>(inverse * (1 + 0x1p-21));
    box.near_inverse[axis] = All(near);
    box.far_inverse[axis] = All(far);
    box.near_offset[axis] = All(-origin * near);
    box.far_offset[axis] = All(-origin * far);
    box.near_side[axis] = ((d < 0 ? 3 : 0) + axis) * kBlockLanes;
    box.far_side[axis] = ((d < 0 ? 0 : 3) + axis) * kBlockLanes;
  }
  const double most = 0x1p120;
  box.length = All(static_cast<float>(std::min(ray.length * (1 + 0x1p-20), most)));
  return box;
}

// Returns the children that the ray meets.
inline Bits MeetChildren(const RayNode& node, const BoxRay& ray) {
  const float* const sides = &node.side[0][0][0];
  const auto enter = [&](int axis) {
    return Fma(Load(sides + ray.near_side[axis]), ray.near_inverse[axis], ray.near_offset[axis]);
  };
  const auto leave = [&](int axis) {
    return Fma(Load(sides + ray.far_side[axis]), ray.far_inverse[axis], ray.far_offset[axis]);
  };
  const Eight in = Greater(Greater(enter(0), enter(1)), Greater(enter(2), All(0)));
  const Eight out = Smaller(Smaller(leave(0), leave(1)), Smaller(leave(2), ray.length));
  return ToBits(LessOrEqual(in, out));
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
  const Mask steep = LessOrEqual(least, size_z);
  // tau0 = −o_z/d_z; where the ray is not steep, its value is not used.
  const Eight one = All(1), zero = All(0);
  const Eight inverse = one / Greater(size_z, least);
  const Eight tau = zero - (oz * inverse) * (dz * inverse);  // within five roundings: d_z/|d_z|² is 1/d_z
  const Eight k = h * inverse;
  const Eight x = Abs(Fma(tau, dx, ox)), y = Abs(Fma(tau, dy, oy));
  const Eight mx = k * Abs(dx), my = k * Abs(dy);
  const Mask misses = Less(one + mx, x) | Less(one + my, y) |
                      Less(tau + k, All(static_cast<float>(low - guard))) |
                      Less(All(static_cast<float>(high + guard)), tau - k);
  // The trim line: law 3.
  const Eight a = Load(block.line_a), b = Load(block.line_b);
  const Eight value = Fma(a, Fma(tau, dx, ox), Fma(b, Fma(tau, dy, oy), Load(block.line_c)));
  const Eight width = Fma(Abs(a), mx, Fma(Abs(b), my, Load(block.line_w)));
  const Mask holds = LessOrEqual(Load(block.line_dz), size_z);
  const Mask away = Less(value, zero - width) & holds;
  const Mask kept = Less(width, value) & holds;
  const Mask inside = Less(x + mx, Load(block.inner_x)) & Less(y + my, Load(block.inner_y)) &
                      Less(All(static_cast<float>(low + own)), tau - k) &
                      Less(tau + k, All(static_cast<float>(high - guard))) &
                      LessOrEqual(Abs(tau), All(static_cast<float>(1.25 * radius)));
  if (every) {
    // A lower bound of the distance of the points in the slab. Rounding is below 2^-22 of it.
    const Eight distance = tau - k + All(static_cast<float>(to_center - guard));
    Save(distance - Abs(distance) * All(0x1p-21f), near);
    // The value of a ray that is not steep is not used.
    const Bits lanes = ToBits(steep);
    for (int lane = 0; lane < kBlockLanes; ++lane)
      if ((lanes >> lane & 1) == 0) near[lane] = 0;
  } else if ((ToBits(inside & kept & steep) & used) != 0) {
    *blocked = true;
    return 0;
  }
  const Bits steep_lanes = ToBits(steep), missed = ToBits(misses | away);
  Bits open = steep_lanes & ~missed;
  if (steep_lanes != 0xffu) {
    // Rays that are nearly parallel to the slab: law 6.
    const Mask beside = Less(Fma(All(static_cast<float>(1.001 * radius)), least, h), Abs(oz));
    open |= ~steep_lanes & ~ToBits(beside);
  }
  return open & used;
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
      // In any order: most rays are clear, and see all that they meet.
      const RayNode& node = blocks.nodes[at];
      for (Bits met = MeetChildren(node, box); met != 0; met &= met - 1)
        stack[waiting++] = node.child[__builtin_ctz(met)];
    }
    if (waiting == 0) return;
    at = stack[--waiting];
  }
}

}  // namespace kernel_scalar, or kernel_avx2
}  // namespace facetless
