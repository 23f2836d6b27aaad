// Scene::Data: what every view of a model shares.
#pragma once

#include <vector>

#include "render/nurbs/angle_map.h"
#include "render/nurbs/trim_index.h"
#include "render/trace/direct.h"

namespace facetless {

struct FaceData {
  FaceTrim trim;
  Box3 bounds;                     // of the control points, part coordinates
  std::vector<RectClass> patches;  // where each patch lies in the trimming, whatever the view
  double extend_mm = 0;  // how far neighbours' edges may lie outside the patch grid: the largest gap
};

struct Scene::Data {
  const Model* model = nullptr;
  std::vector<FaceData> faces;       // as Model::faces
  std::vector<SpanParameter> spans;  // as Model::spans
  bool has_closed_solid = false;

  std::size_t bytes() const;
};

}  // namespace facetless
