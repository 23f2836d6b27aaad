// Models and views for the rows, made by hand.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/model/model.h"
#include "render/view/camera.h"
#include "tests/support/shapes.h"

namespace facetless::extremes {

// One Bézier patch; `points` are (w·x, w·y, w·z, w), v runs fastest.
testing::PatchGrid BezierPatch(int degree_u, int degree_v, std::vector<Vec4> points);
// The graph of a bumpy height over the square [0, size]². `weight(k, l)` gives the weight of each point.
testing::PatchGrid BumpyPatch(int degree_u, int degree_v, double size,
                              const std::function<double(int, int)>& weight = nullptr);
// A uniform bicubic B-spline with count × count control points: waves over the square [0, size]².
testing::PatchGrid WavySheet(int count, double size);
// Divides `grid`, one patch with linear maps, at the given u (ascending, within its span) by the blossom.
testing::PatchGrid CutAt(const testing::PatchGrid& grid, const std::vector<double>& cuts);
// Applies `map` to every control point.
testing::PatchGrid Mapped(testing::PatchGrid grid, const std::function<Vec3(Vec3)>& map);

// A sphere, a torus and a frustum of a cone side by side, 8·size wide.
std::vector<testing::PatchGrid> ThreeSolids(Vec3 center, double size);

Camera Orthographic(std::string name, Vec3 eye, Vec3 target, Vec3 up, double height, int width_px,
                    int height_px);
Camera Perspective(std::string name, Vec3 eye, Vec3 target, Vec3 up, double fov_y_deg, int width_px,
                   int height_px);
// Returns the named views, in both projections.
std::vector<Camera> NamedViews(const Model& model, const std::vector<std::string>& names, int size);
// Returns the named orthographic view through a window of the given size in mm around a point.
Camera CloseTo(const Model& model, const std::string& name, Vec3 point, double window, int size);
// The same view from the opposite side of its target.
Camera FromBehind(Camera camera);

}  // namespace facetless::extremes
