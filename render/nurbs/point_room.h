// Room for the control points of a curve of any degree, which is not initialised: clearing it would cost more than what
// is done with the points of most curves.
//
//     PointRoom room;
//     Vec3* const p = room.points;
#pragma once

#include "render/base/vec.h"

namespace facetless {

struct PointRoom {
  static constexpr int kMost = 256;  // the degree is 8 bits wide

  PointRoom() {}  // NOLINT: leaves the points as they are
  union {
    Vec3 points[kMost];
  };
};

}  // namespace facetless
