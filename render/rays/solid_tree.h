// Rays in any direction against the exact faces of one solid.
//
//  1. Patches are cut into pieces that are nearly parallelograms (kFlatness), and a tree of boxes stands over
//     the pieces that the trimming does not rule out. Each piece that a ray may meet is solved by Newton on
//     the surface itself, in native parameters: the distance is exact to rounding, whatever the pieces are
//     like.
//  2. A root counts if its parameters lie within its piece, to kOverlap of its width, and inside the face's
//     trimming; within the gap of an edge it counts for both faces, so that no ray slips out between them.
//     The nearest one is the answer.
//  3. Of a ray that touches a surface without crossing it either answer may come back: nothing is certified
//     here, unlike in a picture.
//  4. Immutable once built; queries allocate nothing. No libm but sqrt: the same bits everywhere.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/nurbs/surface_eval.h"
#include "render/trace/direct.h"

namespace facetless {

struct SolidHit {
  double t = 0;  // of origin + t·direction
  std::uint32_t face = 0;
  double u = 0, v = 0;
};

class SolidTree {
 public:
  // Over `faces` (of Model::faces, of one part). `surfaces` by face index; both must outlive the tree.
  SolidTree(const Scene& scene, const std::vector<SurfaceEval>& surfaces,
            const std::vector<std::uint32_t>& faces);

  // The first crossing with t > t_least, in part coordinates. `direction` need not be a unit vector.
  std::optional<SolidHit> Nearest(Vec3 origin, Vec3 direction, double t_least) const;

  const Box3& bounds() const { return bounds_; }
  std::size_t pieces() const { return pieces_.size(); }
  std::size_t bytes() const { return pieces_.capacity() * sizeof(Piece) + nodes_.capacity() * sizeof(Node); }

 private:
  struct Piece {
    Box3 box;
    std::uint32_t face = 0;
    bool whole = false;  // proven inside the trimming
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  };
  struct Node {
    Box3 box;
    std::uint32_t first = 0, count = 0;  // pieces of a leaf; count 0: children are first and first + 1
  };
  struct Probe;

  void AddFace(std::uint32_t face);
  void Build();
  void Solve(const Piece& piece, const Probe& probe, std::optional<SolidHit>& nearest) const;
  void SolveFrom(const Piece& piece, const Probe& probe, Vec2 start, std::optional<SolidHit>& nearest) const;

  const Scene::Data& scene_;
  const std::vector<SurfaceEval>& surfaces_;
  std::vector<Piece> pieces_;
  std::vector<Node> nodes_;
  Box3 bounds_;
};

}  // namespace facetless
