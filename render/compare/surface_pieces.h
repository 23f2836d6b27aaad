// The patches of one surface, cut into pieces in boxes that are turned with them: what lies near a point, and
// what surely does not.
//
//  1. Each piece lies in its box: the box holds the convex hull of its control points, and rounding is added.
//  2. The distance of a point to a box is never more than its distance to the piece (to rounding:
//     kBoxRounding of the coordinates).
//  3. Pieces come with the native parameters of their middle, where Newton's method may start.
//
//   SurfacePieces pieces(model, surface);
//   pieces.VisitNear(point, best * best, [&](const SurfacePieces::Piece& piece, double squared) { … return new_best * new_best; });
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/angle_map.h"
#include "render/nurbs/net_operations.h"

namespace facetless {

class SurfacePieces {
 public:
  struct Box {
    Vec3 center, axis[3];  // axes: unit, at right angles
    double half[3] = {0, 0, 0};
    double SquaredTo(Vec3 point) const;
  };
  struct Piece {
    Box box;
    double u = 0, v = 0;                    // native, of the middle
    std::uint32_t patch = 0;                // of the surface
    double u0 = 0, u1 = 1, v0 = 0, v1 = 1;  // Bézier parameters in the patch
    std::uint32_t first_child = 0;          // and the next one; 0: a leaf
  };

  // `model` must outlive it.
  SurfacePieces(const Model& model, std::uint32_t surface);

  // Visits leaves by rising distance of their boxes, while that is below the square that visit() returned
  // last (`squared` at first).
  template <typename Visit>
  void VisitNear(Vec3 point, double squared, const Visit& visit) const;

  // A lower bound of the distance of `point` to the surface, by dividing pieces until the bound is at least
  // `enough` or `most_pieces` have been looked at.
  double LowerBound(Vec3 point, double enough, int most_pieces) const;

 private:
  void Load(std::uint32_t patch, OwnedNet* net) const;
  static Box BoxOf(const BezierNet& net);
  void SetMiddle(Piece* piece) const;

  const Model& model_;
  const Surface& surface_;
  const NetOperations& nets_;
  std::vector<SpanParameter> u_maps_, v_maps_;
  std::vector<Piece> pieces_;  // children after their parents; the patches first
};

template <typename Visit>
void SurfacePieces::VisitNear(Vec3 point, double squared, const Visit& visit) const {
  struct Entry {
    double squared;
    std::uint32_t piece;
    bool operator<(const Entry& other) const { return squared > other.squared; }
  };
  std::vector<Entry> heap;
  const auto add = [&](std::uint32_t i) {
    const double to = pieces_[i].box.SquaredTo(point);
    if (!(to < squared)) return;
    heap.push_back({to, i});
    std::push_heap(heap.begin(), heap.end());
  };
  for (std::uint32_t i = 0; i < surface_.PatchCount(); ++i) add(i);
  while (!heap.empty() && heap.front().squared < squared) {
    std::pop_heap(heap.begin(), heap.end());
    const Entry next = heap.back();
    heap.pop_back();
    const Piece& piece = pieces_[next.piece];
    if (piece.first_child == 0) {
      squared = visit(piece, next.squared);
    } else {
      add(piece.first_child);
      add(piece.first_child + 1);
    }
  }
}

}  // namespace facetless
