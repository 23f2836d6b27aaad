// TraceShared: what all tracers of a view share besides the leaves, and what they ask of a leaf and its roots
// whatever its kind.
//
//  1. All of it is read only once it is made: the tracers of all threads ask it.
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

  // What a placed face id stands for.
  struct PlacedFace {
    std::uint32_t instance, face;  // indices into the model's
    double outward;                // +1, or −1 where the outward normal is −(Su × Sv)
  };
  PlacedFace Placed(std::uint32_t placed_face) const;

  // Where in its face a leaf lies.
  struct LeafSite {
    std::uint32_t leaf = kNoIndex;
    std::uint32_t placed_face, patch;
    PlacedFace placed;
    ParameterRect rect;
    double overlap;  // of the leaf and its neighbours, in s and t
    const SpanParameter *u_map, *v_map;
    // Where the patch is continued past the border of its face, a root lies where it lies.
    bool u_low_continued, u_high_continued, v_low_continued, v_high_continued;

    // Bézier parameters in the patch, for u_map and v_map. A root in the overlap past the border of its patch
    // belongs to the border.
    double U(double s) const;
    double V(double t) const;
  };
  LeafSite SiteOf(std::uint32_t leaf) const;
  // EvaluateHit of the leaf, whichever its kind.
  HitGeometry HitAt(std::uint32_t leaf, double s, double t, double x, double y) const;

  // A root of a leaf, in the leaf's parameters, and how far off it may be.
  struct LeafRoot {
    double s, t, error_s, error_t;
  };
  // Asks `check` about a certified hit of the ray through (x, y), relative to the image centre. Returns
  // kDoubtContradicted or 0. Requires a check.
  std::uint8_t CheckRoot(const LeafSite& site, const LeafRoot& root, double x, double y, double depth,
                         double error, CheckStats* stats) const;
  // Returns whether the root of a certified sample is one of the share that is asked about. The pattern meets
  // every place in a packet.
  bool IsRootChecked(int column, int row) const {
    return ((column + 7 * row) & (roots_per_checked_root - 1)) == 0;
  }

  const CertificateCheck* check = nullptr;                   // null: certificates are not asked again
  int roots_per_checked_root = 1, rays_per_checked_ray = 1;  // powers of two

  std::vector<ProjectedEdges> edges;  // per instance

 private:
  std::vector<std::uint32_t> instance_of_face_;  // per placed face; empty if there is one instance
  std::vector<bool> mirrored_;                   // per instance
};

// Returns whether two roots of one face may be one root that two leaves own, for all that tells them apart:
// both lie on the border of their leaves, or were met without proof, and their depths agree to within the
// solver's error.
struct RootTwin {
  RootTwin(const PreparedView& view, std::uint32_t leaf, const TileHit& hit);
  bool Is(const RootTwin& other) const {
    return on_border && other.on_border && std::fabs(depth - other.depth) <= error + other.error;
  }
  double depth, error;
  bool on_border;
};

}  // namespace facetless
