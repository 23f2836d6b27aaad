// Two patches that meet along a straight edge. The smoothness at the edge has a closed form.
#pragma once

#include "render/model/model.h"

namespace facetless::testing {

// Parabolas in x, extruded along y from 0 to `width`: z = bend·x² for x in [−1, 0], and z = other_bend·x² +
// slope·x + step for x in [0, 1]. The edge at x = 0 belongs to both, and the outside is upwards. At the edge,
// the normals differ by arctan(slope). If slope is 0, the curvatures differ by 2·|bend − other_bend|.
struct Join {
  double bend = 0.2, other_bend = 0.2, slope = 0, step = 0;
  bool against = false;  // the second face is oriented the other way
};
Model Joined(const Join& join, double width = 4);

// The surface of a ball with a concentric ball cut out: one closed solid. Radii outer > inner > 0.
Model HollowBall(Vec3 center, double outer, double inner);

}  // namespace facetless::testing
