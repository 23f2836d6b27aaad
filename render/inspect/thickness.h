// Wall thickness: the distance from a point on the surface of a solid, along the inward normal, to the point
// where the ray leaves the material.
//
//     const Thickness thickness(scene, surfaces, shown);
//     const std::optional<double> mm = thickness.At(face, instance.placement, u, v, outward);
//
//  1. The thickness is the distance, in placed millimetres, to the next crossing with any face of the same
//     solid, including the starting face. It is exact for the surfaces (SolidTree) and does not depend on the
//     view. All faces of a part that belong to no solid are treated as one solid.
//  2. A crossing nearer than kLeastShare of the solid's size is taken for the starting point itself and
//     ignored.
//  3. There is no thickness if the ray does not leave the solid (an open shell), or if the normal does not
//     exist.
//  4. The constructor builds the trees, only for the solids of shown faces.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/rays/solid_tree.h"

namespace facetless {

class Thickness {
 public:
  // Builds the trees for the solids of the faces that are set in `shown` (indexed like Model::faces). The
  // scene and the surfaces must outlive this object. The constructor runs in the task arena of the caller.
  Thickness(const Scene& scene, const std::vector<SurfaceEval>& surfaces, const std::vector<bool>& shown);

  // The thickness at the point (u, v) of `face`, mm; nothing in the cases of law 3. `outward` is the placed
  // unit normal there.
  std::optional<double> At(std::uint32_t face, const Placement& placement, double u, double v,
                           Vec3 outward) const;

  std::size_t pieces() const;

 private:
  const std::vector<SurfaceEval>& surfaces_;
  std::vector<std::uint32_t> tree_of_face_;  // kNoIndex: not shown
  std::vector<std::unique_ptr<const SolidTree>> trees_;
};

}  // namespace facetless
