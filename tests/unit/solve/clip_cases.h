// Patches, views and rays for the tests of clipping, with roots that are known by construction.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

#include "render/solve/solver.h"
#include "render/solve/solver_scene.h"

namespace facetless::testing::clip {

// A number in [low, high), the same with every standard library.
double Draw(std::mt19937_64& engine, double low, double high);
int DrawDegree(std::mt19937_64& engine);  // 1 … kMaxDegree

// A camera of 400 × 300 pixels that looks at the origin from a random direction and sees about 200 mm.
CameraFrame DrawView(std::mt19937_64& engine);
// An orthographic view along −Z with one pixel per mm: pixel coordinates relative to the centre are (x, −y).
CameraFrame PlainView();

// A patch around the origin, about 100 mm wide, in a random orientation. Control points are off an even grid by up to
// `bump` of the distance between neighbours in the plane, and by `bump` of the width out of the plane. Weights lie in
// [1/spread, spread].
std::vector<Vec4> DrawNet(int degree_u, int degree_v, double bump, double spread, std::mt19937_64& engine);

// The patch with z = 0 whose pixel coordinates in PlainView are these, which are polynomials of degree 2 in u and in v,
// given by their values at the nine points of {0, ½, 1}², v fastest.
std::vector<Vec4> Biquadratic(double (*x)(double, double), double (*y)(double, double));

// The ray through pixel coordinates relative to the image centre.
SolverRay RayThrough(const SolverScene& scene, double x, double y);
// The ray through the point of a patch, evaluated in extended precision.
SolverRay RayTo(const SolverScene& scene, std::uint32_t patch, double u, double v);
// The distance of a root from the ray, in pixels, evaluated in extended precision.
double Distance(const SolverScene& scene, const SolverRay& ray, const SolverRoot& root);
// How well the root at (u,v) is conditioned: the sine of the angle between the derivatives on the screen, times the shorter
// of the two, in pixels.
double Condition(const SolverScene& scene, std::uint32_t patch, double u, double v);

// Prepares a solver. Throws if that fails.
std::unique_ptr<const Solver> Prepared(std::string_view name, const SolverScene& scene);

struct Answer {
  std::vector<SolverRoot> roots;
  SolverCounters counters;
  std::int64_t work = 0;
};
// Solves a ray on a patch, with a state of its own.
Answer Ask(const Solver& solver, const SolverRay& ray, std::uint32_t patch = 0);
std::uint64_t Stops(const Answer& answer, SolverStop stop);
// The roots within `distance` of parameters.
int RootsNear(const Answer& answer, double u, double v, double distance);

}  // namespace facetless::testing::clip
