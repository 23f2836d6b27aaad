// RayRoots: the roots of one ray in the pieces that it may meet, each with what is proven of it.
//
//     RayRoots roots(scene);
//     roots.Begin(start, /*same_start=*/false, direction, length);
//     structure.Visit(segment, state, [&](std::uint32_t id) {
//       roots.Examine(instance_of(id), piece_of(id));
//       return roots.blocked() ? kStop : roots.limit();
//     });
//
//  1. Examine projects a piece onto two planes through the ray and solves it with FallbackSolver, whose proofs hold
//     for the exact surface and the exact line. It appends the roots in front of the start and within the length.
//  2. The start's own root is recognised by its parameters. RayRoots measures the distance d of the start from the
//     surface point of its parameters. A proven root is the only one in its piece, and it moves by at most spread·d if
//     the ray moves by d (fallback_solver.h, law 6). A root of the start's face whose parameters are within this reach
//     of the start's is therefore the start's own; no distance along the ray is needed. The own root is left out,
//     without a doubt. If its piece is too small for the reach, or the root has no proof, the ray is nearly tangent to
//     the surface at its start, which is a doubt (kDoubtSilhouette). Until the own root is found, no other root of
//     that face counts as proven, because it might be the own one.
//  3. Another root whose distance may be zero within its error is a doubt (kDoubtCoincident), because another face, or
//     the same face across a border, may pass through the start.
//  4. Trimming is decided as in a picture: by the p-curves away from all edges, and within the gap of an edge by the
//     side of the 3D edge on which the ray passes (trace/projected_edges.h), so that neighbours agree. An answer that
//     is not proven is the best one, with kDoubtTrim.
//  5. A root on a border of its patch may belong to the neighbouring patch. It is certain if the neighbour has the
//     root, too, with the same orientation; otherwise it is a doubt (kDoubtTwoRoots).
#pragma once

#include <cstdint>
#include <vector>

#include "render/nurbs/surface_eval.h"
#include "render/rays/ray_projection.h"
#include "render/rays/space_pieces.h"
#include "render/trace/fallback_solver.h"
#include "render/trace/scene.h"
#include "render/view/secondary_rays.h"

namespace facetless {

// What all threads share, read-only.
struct RayScene {
  const Scene::Data* scene = nullptr;
  const NetOperations* nets = nullptr;
  SpacePieces pieces;
  std::vector<PlacedPart> parts;                // one for each instance
  std::vector<SurfaceEval> surfaces;            // one for each face
  std::vector<std::uint32_t> instance_of_face;  // by placed face
  std::vector<bool> shown;                      // by placed face: it is not left out
  double pixel = 1;                             // size of a pixel in the frames of rays, mm

  const Model& model() const { return *scene->model; }
  std::uint32_t FaceOf(std::uint32_t placed_face) const;  // index into Model::faces
};

struct RayRoot {
  double distance = 0, error = 0;  // mm from the start
  std::uint32_t placed_face = 0, patch = 0;
  double u = 0, v = 0;     // native parameters
  double orientation = 0;  // sign of the Jacobian of (u, v) → pixel
  bool inside = true;   // the root counts, by the best answers to whether it exists and is not trimmed away
  bool border = false;  // on a border of its patch, and the neighbour's root is not found yet (law 5)
  std::uint8_t doubt = 0;  // bits of Doubt; 0: proven
  Vec3 normal;             // unit vector along Su × Sv as placed
};

// A piece in which roots are neither found nor proven absent.
struct OpenQuestion {
  double distance = 0;  // no point of the piece is nearer to the start, mm
  std::uint8_t doubt = 0;
};

class RayRoots {
 public:
  // `scene` must outlive this object. One object serves one thread.
  explicit RayRoots(const RayScene& scene);

  // Begins a ray. If `same_start` is set, `start` must be the start of the previous ray; its preparation is then kept.
  // The direction must have a length of 1 within a few units in the last place. `length` is in mm.
  void Begin(const RayStart& start, bool same_start, Vec3 direction, double length);
  // Finds the roots of the ray in a piece of the part that `instance` places.
  void Examine(std::uint32_t instance, const SpacePiece& piece);

  bool blocked() const { return blocked_; }  // a proven root was found
  // False if a root of the start's face may be the start's own, because the own root is not found yet (law 2).
  bool complete() const;
  // Tells RayRoots that the start's own root lies in a piece that is not examined, and in no other piece.
  void KnowOwnRoot() { FindOwnRoot(); }
  // A bound of the distance of the nearest proven root, mm; the length if there is none.
  double limit() const { return limit_; }
  const std::vector<RayRoot>& roots() const { return roots_; }
  const std::vector<OpenQuestion>& questions() const { return questions_; }

 private:
  struct Site;
  enum class Own : std::uint8_t { kNo, kYes, kUnknown };

  void PrepareStart(const RayStart& start);
  void AddRoot(const Site& site, const FallbackRoot& root);
  Own IsOwnRoot(const Site& site, const FallbackRoot& root) const;
  // Sets root->inside, and adds to its doubt, by the trimming.
  void Trim(const Site& site, const FallbackRoot& found, double cosine, RayRoot* root) const;
  void PairWithNeighbour(RayRoot* root);
  void Settle(const RayRoot& root);
  void FindOwnRoot();

  const RayScene& scene_;
  FallbackSolver solver_;
  RayWork work_;
  OwnedNet net_;
  std::vector<FallbackRoot> found_;
  std::vector<RayRoot> roots_;
  std::vector<OpenQuestion> questions_;

  // The ray.
  RayFrame frame_;
  double length_ = 0, limit_ = 0;
  bool blocked_ = false, awaiting_own_ = false;
  // The projection for the instance of the last piece.
  std::uint32_t instance_ = kNoIndex;
  std::vector<RayProjection> projection_;  // empty, or one

  // The start.
  std::uint32_t start_face_ = kNoIndex;  // placed face
  double start_u_ = 0, start_v_ = 0;
  double start_error_ = 0;  // bound of the distance of the start from the surface at (u, v), mm
};

}  // namespace facetless
