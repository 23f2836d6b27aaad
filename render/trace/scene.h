// Scene::Data: what every view of a model shares.
#pragma once

#include <vector>

#include "render/nurbs/angle_map.h"
#include "render/nurbs/trim_index.h"
#include "render/trace/direct.h"
#include "render/trace/seams.h"

namespace facetless {

struct FaceData {
  FaceTrim trim;
  Box3 bounds;                     // of the patches, continued as below; part coordinates
  std::vector<RectClass> patches;  // where each patch lies in the trimming, whatever the view
  // The native rectangle that the patches are continued to: the grid's, and beyond it where the face ends
  // with the grid and its edges lie off the surface by a gap.
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  bool u_low_continued = false, u_high_continued = false, v_low_continued = false, v_high_continued = false;
};

struct Scene::Data {
  const Model* model = nullptr;
  std::vector<FaceData> faces;       // as Model::faces
  std::vector<SpanParameter> spans;  // as Model::spans
  SeamTable seams;
  bool has_closed_solid = false;

  std::size_t bytes() const;
};

}  // namespace facetless
