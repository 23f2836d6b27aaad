// SolidTree: intersects rays in any direction with the exact faces of one solid.
//
//     const SolidTree tree(scene, surfaces, faces);
//     if (const auto hit = tree.Nearest(origin, direction, /*t_least=*/1e-9)) thickness = hit->t;
//
//  1. Patches are divided into pieces that are nearly parallelograms (kFlatness), and a tree of boxes is
//     built over the pieces that are not trimmed away. Each piece that a ray may meet is solved by Newton's
//     method on the surface itself, in native parameters, so the distance is exact up to rounding, whatever
//     the shapes of the pieces.
//  2. A root is accepted if its parameters lie within its piece, extended by kOverlap of its width, and
//     inside the trimmed face. Within the gap of an edge, it is accepted for both faces, so that no ray
//     escapes between them. The nearest accepted root is the answer.
//  3. For a ray that touches a surface without crossing it, the result may be a hit or a miss. Unlike in a
//     picture, nothing is certified here.
//  4. A SolidTree is immutable once it is built, and queries allocate nothing. sqrt is the only libm function
//     used, so the results have the same bits on every machine.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/nurbs/surface_eval.h"
#include "render/trace/direct.h"

namespace facetless {

struct SolidHit {
  double t = 0;  // the hit is at origin + t·direction
  std::uint32_t face = 0;
  double u = 0, v = 0;
};

class SolidTree {
 public:
  // Builds the tree over `faces` (indices into Model::faces, all of one part). `surfaces` is indexed by face.
  // `scene` and `surfaces` must outlive the tree.
  SolidTree(const Scene& scene, const std::vector<SurfaceEval>& surfaces,
            const std::vector<std::uint32_t>& faces);

  // The first crossing with t > t_least, in part coordinates; nothing if there is none. `direction` need not
  // be a unit vector.
  std::optional<SolidHit> Nearest(Vec3 origin, Vec3 direction, double t_least) const;

  const Box3& bounds() const { return bounds_; }
  std::size_t pieces() const { return pieces_.size(); }
  std::size_t bytes() const { return pieces_.capacity() * sizeof(Piece) + nodes_.capacity() * sizeof(Node); }

 private:
  struct Piece {
    Box3 box;
    std::uint32_t face = 0;
    bool whole = false;  // proven to lie inside the trimmed face
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  };
  struct Node {
    Box3 box;
    std::uint32_t first = 0,
                  count =
                      0;  // the pieces of a leaf node; count 0: the children are nodes first and first + 1
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
