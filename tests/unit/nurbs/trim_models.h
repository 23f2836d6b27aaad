// Small models for tests of trimming: one face on a surface with a closed form, with loops that are given as
// curves.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "render/model/model.h"

namespace facetless::trim_models {

using Curve = std::vector<Vec3>;     // control points (w·u, w·v, w)
using Chain = std::vector<Curve>;    // the segments of one coedge
using Outline = std::vector<Chain>;  // the coedges of one loop

// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double low, double high) { return low + (high - low) * (double(engine_() >> 11) * 0x1p-53); }
  int Integer(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }

 private:
  std::mt19937_64 engine_;
};

Curve Line(Vec2 a, Vec2 b);
// A closed polygon with one coedge per side.
Outline Polygon(const std::vector<Vec2>& corners);
// Four rational quarters, counter-clockwise, in one coedge.
Outline Circle(Vec2 center, double radius);
Outline Reversed(const Outline& outline);

// The plane z = 0 with u = x, v = y in mm, over the rectangle.
Model PlaneModel(double u0, double u1, double v0, double v1);
// Half of a cylinder of that radius about z: u the angle from 0 to π in two spans, v = z from 0 to `height`.
Model HalfCylinderModel(double radius, double height);
// A unit sphere. u is the longitude from 0 to 2π in four spans, v the latitude from −π/2 to π/2 in two. The
// seam and the poles bound it.
Model SphereModel();

// Adds a loop to the only face. Each coedge gets an edge of its own: the image of its curve on the plane z =
// 0, with edge parameters from 0 to the number of segments.
void AddLoop(Model& model, const Outline& outline, double gap_mm = 0);
// The same for curves that need not meet. The model is then invalid.
void AddOpenLoop(Model& model, const Outline& outline, double gap_mm = 0);

// The even-odd rule by brute force: loops are polygons through points at equal parameters of every segment.
class Sampled {
 public:
  Sampled(const std::vector<Outline>& loops, int points_per_segment);
  bool Inside(Vec2 q) const;
  // Returns the distance to the nearest side.
  double Distance(Vec2 q) const;

 private:
  std::vector<std::vector<Vec2>> polygons_;
};

}  // namespace facetless::trim_models
