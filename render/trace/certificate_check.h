// CertificateCheck: an independent verification of certified samples, in plain arithmetic on the patches of
// the model.
//
//     const CertificateCheck check(scene.data(), frame);
//     if (!check.RootHolds({instance, face, patch, u, v, error_u, error_v, x, y, depth, depth_error}))
//       doubt |= kDoubtContradicted;
//
// A certificate proves the mathematics, not the program: a kernel with wrong loop lengths would certify wrong
// pixels. This check shares no code with the code that it verifies: it uses no leaves, no projected nets and
// no kernels.
//
//  1. A root holds if the point of the patch at the root's parameters, placed and projected as camera.h
//     defines, lies on the ray and at the depth of the sample, within the bounds of the sample and the
//     rounding of this check.
//  2. A ray is clear if repeated halving of every patch on its way finds no surface point that is nearer than
//     the sample's depth by more than its error and that certainly belongs to its face. A point certainly
//     belongs to its face if it lies well inside its patch, outside the band of every edge, and is not seen
//     at grazing incidence. A ray that needs more than kMaxCheckedPieces pieces stays open.
//  3. A contradiction is a defect of the program, never of the file. The tracer sets kDoubtContradicted for
//     the sample and counts it.
//  4. A CertificateCheck is immutable, and any number of threads may use it. It uses plain arithmetic in a
//     fixed order and gives the same bytes on every machine.
#pragma once

#include <cstdint>
#include <vector>

#include "render/trace/scene.h"
#include "render/view/camera.h"

namespace facetless {

// The number of pieces of patches that may be examined for one ray before the ray is left open.
inline constexpr int kMaxCheckedPieces = 4096;

// A root as stated by the tracer.
struct StatedRoot {
  std::uint32_t instance = 0, face = 0;  // indices into Model::instances and Model::faces
  std::uint32_t patch = 0;               // index of the patch in the face's surface
  double u = 0, v = 0;                   // Bézier parameters in the patch; may lie a little outside [0,1]
  double error_u = 0, error_v = 0;       // bounds of the errors of u and v
  double x = 0, y = 0;                   // pixel coordinates of the ray
  double depth = 0, depth_error = 0;     // mm
};

enum class RayCheck : std::uint8_t { kClear, kContradicted, kOpen };

class CertificateCheck {
 public:
  // `scene` and `frame` must outlive the check.
  CertificateCheck(const Scene::Data& scene, const CameraFrame& frame);

  // Verifies a root (law 1).
  bool RootHolds(const StatedRoot& root) const;

  // Verifies the ray through the pixel coordinates (x, y), for which the tracer states its nearest hit at
  // `depth` (infinite for a miss). See law 2.
  RayCheck CheckRay(double x, double y, double depth, double depth_error) const;

 private:
  // The image of the box of a placed face: the pixels that it may cover, and its nearest depth.
  struct FaceBox {
    double x_low, x_high, y_low, y_high, near_depth;
  };
  // A ball, in part coordinates, that contains all control points of a patch.
  struct PatchBall {
    Vec3 center;
    double radius;
  };
  struct Budget;
  FaceBox ProjectBox(const Box3& box, const Placement& placement) const;
  void AddBalls(const Surface& surface);
  bool PatchMeetsRay(std::uint32_t instance, std::uint32_t face, std::uint32_t patch, double x, double y,
                     double limit, Budget* budget) const;
  bool IsCertainHit(std::uint32_t instance, std::uint32_t face, std::uint32_t patch, double u, double v,
                    double x, double y, double limit) const;

  const Scene::Data& scene_;
  const CameraFrame& frame_;
  std::vector<FaceBox> boxes_;           // by placed face
  std::vector<double> face_sizes_;       // by face: the largest coordinate of a control point, mm
  std::vector<PatchBall> balls_;         // of the patches of all faces, in the order of Model::faces
  std::vector<std::size_t> first_ball_;  // by face: the index of its first ball
};

}  // namespace facetless
