// The patches of one surface, divided into pieces with oriented boxes, for finding the pieces near a point
// and for proving that no piece is near.
//
//  1. The box of a piece contains the convex hull of its control points, with rounding added.
//  2. The distance of a point from a box is never larger than its distance from the piece (up to rounding:
//     kBoxRounding of the coordinates).
//  3. Each piece has the native parameters of its middle, from which Newton's method may start.
//
//   SurfacePieces pieces(model, surface);
//   pieces.VisitNear(point, best * best, [&](const SurfacePieces::Piece& piece, double squared) { … return
//   new_best * new_best; });
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
    Vec3 center, axis[3];  // axes: perpendicular unit vectors
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

  // `model` must outlive this object.
  SurfacePieces(const Model& model, std::uint32_t surface);

  // Visits leaf pieces by increasing distance of their boxes, as long as the squared distance is below the
  // value that visit() last returned (initially `squared`).
  template <typename Visit>
  void VisitNear(Vec3 point, double squared, const Visit& visit) const;

  // A lower bound of the distance of `point` from the surface. Pieces are divided until the bound is at least
  // `enough`, or until `most_pieces` pieces have been examined.
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
