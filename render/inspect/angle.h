// Angles between directions, the same bits on every machine: no libm but sqrt.
#pragma once

#include "render/base/vec.h"

namespace facetless {

// Degrees between two unit vectors, 0 … 180, to a few units in the last place at every angle: cosines lose
// small ones.
double AngleDeg(Vec3 a, Vec3 b);

// Degrees by which a surface with this outward unit normal opens along `pull`, −90 … 90: 0 is a wall along
// it, negative an undercut.
double DraftDeg(Vec3 normal, Vec3 pull);

// Degrees from the axis x to the vector, −180 … 180; 180 for the zero vector.
double TurnDeg(Vec2 v);

// The sine of −90 … 90 degrees.
double SineOfDeg(double degrees);

}  // namespace facetless
