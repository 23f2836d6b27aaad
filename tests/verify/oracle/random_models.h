// Models for properties: random surfaces and trims, and solids whose faces share edges.
#pragma once

#include <cstdint>

#include "render/model/model.h"
#include "tests/verify/oracle/aim.h"

namespace facetless::oracle {

struct SurfaceRecipe {
  int degree_u = 3, degree_v = 3;  // 1 … kMaxDegree
  int spans_u = 1, spans_v = 1;
  double bump = 0.3;         // distance of control points from a square of 10 mm, as a share of its side
  double weight_spread = 1;  // weights lie between 1/spread and spread; 1: polynomial
  std::uint64_t seed = 0;    // determines everything else: knots and their multiplicities, places
};

// Returns one face: a B-spline with random interior knots of random multiplicity, divided into its Bézier
// patches.
Model RandomSurface(const SurfaceRecipe& recipe);

// Adds a loop of `corners` segments, which are lines and curves of degree 2 and 3 with weights, around the
// middle of the face's parameters. `radius` is a share of half the sides, at most 1. Holes are clockwise. The
// border has no edge.
void AddRandomLoop(Model& model, int corners, double radius, bool clockwise, std::uint64_t seed);

// Returns a solid box with its corners at ±1, placed by `placement`: six planes, twelve shared edges, eight
// vertices.
Model SolidBox(const Placement& placement);

// Returns a rotation about a random axis, a scale between 1/4 and 4, and a shift of up to 100 mm.
Placement RandomPlacement(Random& random);

}  // namespace facetless::oracle
