// Places at which a surface has no tangent plane, or a ray has multiple roots.
#include <cmath>

#include "tests/verify/extremes/catalogue.h"
#include "tests/verify/extremes/models.h"

namespace facetless::extremes {

using testing::Frustum;
using testing::ModelOf;
using testing::PatchGrid;
using testing::Sphere;
using testing::Torus;

namespace {

// The reasons for which a sample may be in doubt at such a place. No other face is near.
constexpr std::uint8_t kSingular =
    kDoubtPole | kDoubtTrim | kDoubtSilhouette | kDoubtTwoRoots | kDoubtUnresolved;

// Returns views with one ray exactly along the axis z through (x, y), from above and from below.
std::vector<Camera> AlongZ(double x, double y, double from) {
  const Camera above = Orthographic("above", {x, y, from}, {x, y, 0}, {0, 1, 0}, 1, 1, 1);
  const Camera below = Orthographic("below", {x, y, -from}, {x, y, 0}, {0, 1, 0}, 1, 1, 1);
  return {above, below};
}

void Append(std::vector<Camera>& to, const std::vector<Camera>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

// Returns pictures with an odd number of pixels around a point, from above and below. Their side goes from 1
// mm down to 1e-9 mm.
std::vector<Camera> ClosingIn(const Model& model, Vec3 point) {
  std::vector<Camera> views;
  for (const double window : {1.0, 1e-3, 1e-6, 1e-9}) {
    views.push_back(CloseTo(model, "top", point, window, 33));
    views.push_back(FromBehind(views.back()));
  }
  return views;
}

void AddPolesOfSolids(Rows& rows) {
  const auto sphere = [] { return ModelOf({Sphere({0, 0, 0}, 1)}); };
  const auto cone = [] { return ModelOf({Frustum({0, 0, 0}, 1, 0, 1)}); };
  rows.push_back(
      {.group = "pole",
       .input = "sphere of 1 mm, rays along the axis from outside and from the centre",
       .expected = "a hit at the pole",
       .model = sphere,
       .cameras =
           [](const Model&) {
             std::vector<Camera> views = AlongZ(0, 0, 5);
             views.push_back(Perspective("centre-up", {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 1, 1, 1));
             views.push_back(Perspective("centre-down", {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1, 1, 1));
             return views;
           },
       .certified = {0, 0, 0},
       .doubts = kSingular,
       .depth_bound_mm = 0});
  rows.push_back({.group = "pole",
                  .input = "sphere of 1 mm, the pole fills the screen: windows of 1 to 1e-9 mm",
                  .expected = "right; in doubt at the pole and on the seam only",
                  .model = sphere,
                  .cameras =
                      [](const Model& model) {
                        return ClosingIn(model, {0, 0, 1});
                      },
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-9});
  rows.push_back({.group = "pole",
                  .input = "cone of 1 mm, rays along the axis, from outside and from inside",
                  .expected = "a hit at the apex",
                  .model = cone,
                  .cameras = [](const Model&) { return AlongZ(0, 0, 5); },
                  .certified = {0, 0, 0},
                  .doubts = kSingular,
                  .depth_bound_mm = 0});
  rows.push_back({.group = "pole",
                  .input = "cone of 1 mm, the apex fills the screen: windows of 1 to 1e-9 mm",
                  .expected = "right; in doubt at the apex and on the seam only",
                  .model = cone,
                  .cameras =
                      [](const Model& model) {
                        return ClosingIn(model, {0, 0, 1});
                      },
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-9});
  rows.push_back({.group = "pole",
                  .input = "horn torus (a point for a hole), rays at the axis",
                  .expected = "right; in doubt at the axis only",
                  .model =
                      [] {
                        return ModelOf({Torus({0, 0, 0}, 1, 1)});
                      },
                  .cameras =
                      [](const Model& model) {
                        std::vector<Camera> views = ClosingIn(model, {0, 0, 0});
                        Append(views, AlongZ(0, 0, 5));
                        return views;
                      },
                  .certified = {0.5, 0.5, 0.5},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
}

// Adds bicubic patches with collapsed control points.
void AddCollapsedPatches(Rows& rows) {
  const auto collapsed = [](const std::function<bool(int, int)>& which) {
    PatchGrid grid = BumpyPatch(3, 3, 1);
    for (int k = 0; k <= 3; ++k)
      for (int l = 0; l <= 3; ++l)
        if (which(k, l)) grid.points[k * 4 + l] = {0.5, 0.5, 0.3, 1};
    return ModelOf({grid});
  };
  const auto near_the_point = [](const Model& model) {
    std::vector<Camera> views = ClosingIn(model, {0.5, 0.5, 0.3});
    Append(views, NamedViews(model, {"iso"}, 64));
    return views;
  };
  rows.push_back({.group = "pole",
                  .input = "bicubic patch, one side collapsed to a point",
                  .expected = "right; in doubt at the point only",
                  .model = [=] { return collapsed([](int k, int) { return k == 0; }); },
                  .cameras = near_the_point,
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
  rows.push_back({.group = "pole",
                  .input = "bicubic patch, two opposite sides collapsed to one point",
                  .expected = "right; in doubt at the point only",
                  .model = [=] { return collapsed([](int k, int) { return k % 3 == 0; }); },
                  .cameras = near_the_point,
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
  rows.push_back(
      {.group = "pole",
       .input = "bicubic patch, all points the same: no surface",
       .expected = "nothing, but at the point; no crash",
       .model = [=] { return collapsed([](int, int) { return true; }); },
       .cameras =
           [](const Model&) {
             std::vector<Camera> views = AlongZ(0.5, 0.5, 5);
             views.push_back(Orthographic("iso", {5.5, -4.5, 5.3}, {0.5, 0.5, 0.3}, {0, 0, 1}, 1, 33, 33));
             return views;
           },
       .certified = {0.9, 0.9, 0.9},
       .doubts = kSingular,
       .depth_bound_mm = 0});
  rows.push_back({.group = "pole",
                  .input = "bicubic patch, all points on a line: no surface",
                  .expected = "nothing, but on the line; no crash",
                  .model =
                      [] {
                        return ModelOf({Mapped(BumpyPatch(3, 3, 1), [](Vec3 p) {
                          return Vec3{p.x + p.y, p.x + p.y, 0};
                        })});
                      },
                  .cameras = [](const Model&) -> std::vector<Camera> {
                    return {Orthographic("top", {1, 1, 5}, {1, 1, 0}, {0, 1, 0}, 3, 33, 33),
                            Orthographic("along", {-3, -3, 0}, {0, 0, 0}, {0, 0, 1}, 1, 33, 33)};
                  },
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 0});
}

// A curve of degree 3 in (x, z), extruded along y from −1 to 1.
PatchGrid Extruded(const std::vector<Vec2>& curve) {
  std::vector<Vec4> points;
  for (const Vec2 p : curve)
    for (const double y : {-1.0, 1.0}) points.push_back({p.x, y, p.y, 1});
  return BezierPatch(static_cast<int>(curve.size()) - 1, 1, points);
}

void AddCusps(Rows& rows) {
  // Seen from the side and from above, with pixels exactly on the line.
  const auto about = [](Vec3 point) {
    return [=](const Model& model) {
      std::vector<Camera> views = NamedViews(model, {"iso", "top"}, 33);
      Append(views, ClosingIn(model, point));
      views.push_back(CloseTo(model, "right", point, 1e-3, 33));
      return views;
    };
  };
  // The curve is x = t², z = t³ for t from −1 to 1.
  rows.push_back({.group = "cusp",
                  .input = "a cuspidal edge (t², y, t³), seen from four sides and close",
                  .expected = "right; in doubt at the edge only",
                  .model =
                      [] {
                        return ModelOf({Extruded({{1, -1}, {-1.0 / 3, 1}, {-1.0 / 3, -1}, {1, 1}})});
                      },
                  .cameras = about({0, 0, 0}),
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
  rows.push_back({.group = "cusp",
                  .input = "a surface that crosses itself",
                  .expected = "right",
                  .model =
                      [] {
                        return ModelOf({Extruded({{0, -1}, {3, 2}, {-3, 2}, {0, -1}})});
                      },
                  .cameras = about({0, 0, -1}),
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
  // The curve is x = t², z = t: a ray along z at x = 0 has a double root.
  rows.push_back({.group = "multiple roots",
                  .input = "double root: the parabola (t², y, t) from above",
                  .expected = "right; in doubt where the roots meet",
                  .model =
                      [] {
                        return ModelOf({Extruded({{1, -1}, {-1, 0}, {1, 1}})});
                      },
                  .cameras = about({0, 0, 0}),
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
  // The curve is x = t³, z = t: every ray has one root, which is threefold at x = 0.
  rows.push_back({.group = "multiple roots",
                  .input = "triple root: the cubic (t³, y, t) from above",
                  .expected = "a hit everywhere; in doubt where it is threefold",
                  .model =
                      [] {
                        return ModelOf({Extruded({{-1, -1}, {1, -1.0 / 3}, {-1, 1.0 / 3}, {1, 1}})});
                      },
                  .cameras = about({0, 0, 0}),
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
  // The curve is x = t³ − t·a with a small a: three roots lie within a fold of 2·(a/3)^1.5.
  rows.push_back({.group = "multiple roots",
                  .input = "three roots within 1e-6: (t³ − 1e-4·t, y, t) from above",
                  .expected = "right; in doubt at the folds only",
                  .model =
                      [] {
                        const double a = 1e-4;
                        return ModelOf({Extruded(
                            {{-1 + a, -1}, {1 + a / 3, -1.0 / 3}, {-1 - a / 3, 1.0 / 3}, {1 - a, 1}})});
                      },
                  .cameras = about({0, 0, 0}),
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
  rows.push_back({.group = "multiple roots",
                  .input = "a plane seen exactly edge-on, through pixel centres and between them",
                  .expected = "the ray lies in the surface: in doubt, by name; else nothing",
                  .model =
                      [] {
                        return ModelOf({testing::Rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0})});
                      },
                  .cameras = [](const Model&) -> std::vector<Camera> {
                    return {Orthographic("through", {-3, 0, 0}, {0, 0, 0}, {0, 0, 1}, 3, 33, 33),
                            Orthographic("between", {-3, 0, 0}, {0, 0, 0}, {0, 0, 1}, 3, 32, 32),
                            Perspective("eye-in-plane", {-3, 0, 0}, {0, 0, 0}, {0, 0, 1}, 60, 33, 33),
                            Perspective("eye-in-face", {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 60, 33, 33)};
                  },
                  .certified = {0.9, 0.9, 0.9},
                  .doubts = kSingular,
                  .depth_bound_mm = 1e-6});
}

}  // namespace

void AddSingularities(Rows& rows) {
  AddPolesOfSolids(rows);
  AddCollapsedPatches(rows);
  AddCusps(rows);
}

}  // namespace facetless::extremes
