// OpenCASCADE's exact intersector for many faces. It finds the nearest hit of a ray.
//
//  1. Nearest() calls IntCurvesFace_Intersector for the faces whose boxes the ray meets, nearest box first,
//     until the next box begins behind the hit. The library's answers are neither checked nor repaired.
//  2. The intersector of a face is created when a ray first meets its box, and it is kept. When the same rays
//     are traced again, all faces are therefore already prepared.
//  3. Several threads must not use one object at once, because OpenCASCADE's intersectors have state.
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
  int face = -1;                                           // index of the face; −1: no hit
  bool failed = false;  // an exception ended the search on at least one face
};

class ExactIntersector {
 public:
  // A face that has no box is never hit.
  explicit ExactIntersector(const std::vector<TopoDS_Face>& faces);
  ~ExactIntersector();
  ExactIntersector(ExactIntersector&&) noexcept;
  ExactIntersector& operator=(ExactIntersector&&) noexcept;

  // OpenCASCADE's box of the face, widened by a hundredth of its diagonal. The box only selects faces;
  // whether a ray hits must not depend on it.
  const Box3& box(int face) const;

  // The nearest hit with a depth of at least `near`, which may be −infinity.
  ExactHit Nearest(Vec3 origin, Vec3 direction, double near);

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

// The speed of the exact intersector.
struct ExactTiming {
  std::size_t rays = 0;  // number of rays that were answered, counted from the first ray
  double trace_ms = 0;   // time for these rays
};

// Reads rays from `rays_path` (six doubles each: origin, direction) and answers as many as fit in half of
// `seconds`. Then it measures the same rays again, with all faces prepared, and writes their depths to
// `depths_path` (one double each, infinite for a miss). Errors: kFileUnreadable, kWriteFailed.
Result<ExactTiming> TimeExactIntersector(const std::vector<TopoDS_Face>& faces, const std::string& rays_path,
                                         const std::string& depths_path, double near, double seconds);

}  // namespace facetless
