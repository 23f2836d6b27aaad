// Patches and rays for tests of solvers, and an evaluation that shares no code with them.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "render/solve/solver.h"
#include "render/solve/solver_scene.h"
#include "render/view/camera.h"

namespace facetless::testing {

inline constexpr int kSheetPixels = 200;  // width and height of the pictures

// A view from the front onto the cube of 100 mm around the origin.
CameraFrame SheetFrame(bool perspective);

struct Sheet {
  int degree_u = 1, degree_v = 1;
  std::vector<Vec4> points;  // homogeneous, v fastest
};
// A patch that faces the eye and fills most of the picture. Its control points are off the even grid by up to `noise` of
// the distance between neighbours, and in depth by `depth` times as much. Weights lie in [1/spread, spread].
struct SheetShape {
  double noise = 0.2, depth = 1, spread = 1;
};
Sheet MakeSheet(int degree_u, int degree_v, const SheetShape& shape, std::uint64_t seed);
// A patch whose control points lie anywhere in the cube, or behind the eye, with weights over twelve decades.
Sheet WildSheet(int degree_u, int degree_v, std::uint64_t seed);

SolverScene SceneOf(const CameraFrame& frame, const Sheet& sheet);

// The point of a patch in space, relative to the scene's origin, by de Casteljau's algorithm in extended precision.
struct ExtendedPoint {
  long double x = 0, y = 0, z = 0;
};
ExtendedPoint PointOn(const SolverScene& scene, std::uint32_t patch, double u, double v);
// Its pixel coordinates relative to the image centre, and its depth.
ExtendedPoint OnScreen(const SolverScene& scene, const ExtendedPoint& point);
// The distance of a root from the ray, in pixels.
double PixelsOff(const SolverScene& scene, const SolverRay& ray, const SolverRoot& root);

// The ray through pixel coordinates relative to the image centre.
SolverRay RayThrough(const SolverScene& scene, double x, double y);
// The ray through the point of a patch.
SolverRay RayTo(const SolverScene& scene, std::uint32_t patch, double u, double v);

// Prepares a solver by name. Throws if that fails.
std::unique_ptr<const Solver> MakeSolver(const std::string& name, const SolverScene& scene);
// A start with the whole surface as its piece.
SolverStart StartAt(std::uint32_t surface, double u, double v, bool from_map);

// The sum of the counted ends.
std::uint64_t Ends(const SolverCounters& counters);

}  // namespace facetless::testing
