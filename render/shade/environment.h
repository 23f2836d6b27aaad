// The surroundings that mirrors, metals and glasses show where their rays meet nothing.
//
//  1. The built-in studio is a function of the direction in viewer axes (studio.h, law 1): a bright backdrop behind the
//     model, a dim room behind the viewer, a ceiling, a floor, and a bright rectangle (a soft box) for each of the two
//     lights. The studio moves with the camera, as the lights do.
//  2. A panorama is fixed to the model. Its top row is straight up and its bottom row straight down. Its middle column
//     lies in the direction in which the view `front` looks, and columns continue to the right of that direction.
//  3. The code uses only sums, products, quotients and square roots of doubles, in a fixed order.
#pragma once

#include <memory>

#include "render/base/vec.h"
#include "render/image/radiance_map.h"
#include "render/view/camera.h"

namespace facetless {

// Linear light from a direction, a unit vector in viewer axes. The light may exceed 1.
Vec3 StudioSurroundings(Vec3 direction);

// The surroundings of the model in one view: the studio, or a panorama.
class Surroundings {
 public:
  // `frame` must outlive the object. If `map` is null, the surroundings are the studio. `up` is the axis of the model
  // that points up.
  Surroundings(const CameraFrame& frame, std::shared_ptr<const RadianceMap> map, UpAxis up);
  // Linear light from a direction, a unit vector in model axes.
  Vec3 Light(Vec3 direction) const;

 private:
  const CameraFrame& frame_;
  const std::shared_ptr<const RadianceMap> map_;
  Vec3 up_, ahead_, right_;  // of the panorama, in model axes
};

}  // namespace facetless
