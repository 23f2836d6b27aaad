// Scene::Data: the data that all views of a model share.
#pragma once

#include <vector>

#include "render/nurbs/angle_map.h"
#include "render/nurbs/leaf_place.h"
#include "render/nurbs/trim_index.h"
#include "render/trace/direct.h"
#include "render/trace/seams.h"

namespace facetless {

struct FaceData {
  FaceTrim trim;
  Box3 bounds;                     // box of the patches, continued as below; part coordinates
  std::vector<RectClass> patches;  // class of each patch against the trimming; independent of the view
  // The range to which the outermost patches are continued, each in its own Bézier parameters. It extends
  // beyond [0,1] where the face ends with the grid and its edges lie off the surface by a gap.
  PatchBounds continued;
  bool u_low_continued = false, u_high_continued = false, v_low_continued = false, v_high_continued = false;
};

// Returns the range to which patch (i, j) of a face's surface is continued.
inline PatchBounds SetBoxBounds(const FaceData& face, const Surface& surface, std::uint32_t i,
                                std::uint32_t j) {
  PatchBounds bounds;
  if (i == 0) bounds.u_low = face.continued.u_low;
  if (i + 1 == surface.u_spans.count) bounds.u_high = face.continued.u_high;
  if (j == 0) bounds.v_low = face.continued.v_low;
  if (j + 1 == surface.v_spans.count) bounds.v_high = face.continued.v_high;
  return bounds;
}

struct Scene::Data {
  const Model* model = nullptr;
  std::vector<FaceData> faces;       // parallel to Model::faces
  std::vector<SpanParameter> spans;  // parallel to Model::spans
  SeamTable seams;
  bool has_closed_solid = false;

  std::size_t bytes() const;
};

}  // namespace facetless
