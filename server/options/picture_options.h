// Options for the arrangement, the colours and the labels of pictures: the group "Pictures" of the option
// table, and `margin` and `up`.
#pragma once

#include "render/compare/face_colors.h"
#include "render/view/arrangement.h"
#include "render/view/camera.h"

namespace facetless {

struct PictureOptions {
  double margin = NamedViewOptions{}.margin;
  UpAxis up = UpAxis::kZ;
  Coloring coloring;
  ArrangementRequest arrangement;
  bool scale_bar = false, axes = false, sheet = false;
  int turntable = 0;
  double turntable_s = 6;
};

}  // namespace facetless
