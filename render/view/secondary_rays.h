// SecondaryRays: rays in any direction that start on the surfaces of a representation, or anywhere in space. They are
// used for shadows, ambient occlusion, reflection and refraction. A representation makes the object only if light is
// requested.
//
//     std::vector<RayStart> starts = …;                      // hits of a view
//     const SecondaryRay rays[] = {{.start = 0, .direction = light}};
//     RayPassage passages[1];
//     rays_of_model->FindBlocked(starts, rays, passages);
//     if (passages[0].blocked) ++dark;
//
//  1. A ray begins at its start and does not meet the start's own point of the surface again. On exact surfaces, that
//     point is recognised by its parameters and its error, not by a distance, and the start is not lifted off the
//     surface. On triangles, the start is lifted by lift_mm().
//  2. All functions are const, answer whole batches, and may be called from many threads at once. The answers do not
//     depend on the number of threads, on how rays are grouped into batches, or on the instruction set. The answers of
//     triangles are Embree's, and may depend on the processor.
//  3. An answer of exact surfaces is certified if it is proven. A blocked ray is proven by a certified root within its
//     length and inside its trimmed face; a clear ray is proven if every candidate is proven empty or trimmed away. An
//     answer that is not certified states its reasons, as bits of Doubt. The answers of triangles are never certified,
//     and state no reasons.
//  4. No ray meets the faces that were left out (SecondaryRaysRequest::leave_out), even if it starts inside their
//     solid.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/base/vec.h"
#include "render/model/model.h"

namespace facetless {

// A point from which secondary rays start. For a point on no face (of the ground, or in the air) `placed_face` is
// kNoIndex, and the parameters mean nothing.
struct RayStart {
  Vec3 position;                         // mm, model axes
  Vec3 normal;                           // unit vector of the surface; either side. (0,0,0) if there is none
  std::uint32_t placed_face = kNoIndex;  // of the model
  double u = 0, v = 0;                   // native parameters of the face; exact surfaces need them
  double error = 0;  // the exact point of the surface lies within this distance of `position`, mm
};

struct SecondaryRay {
  std::uint32_t start = 0;   // index among the batch's starts
  Vec3 direction;            // unit vector, model axes
  double length = INFINITY;  // mm, above 0; surfaces that are farther away do not count
};

struct RayPassage {
  bool blocked = false;    // a surface lies on the ray
  bool certified = false;  // law 3
  std::uint8_t doubt = 0;  // bits of Doubt; 0 if the answer is certified
};

// The nearest surface on a ray.
struct SecondaryHit {
  double distance = INFINITY;            // mm from the start; infinite for a miss
  std::uint32_t placed_face = kNoIndex;  // kNoIndex for a miss
  double u = 0, v = 0;                   // native parameters; set by exact surfaces only
  Vec3 position;                         // mm, model axes
  Vec3 normal;                           // unit vector, outward by the orientation of the face
  double error = 0;                      // bound of the error of the position, mm, if the hit is certified
  bool certified = false;
  std::uint8_t doubt = 0;  // bits of Doubt; 0 if the answer is certified
};

// The structure for rays on exact surfaces that is fastest if rays start on surfaces (rays/exact_rays.h).
inline constexpr const char* kUsualStructure = "blocks";

// How a representation makes its rays.
struct SecondaryRaysRequest {
  // Indexed by placed face: rays ignore the faces that are set. Empty: no face is ignored.
  std::vector<bool> leave_out;
  // The structure that finds candidates: kUsualStructure or a name of accel/structures.h. Triangles ignore the name and
  // always use Embree's.
  std::string structure = kUsualStructure;
};

class SecondaryRays {
 public:
  virtual ~SecondaryRays() = default;

  // Sets passages[i] to whether anything blocks rays[i]. Requires as many passages as rays.
  virtual void FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                           std::span<RayPassage> passages) const = 0;
  // Sets hits[i] to the nearest surface on rays[i]. Requires as many hits as rays.
  virtual void FindNearest(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                           std::span<SecondaryHit> hits) const = 0;

  virtual std::string structure() const = 0;  // name of the structure that finds candidates: "bvh"
  virtual double build_ms() const = 0;        // time for making the structure and the pieces in it
  virtual std::uint64_t bytes() const = 0;  // memory of the structure and the pieces in it, without the model
  virtual double lift_mm() const { return 0; }  // law 1
};

}  // namespace facetless
