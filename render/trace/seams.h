// Seams: the samples whose rays pass an edge so closely that the gap between its faces matters, and the
// crossings that are added there. They prevent light from leaking through gaps, and crossings from being
// counted twice.
//
//  1. A ray crosses a face an odd number of times iff the image of the face's border winds around the pixel
//     an odd number of times. This is true of every surface, even if it is folded or seen edge-on. Here the
//     border runs along the 3D edges (trace/edge_winding.h), which neighbouring faces share. In a closed
//     solid, every edge is counted twice, so its faces together require an even number of crossings of each
//     ray.
//  2. The p-curves define a border that deviates slightly from the edges. The two borders disagree only on
//     the seam samples: rays that pass an edge within the gap of one of its faces, or a vertex within the
//     distance of the ends of its edges. For all other rays, the trimming alone decides.
//  3. If, at a seam sample, the number of crossings of a face is odd and its border requires an even number,
//     or the reverse, one crossing is added, on the edge itself. No crossing is removed.
//  4. Three kinds of faces are not treated: faces whose edges do not form closed chains of vertices; faces
//     that are not bounded by edges alone, unless they belong to a closed solid; and faces that reach behind
//     the eye.
//  5. If the distance between a face and an edge exceeds two thousandths of the edge's length, and the reach
//     exceeds eight samples, the gap is shown as it is.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/leaf_splitter.h"
#include "render/view/camera.h"
#include "render/view/refinement.h"

namespace facetless {

// The data about the seams of a model that does not depend on the view.
struct SeamTable {
  struct Use {
    std::uint32_t face, coedge;  // indices into Model::faces and Model::coedges
  };
  // An edge or a vertex at which the two borders of law 2 may disagree.
  struct Source {
    std::uint32_t edge = kNoIndex, vertex = kNoIndex;  // exactly one of the two is set
    double reach_mm = 0;                               // distance within which a ray is a seam sample
    Range uses;                                        // the uses by the faces concerned
    bool off_surface = false;  // the face and the edge are so far apart that one of the two must be wrong
  };
  std::vector<Source> sources;
  std::vector<Use> uses;
  std::vector<Range> of_part;        // sources of each part
  std::vector<std::uint32_t> edges;  // the borders: edges that a face uses an odd number of times
  std::vector<Range> border_of;      // range of each face in `edges`; empty: the face is not treated (law 4)
  double max_reach_mm = 0;

  explicit SeamTable(const Model& model);
  SeamTable() = default;
  std::size_t bytes() const;
};

// A seam sample, for one of the faces that meet at the seam.
struct SeamSample {
  std::uint32_t instance, face;
  std::int32_t column, row;
  std::uint32_t patch;   // patch of the point on the edge
  double u, v;           // Bézier parameters of that point in the patch
  double depth;          // depth of that point, mm
  bool odd;              // whether law 1 requires an odd number of crossings
  double distance_px;    // distance from the edge or the vertex
  std::uint32_t source;  // index of that edge or vertex in SeamTable::sources
};

// The samples of refined pixels: a camera whose pixels are the samples of `grid`, and the pixels that matter.
struct SeamSampleFilter {
  const PixelSet* pixels = nullptr;  // null: all pixels
  SampleGrid grid;

  bool Wants(int column, int row) const {
    return pixels == nullptr || pixels->Has(column / grid.x, row / grid.y);
  }
};

// All seam samples of a view that `filter` wants, sorted by instance, face, row and column. The result does not
// depend on the number of threads. Each sample takes the bytes of a leaf from `budget`. Once the budget is
// exhausted or cancelled, the result is incomplete, and the caller must abandon the view.
std::vector<SeamSample> FindSeamSamples(const Model& model, const SeamTable& table, const Camera& camera,
                                        const CameraFrame& frame, SplitBudget* budget,
                                        const SeamSampleFilter& filter = {});

}  // namespace facetless
