// CertificateCheck: a second opinion on certified samples, in plain arithmetic on the model's own patches.
//
// A certificate proves the mathematics and not the program: a kernel that runs with wrong loop lengths
// certifies wrong pixels. This check shares no code with what it judges: it knows no leaf, no projected net
// and no kernel.
//
//  1. A root holds if the point of the patch at the root's parameters, placed and projected as camera.h says,
//     lies on the sample's ray and at the sample's depth, within the bounds that the sample states and the
//     rounding of this check.
//  2. A ray is clear if halving every patch on its way finds no point of the surface that lies nearer than
//     the sample's depth by more than its error and that certainly belongs to its face: well inside its
//     patch, away from every edge's band, and not seen at grazing incidence. A ray that needs more than
//     kMaxCheckedPieces pieces stays open.
//  3. A contradiction is a defect of the program, never of the file. The tracer puts the sample in doubt
//     (kDoubtContradicted) and counts it.
//  4. Immutable; any number of threads may ask. The same bytes on every machine: plain arithmetic in a fixed
//     order.
//
//   const CertificateCheck check(scene.data(), frame);
//   if (!check.RootHolds({instance, face, patch, u, v, error_u, error_v, x, y, depth, depth_error})) …
#pragma once

#include <cstdint>
#include <vector>

#include "render/trace/scene.h"
#include "render/view/camera.h"

namespace facetless {

// Pieces of patches that one ray may cost before it stays open.
inline constexpr int kMaxCheckedPieces = 4096;

// A root as the tracer states it.
struct StatedRoot {
  std::uint32_t instance = 0, face = 0;  // indices into Model::instances and Model::faces
  std::uint32_t patch = 0;               // of the face's surface
  double u = 0, v = 0;                   // Bézier parameters in the patch; may lie a little outside [0,1]
  double error_u = 0, error_v = 0;       // how far the root may lie from there
  double x = 0, y = 0;                   // the ray's pixel coordinates
  double depth = 0, depth_error = 0;     // mm
};

enum class RayCheck : std::uint8_t { kClear, kContradicted, kOpen };

class CertificateCheck {
 public:
  // `scene` and `frame` must outlive the check.
  CertificateCheck(const Scene::Data& scene, const CameraFrame& frame);

  // Law 1.
  bool RootHolds(const StatedRoot& root) const;

  // Law 2, for the ray through pixel coordinates (x, y) whose nearest hit is stated at `depth` (infinite: a
  // miss).
  RayCheck CheckRay(double x, double y, double depth, double depth_error) const;

 private:
  // The image of a placed face's box: where it may be seen, and nearest depth.
  struct FaceBox {
    double x_low, x_high, y_low, y_high, near_depth;
  };
  // Of a patch, in part coordinates: no control point lies farther from the centre.
  struct PatchBall {
    Vec3 center;
    double radius;
  };
  struct Budget;
  FaceBox BoxOf(const Box3& box, const Placement& placement) const;
  void AddBalls(const Surface& surface);
  bool PatchMeetsRay(std::uint32_t instance, std::uint32_t face, std::uint32_t patch, double x, double y,
                     double limit, Budget* budget) const;
  bool IsCertainHit(std::uint32_t instance, std::uint32_t face, std::uint32_t patch, double u, double v,
                    double x, double y, double limit) const;

  const Scene::Data& scene_;
  const CameraFrame& frame_;
  std::vector<FaceBox> boxes_;           // of the placed faces
  std::vector<double> face_sizes_;       // of Model::faces: the largest coordinate of a control point, mm
  std::vector<PatchBall> balls_;         // of the patches of all faces, in their order
  std::vector<std::size_t> first_ball_;  // of Model::faces
};

}  // namespace facetless
