// ValueMap: the map of preliminary values of A. Sisojevs, "3D scene rendering" (2011), equations 5 to 8 and table 1. The
// surfaces of a view are drawn as polygons with a depth buffer, and each pixel keeps the number of the nearest surface and
// its parameters there, as the three channels of a colour. Solvers begin at these values.
//
//     Result<ValueMap> map = ValueMap::Draw(scene, SolverUnit::kPatch, {width, height, false}, max_bytes, execution);
//     if (const std::optional<SolverStart> start = map.value().At(column, row)) solver.Solve(ray, *start, state);
//
//  1. A published map has channels of 8 bits: red is the number of the surface plus 1, and 0 where there is none; green
//     and blue are u and v, 0 … 255 over the whole surface. It numbers at most 255 surfaces (numbers 0 … 254). A wide map
//     has 32 bits for the number and 16 bits for each parameter.
//  2. Each patch is drawn as a grid of flat triangles. Their number is chosen so that they are off the surface by about a
//     quarter of a pixel on the screen, but are at least about three pixels long, and that there are at most 256 along a
//     side. Fragments whose parameters are trimmed away are left out. So a pixel near an outline can have no value, or the
//     value of a surface behind the one that the ray meets: the map says where a search begins, and nothing more.
//  3. In perspective views, triangles that reach behind the near distance of the camera are cut at no more than twice that
//     distance, and parameters are interpolated as the perspective requires.
//  4. The map is the same for any number of threads: in each band of rows, all patches are drawn in their order.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/solve/solver.h"
#include "render/solve/solver_scene.h"

namespace facetless {

// The surfaces that a published map can number.
inline constexpr std::uint32_t kMostPublishedSurfaces = 255;

class ValueMap {
 public:
  struct Size {
    int width = 1, height = 1;
    bool published = false;
  };
  // Surfaces are patches or faces, as `unit` says. `max_bytes`: 0 means no limit. Errors: kBadUsage (the scene has more
  // surfaces than a published map can number), kLimitExceeded (drawing needs more than `max_bytes`), kCancelled.
  static Result<ValueMap> Draw(const SolverScene& scene, SolverUnit unit, const Size& size,
                               std::uint64_t max_bytes, const Execution& execution);

  // The value of a pixel, with the whole surface as the piece; nothing if no surface was drawn there.
  std::optional<SolverStart> At(int column, int row) const;
  std::uint64_t bytes() const;

 private:
  struct Pixel {
    std::uint32_t number = 0;  // of the surface, plus 1
    std::uint16_t u = 0, v = 0;
  };
  int width_ = 0;
  bool published_ = false;
  std::vector<std::array<std::uint32_t, 2>> grids_;  // patches along u and v of each surface
  std::vector<Pixel> pixels_;
};

}  // namespace facetless
