// Wall thickness: from a point of a solid's surface along the inward normal to where the ray leaves the
// material.
//
//  1. The answer is the distance, in placed millimetres, to the next crossing of any face of the same solid,
//     the starting face included; exact to the surfaces (SolidTree), and the same whatever the view. Faces
//     without a solid count with the other such faces of their part.
//  2. A crossing nearer than kLeastShare of the solid's size is the starting point itself.
//  3. None: the ray leaves the solid nowhere (an open shell), or the normal does not exist there.
//  4. Trees are built at construction, for the solids of shown faces only.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/rays/solid_tree.h"

namespace facetless {

class Thickness {
 public:
  // Trees for the solids of the faces that `shown` marks (by Model::faces). The scene and the surfaces must
  // outlive it. Runs in the caller's task arena.
  Thickness(const Scene& scene, const std::vector<SurfaceEval>& surfaces, const std::vector<bool>& shown);

  // From the point of `face` at (u, v); `outward` is the placed unit normal there.
  std::optional<double> At(std::uint32_t face, const Placement& placement, double u, double v,
                           Vec3 outward) const;

  std::size_t pieces() const;

 private:
  const std::vector<SurfaceEval>& surfaces_;
  std::vector<std::uint32_t> tree_of_face_;  // kNoIndex: not shown
  std::vector<std::unique_ptr<const SolidTree>> trees_;
};

}  // namespace facetless
