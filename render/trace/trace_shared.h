// TraceShared: the data that all tracers of a view share in addition to the leaves, and functions for leaves
// of all kinds and their roots.
//
//  1. All of it is read-only after construction, so that the tracers of all threads can use it.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "render/kernels/tile_kernel.h"
#include "render/trace/certificate_check.h"
#include "render/trace/hit_geometry.h"
#include "render/trace/prepare.h"
#include "render/trace/projected_edges.h"

namespace facetless {

struct TraceShared {
  TraceShared(const Scene::Data& scene, const PreparedView& view, const Camera& camera,
              const CameraFrame& frame);

  const Scene::Data& scene;
  const PreparedView& view;
  const Camera& camera;
  const CameraFrame& frame;

  // The face to which a placed-face id refers.
  struct PlacedFace {
    std::uint32_t instance, face;  // indices into the model's
    double outward;                // +1, or −1 if the outward normal is −(Su × Sv)
  };
  PlacedFace Placed(std::uint32_t placed_face) const;

  // The place of a leaf in its face.
  struct LeafSite {
    std::uint32_t leaf = kNoIndex;
    std::uint32_t placed_face, patch;
    PlacedFace placed;
    ParameterRect rect;
    double overlap;  // overlap of the leaf and its neighbours, in s and t
    const SpanParameter *u_map, *v_map;
    // True where the patch is continued past the border of its face. A root beyond such a border is not moved
    // onto it.
    bool u_low_continued, u_high_continued, v_low_continued, v_high_continued;

    // Return Bézier parameters in the patch, for u_map and v_map. A root in the overlap beyond the border of
    // its patch is moved onto the border.
    double U(double s) const { return OntoPatch(rect.U(s), rect.u_half, u_low_continued, u_high_continued); }
    double V(double t) const { return OntoPatch(rect.V(t), rect.v_half, v_low_continued, v_high_continued); }

   private:
    // Moves a root in the overlap onto the border of the patch. On a closed surface without edges, the leaf on
    // the other side of the seam may have left such a root to this leaf.
    double OntoPatch(double bezier, double half, bool low_continued, bool high_continued) const {
      const double reach = 2 * overlap * half;
      if (!low_continued && bezier < 0 && bezier >= -reach) return 0;
      if (!high_continued && bezier > 1 && bezier <= 1 + reach) return 1;
      return bezier;
    }
  };
  LeafSite SiteOf(std::uint32_t leaf) const;
  // Calls EvaluateHit for a leaf of any kind.
  HitGeometry HitAt(std::uint32_t leaf, double s, double t, double x, double y) const;

  // A root of a leaf, in the leaf's parameters, with its error.
  struct LeafRoot {
    double s, t, error_s, error_t;
  };
  // Verifies a certified hit of the ray through (x, y), relative to the image centre, with `check`. Returns
  // kDoubtContradicted or 0. Requires a check.
  std::uint8_t CheckRoot(const LeafSite& site, const LeafRoot& root, double x, double y, double depth,
                         double error, CheckStats* stats) const;
  // Returns whether the root of a certified sample belongs to the share that is verified. The pattern covers
  // every position in a packet.
  bool IsRootChecked(int column, int row) const {
    return ((column + 7 * row) & (roots_per_checked_root - 1)) == 0;
  }

  const CertificateCheck* check = nullptr;                   // null: certificates are not verified again
  int roots_per_checked_root = 1, rays_per_checked_ray = 1;  // powers of two

  std::vector<ProjectedEdges> edges;  // per instance

 private:
  std::vector<std::uint32_t> instance_of_face_;  // per placed face; empty if there is one instance
  std::vector<bool> mirrored_;                   // per instance
};

// Returns whether two roots of one face may be the same root, found in two leaves: both lie on the border of
// their leaves, or were found without proof, and their depths agree to within the solver's error.
struct RootTwin {
  RootTwin(const PreparedView& view, std::uint32_t leaf, const TileHit& hit);
  bool Is(const RootTwin& other) const {
    return on_border && other.on_border && std::fabs(depth - other.depth) <= error + other.error;
  }
  double depth, error;
  bool on_border;
};

}  // namespace facetless
