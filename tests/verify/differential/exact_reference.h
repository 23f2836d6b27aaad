// OpenCASCADE's answer to a ray, with which the direct renderer is compared.
//
//  1. OpenCASCADE's plain readers read the shape, in mm, without any code of import/. Faces have the order of
//     its explorer.
//  2. Nearest() is that of import/exact_intersector.h. Its answers are neither checked nor repaired.
//  3. Judge() decides which answer is right, by other means than both tracers: it projects a point onto the
//     face's surface, classifies the foot against the face's p-curves, and measures the ray's distance to the
//     face's 3D edges.
//  4. Several threads must not use one object at once, because OpenCASCADE's intersectors have state.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/view/camera.h"

namespace facetless {

struct ReferenceHit {
  double depth = std::numeric_limits<double>::infinity();
  int face = -1;        // in the explorer's order; −1: no hit
  bool failed = false;  // an exception ended the search on at least one face
  bool hit() const { return face >= 0; }
};

// The position of a point relative to one face.
enum class Standing {
  kOn,    // on the surface and inside the trims
  kEdge,  // its ray passes an edge or a vertex of the face within the tolerance of the shape
  kOff,   // neither
};

struct Judgement {
  Standing standing = Standing::kOff;
  int face = -1;  // the face that supports the point best
  double surface_mm =
      std::numeric_limits<double>::infinity();               // distance of the point to that face's surface
  double edge_mm = std::numeric_limits<double>::infinity();  // distance of the ray to the face's nearest edge
  double edge_tolerance_mm = 0;                              // tolerance of that edge
  bool inside_edge = false;  // the ray passes that edge's 3D curve on the side of the face
  double cosine = 1;         // |N·D| there
};

class ExactReference {
 public:
  // Reads a STEP or IGES file. With `one_placement`, only the first placement of each face is kept. Errors:
  // kFileUnreadable, kFormatUnknown, kNothingUsable.
  static Result<ExactReference> Load(const std::string& path, bool one_placement);
  ~ExactReference();
  ExactReference(ExactReference&&) noexcept;
  ExactReference& operator=(ExactReference&&) noexcept;

  std::size_t face_count() const;
  // Returns the kind of the face's surface, for tables: "plane", "cylinder", "B-spline", …
  std::string SurfaceName(int face) const;

  // Returns the nearest hit with a depth of at least `near` (depths as in camera.h), which may be −infinity.
  ReferenceHit Nearest(const Ray& ray, double near);

  // Returns the position of the point at `depth` on `ray` relative to the faces near it. `tolerance_mm` is
  // the distance up to which a point counts as on the surface.
  Judgement Judge(const Ray& ray, double depth, double tolerance_mm);

  // The shape's solids, as its explorer lists them.
  std::size_t solid_count() const;
  // Returns whether OpenCASCADE's classifier says that the point is inside a solid; nothing if it says that the point is on
  // the border of one, or fails. `tolerance_mm` is the distance up to which a point counts as on the border.
  std::optional<bool> IsInside(Vec3 point, double tolerance_mm);

 private:
  struct Data;
  explicit ExactReference(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace facetless
