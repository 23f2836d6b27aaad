// Angles between directions. sqrt is the only libm function used, so the bits are the same on every machine.
#pragma once

#include "render/base/vec.h"

namespace facetless {

// The angle between two unit vectors, 0 … 180 degrees. It is accurate to a few units in the last place, also
// for small angles, for which the cosine alone would be inaccurate.
double AngleDeg(Vec3 a, Vec3 b);

// The draft angle, −90 … 90 degrees, of a surface with this outward unit normal in the direction `pull`. A
// wall parallel to `pull` has 0; a negative angle is an undercut.
double DraftDeg(Vec3 normal, Vec3 pull);

// The angle from the x axis to the vector, −180 … 180 degrees; 180 for the zero vector.
double TurnDeg(Vec2 v);

// The sine of an angle of −90 … 90 degrees.
double SineOfDeg(double degrees);

}  // namespace facetless
