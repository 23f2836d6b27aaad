// OpenCASCADE's own answer to a ray: the second opinion that the direct renderer is compared with.
//
//  1. The shape is read by OpenCASCADE's plain readers, in mm, with nothing of import/ in between. Faces keep
//     the order of its explorer.
//  2. Nearest() is that of import/exact_intersector.h. It is neither checked nor repaired: what it loses is
//     lost.
//  3. Judge() decides who is right, by other means than both tracers: a point is projected onto the face's
//     surface, the foot is classified against the face's p-curves, and the ray's distance to the face's 3D
//     edges is measured.
//  4. Not for several threads at once: OpenCASCADE's intersectors keep state.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/view/camera.h"

namespace facetless {

struct ReferenceHit {
  double depth = std::numeric_limits<double>::infinity();
  int face = -1;        // in the explorer's order; −1: nothing hit
  bool failed = false;  // an exception ended the search on at least one face
  bool hit() const { return face >= 0; }
};

// Where a point lies with regard to one face.
enum class Standing {
  kOn,    // on the surface and inside the trims
  kEdge,  // its ray passes an edge or a vertex of the face within the tolerance that the shape gives it
  kOff,   // neither
};

struct Judgement {
  Standing standing = Standing::kOff;
  int face = -1;  // the face that speaks best for the point
  double surface_mm =
      std::numeric_limits<double>::infinity();               // distance of the point to that face's surface
  double edge_mm = std::numeric_limits<double>::infinity();  // distance of the ray to the face's nearest edge
  double edge_tolerance_mm = 0;                              // that edge's
  bool inside_edge = false;  // the ray passes that edge on the face's side, as the 3D curve has it
  double cosine = 1;         // |N·D| there
};

class ExactReference {
 public:
  // Reads a STEP or IGES file. `one_placement`: of faces placed several times only the first placement is
  // kept. Errors: kFileUnreadable, kFormatUnknown, kNothingUsable.
  static Result<ExactReference> Load(const std::string& path, bool one_placement);
  ~ExactReference();
  ExactReference(ExactReference&&) noexcept;
  ExactReference& operator=(ExactReference&&) noexcept;

  std::size_t face_count() const;
  // The kind of the face's surface, for tables: "plane", "cylinder", "B-spline", …
  std::string SurfaceName(int face) const;

  // The hit nearest to the eye, not nearer than `near` (depths as in camera.h), which may be −infinity.
  ReferenceHit Nearest(const Ray& ray, double near);

  // How the point at `depth` on `ray` stands to the faces near it; `tolerance_mm` is what counts as on the
  // surface.
  Judgement Judge(const Ray& ray, double depth, double tolerance_mm);

 private:
  struct Data;
  explicit ExactReference(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace facetless
