// LeafPlace: the piece of a patch that a leaf covers. A leaf results from halvings of its patch. The place
// stores the halvings in 16 bytes, and the rectangle of Bézier parameters follows from them.
//
//  1. RectOf repeats the halvings in the order of the calls of Halved. Its rectangle is bitwise equal to that
//     of a splitter that halves at the middle.
//  2. A patch is halved at most kMostPatchHalvings times, in both directions together.
#pragma once

#include <cstdint>

#include "render/nurbs/bezier.h"

namespace facetless {

inline constexpr int kMostPatchHalvings = 64;

// The Bézier parameters that a patch covers. They extend beyond [0,1] where the patch is continued past the
// border of its face.
struct PatchBounds {
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
};

// A rectangle of Bézier parameters of a patch: s, t ∈ [−1,1] of a leaf are mid + s·half.
struct ParameterRect {
  double u_mid = 0.5, u_half = 0.5, v_mid = 0.5, v_half = 0.5;

  double U(double s) const { return u_mid + s * u_half; }
  double V(double t) const { return v_mid + t * v_half; }
};

struct LeafPlace {
  // One bit per halving, set if the upper half was taken. The halvings in u are in the lowest bits, the last
  // one lowest; those in v are above them.
  std::uint64_t path = 0;
  std::uint32_t patch = 0;  // index within its surface
  std::uint8_t u_halvings = 0, v_halvings = 0;
};

// Requires fewer than kMostPatchHalvings halvings so far.
inline LeafPlace Halved(LeafPlace place, Direction direction, bool upper) {
  if (direction == Direction::kU) {
    place.path = place.path << 1 | std::uint64_t{upper};
    ++place.u_halvings;
  } else {
    const std::uint64_t u = place.path & ((std::uint64_t{1} << place.u_halvings) - 1);
    const std::uint64_t v = place.path >> place.u_halvings;
    place.path = u | (v << 1 | std::uint64_t{upper}) << place.u_halvings;
    ++place.v_halvings;
  }
  return place;
}

inline ParameterRect RectOf(const LeafPlace& place, const PatchBounds& bounds) {
  ParameterRect rect{0.5 * (bounds.u_low + bounds.u_high), 0.5 * (bounds.u_high - bounds.u_low),
                     0.5 * (bounds.v_low + bounds.v_high), 0.5 * (bounds.v_high - bounds.v_low)};
  for (int k = place.u_halvings - 1; k >= 0; --k) {
    rect.u_half *= 0.5;
    rect.u_mid += place.path >> k & 1 ? rect.u_half : -rect.u_half;
  }
  for (int k = place.u_halvings + place.v_halvings - 1; k >= place.u_halvings; --k) {
    rect.v_half *= 0.5;
    rect.v_mid += place.path >> k & 1 ? rect.v_half : -rect.v_half;
  }
  return rect;
}

}  // namespace facetless
