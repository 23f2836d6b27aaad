// OpenCASCADE's exact intersector over many faces: the nearest hit of a ray.
//
//  1. Nearest() asks IntCurvesFace_Intersector of every face whose box the ray meets, nearest box first,
//     until the next box begins behind the hit. What the library answers is neither checked nor repaired.
//  2. A face's intersector is made when a ray first meets its box, and kept: rays that are asked twice are
//     asked of prepared faces.
//  3. Not for several threads at once: OpenCASCADE's intersectors keep state.
#pragma once

#include <TopoDS_Face.hxx>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/base/vec.h"

namespace facetless {

struct ExactHit {
  double depth = std::numeric_limits<double>::infinity();  // the hit is origin + depth · direction
  int face = -1;                                           // index of the face; −1: nothing hit
  bool failed = false;  // an exception ended the search on at least one face
};

class ExactIntersector {
 public:
  // Faces that have no box are never hit.
  explicit ExactIntersector(const std::vector<TopoDS_Face>& faces);
  ~ExactIntersector();
  ExactIntersector(ExactIntersector&&) noexcept;
  ExactIntersector& operator=(ExactIntersector&&) noexcept;

  // OpenCASCADE's box of the face, widened by a hundredth of its diagonal: the box selects, it must not
  // decide.
  const Box3& box(int face) const;

  // The nearest hit with a depth of at least `near`, which may be −infinity.
  ExactHit Nearest(Vec3 origin, Vec3 direction, double near);

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

// How many rays a second.
struct ExactTiming {
  std::size_t rays = 0;  // that were answered, from the first on
  double trace_ms = 0;   // of these
};

// Reads rays from `rays_path` (six doubles each: origin, direction), answers as many as half of `seconds`
// allows, measures the same rays once more with all faces prepared, and writes their depths to `depths_path`
// (a double each, infinite for a miss). Errors: kFileUnreadable, kWriteFailed.
Result<ExactTiming> TimeExactIntersector(const std::vector<TopoDS_Face>& faces, const std::string& rays_path,
                                         const std::string& depths_path, double near, double seconds);

}  // namespace facetless
