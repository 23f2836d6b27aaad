// Seams: the samples that pass an edge so near that the gap between its faces matters, and the crossings that
// the faces owe there. What keeps light from falling through, and rays from being counted twice.
//
//  1. A ray crosses a face an odd number of times iff the image of the face's border winds around the pixel
//     an odd number of times: so it is for every surface, folded or seen edge-on. Here the border runs along
//     the 3D edges (trace/edge_winding.h), which neighbours share. Over a closed solid every edge is counted
//     twice: its faces together owe each ray an even number of crossings.
//  2. P-curves draw the border a little beside the edges. The two disagree only on rays that pass an edge
//     within the gap of one of its faces, or a vertex within what its edges' ends miss it by: the seam
//     samples. All other rays are left to the trimming alone.
//  3. At a seam sample a face whose crossings are odd where its border says even, or the reverse, is given
//     one more, on the edge itself. Nothing is taken away.
//  4. Left alone are faces whose edges don't close in their vertices, or that are bounded by more than edges,
//     unless in a closed solid; and faces that reach behind the eye.
//  5. Where a face misses an edge by more than two thousandths of the edge's length, and the reach is more
//     than eight samples, the gap is drawn as it is.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/leaf_splitter.h"
#include "render/view/camera.h"

namespace facetless {

// What of a model's seams doesn't depend on the view.
struct SeamTable {
  struct Use {
    std::uint32_t face, coedge;  // indices into the model's
  };
  // An edge, or a vertex, at which faces may disagree.
  struct Source {
    std::uint32_t edge = kNoIndex, vertex = kNoIndex;  // one of them
    double reach_mm = 0;                               // how far from it
    Range uses;                                        // by the faces that it concerns
    bool off_surface = false;  // a face misses the edge by so much that one of the two is wrong
  };
  std::vector<Source> sources;
  std::vector<Use> uses;
  std::vector<Range> of_part;        // sources of each part
  std::vector<std::uint32_t> edges;  // borders: edges that a face uses an odd number of times
  std::vector<Range> border_of;      // of each face, into `edges`; empty: the face is left alone
  double max_reach_mm = 0;

  explicit SeamTable(const Model& model);
  SeamTable() = default;
  std::size_t bytes() const;
};

// A face that a ray passes at a seam.
struct SeamSample {
  std::uint32_t instance, face;
  std::int32_t column, row;
  std::uint32_t patch;  // and Bézier parameters in it of the point on the edge, and its depth
  double u, v;
  double depth;
  bool odd;              // what law 1 says
  double distance_px;    // from the edge or the vertex,
  std::uint32_t source;  // this one of SeamTable::sources
};

// All of a view, by instance, face, row and column. The result doesn't depend on the number of threads. Each
// sample takes the bytes of a SeamLeaf from `budget`; once that is stopped, what is returned is a part, and the
// caller gives the view up.
std::vector<SeamSample> FindSeamSamples(const Model& model, const SeamTable& table, const Camera& camera,
                                        const CameraFrame& frame, SplitBudget* budget);

}  // namespace facetless
