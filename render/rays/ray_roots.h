// RayRoots: the roots of one ray in the pieces that it may meet, each with what is proven of it.
//
//     RayRoots roots(scene);
//     roots.Begin(start, direction, length);
//     structure.Visit(segment, state, [&](std::uint32_t id) {
//       roots.Examine(instance, piece, length);
//       return roots.blocked() ? kStop : length;
//     });
//
//  1. Examine projects a piece onto two planes through the ray and solves it with FallbackSolver, whose proofs hold
//     for the exact surface and the exact line. It appends the roots in front of the start and within the length.
//  2. The start's own root is a root of its face within reach of the start's parameters. The distance of the start
//     from the surface point of its parameters is measured; a proven root is the only one in its piece, and it
//     moves by at most spread·d if the ray moves by d (fallback_solver.h, law 6). So the start's own point and
//     such a root are the same root of the surface, and no distance along the ray is needed to tell. It is left out,
//     and nothing is doubted. If the piece with the root is too small for that reach, or the root has no proof, the
//     ray is tangent to the surface at its start, and that is a doubt (kDoubtSilhouette). Until the own root is found,
//     no other root of that face counts as proven, because it might be the own one.
//  3. Another root whose distance may be zero within its error is a doubt (kDoubtCoincident): another face, or the
//     other side of a border, passes through the start.
//  4. Trimming is decided as in a picture: by the p-curves away from all edges, and within the gap of an edge by the
//     side of the 3D edge on which the ray passes (trace/projected_edges.h), so that neighbours agree. An answer that
//     is not proven is the best one, with kDoubtTrim.
//  5. A root on a border of its patch may be the neighbour's. It is certain if the neighbour has it, too, with the
//     same orientation; otherwise it is a doubt (kDoubtTwoRoots).
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
  std::vector<bool> shown;                      // by placed face: it has pieces, and is not left out
  double pixel = 1;                             // of the frames of rays

  const Model& model() const { return *scene->model; }
  std::uint32_t FaceOf(std::uint32_t placed_face) const;  // index into Model::faces
};

struct RayRoot {
  double distance = 0, error = 0;  // mm from the start
  std::uint32_t placed_face = 0, patch = 0;
  double u = 0, v = 0;     // native parameters
  double orientation = 0;  // sign of the Jacobian of (u, v) → pixel
  bool inside = true;      // it counts: the best answer to all questions
  bool border = false;     // on a border of its patch; otherwise proven, and waiting for its neighbour's
  std::uint8_t doubt = 0;  // bits of Doubt; 0: proven
  Vec3 normal;             // unit, along Su × Sv as placed; of the roots that are `inside`
};

// Something that is neither a root nor proven absent, not nearer than `distance`.
struct OpenQuestion {
  double distance = 0;
  std::uint8_t doubt = 0;
};

class RayRoots {
 public:
  // `scene` must outlive this object. One object serves one thread.
  explicit RayRoots(const RayScene& scene);

  // Begins a ray. `start` may be the same object as of the ray before; then what is known of it is kept. The direction
  // has a length of 1 within a few units in the last place.
  void Begin(const RayStart& start, bool same_start, Vec3 direction, double length);
  // Finds the roots of the ray in a piece of the part that `instance` places.
  void Examine(std::uint32_t instance, const SpacePiece& piece);

  bool blocked() const { return blocked_; }  // a proven root was found
  // False if a root of the start's face may be the start's own, because that is not found (law 2).
  bool complete() const;
  // Says that the start's own root is known from elsewhere, and that no other piece has it.
  void KnowOwnRoot() { FindOwnRoot(); }
  // The distance at which a proven root lies at most; the length if there is none.
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
