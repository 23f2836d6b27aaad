#include "bench/leaf_boxes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "render/kernels/dispatch.h"
#include "render/model/walk.h"
#include "render/nurbs/angle_map.h"
#include "render/nurbs/net_operations.h"
#include "render/trace/scene.h"

namespace facetless {
namespace {

constexpr int kMostHalvings = 12;  // of a patch, on the way to one piece

struct Piece {
  std::unique_ptr<OwnedNet> net;
  double u0 = 0, u1 = 1, v0 = 0, v1 = 1;  // Bézier parameters in the patch
  int halvings = 0;
};

Vec3 Cartesian(const BezierNet& net, int i) {
  const double w = net.at(i, kW);
  return {net.at(i, kX) / w, net.at(i, kY) / w, net.at(i, kQ) / w};
}

// The largest distance of control points from the lines through the ends of their rows, as a share of the
// diagonal.
double BendAlong(const BezierNet& net, Direction direction, double diagonal) {
  double bend = 0;
  for (int k = 0; k <= net.degree_u; ++k)
    for (int l = 0; l <= net.degree_v; ++l) {
      const bool u = direction == Direction::kU;
      const double share = u ? static_cast<double>(k) / net.degree_u : static_cast<double>(l) / net.degree_v;
      const Vec3 first = Cartesian(net, u ? l : k * net.stride());
      const Vec3 last = Cartesian(net, u ? net.degree_u * net.stride() + l : k * net.stride() + net.degree_v);
      const Vec3 on_line = (1 - share) * first + share * last;
      bend = std::max(bend, Length(Cartesian(net, k * net.stride() + l) - on_line));
    }
  return diagonal > 0 ? bend / diagonal : 0;
}

class Divider {
 public:
  Divider(const Model& model, std::size_t most) : model_(model), scene_(model), most_(most) {}

  std::vector<Box3> Divide() {
    for (const Instance& instance : model_.instances)
      for (const PlacedFace placed : WalkPlacedFaces(model_, instance))
        AddFace(instance.placement, placed.face);
    return std::move(boxes_);
  }

 private:
  void AddFace(const Placement& placement, std::uint32_t face) {
    const Surface& surface = model_.surfaces[model_.faces[face].surface];
    const FaceData& data = scene_.data().faces[face];
    for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
      if (data.patches[patch] == RectClass::kOutside) continue;
      const Span& u_span = model_.spans[surface.u_spans.first + patch / surface.v_spans.count];
      const Span& v_span = model_.spans[surface.v_spans.first + patch % surface.v_spans.count];
      open_.clear();
      open_.push_back(PlacedPatch(placement, surface, patch));
      while (!open_.empty()) {
        Piece piece = std::move(open_.back());
        open_.pop_back();
        const RectClass where =
            data.trim.Classify(BezierToNative(u_span, piece.u0), BezierToNative(u_span, piece.u1),
                               BezierToNative(v_span, piece.v0), BezierToNative(v_span, piece.v1));
        if (where != RectClass::kOutside) AddPiece(std::move(piece));
      }
    }
  }

  Piece PlacedPatch(const Placement& placement, const Surface& surface, std::uint32_t patch) const {
    Piece piece;
    piece.net = std::make_unique<OwnedNet>();
    piece.net->SetDegrees(surface.degree_u, surface.degree_v);
    std::fill_n(piece.net->net.error, int{kNetComponents}, 0.0);
    int i = 0;
    for (const Vec4& h : PatchPoints(model_, surface, patch)) {
      const Vec3 p = placement.Point({h.x / h.w, h.y / h.w, h.z / h.w});
      BezierNet& net = piece.net->net;
      net.at(i, kX) = h.w * p.x, net.at(i, kY) = h.w * p.y, net.at(i, kQ) = h.w * p.z, net.at(i, kW) = h.w;
      ++i;
    }
    return piece;
  }

  // Adds the piece's box, or its halves to those that are open.
  void AddPiece(Piece piece) {
    const BezierNet& net = piece.net->net;
    Box3 box;
    for (int i = 0; i < net.points(); ++i) box.Add(Cartesian(net, i));
    const double bend_u = BendAlong(net, Direction::kU, box.diagonal()),
                 bend_v = BendAlong(net, Direction::kV, box.diagonal());
    if (!(std::max(bend_u, bend_v) > kLeafFlatness) || piece.halvings == kMostHalvings ||
        boxes_.size() + open_.size() >= most_) {
      boxes_.push_back(box);
      return;
    }
    const Direction direction = bend_u >= bend_v ? Direction::kU : Direction::kV;
    Piece halves[2];
    for (Piece& half : halves) {
      half.net = std::make_unique<OwnedNet>();
      half.net->SetDegrees(net.degree_u, net.degree_v);
      half.u0 = piece.u0, half.u1 = piece.u1, half.v0 = piece.v0, half.v1 = piece.v1;
      half.halvings = piece.halvings + 1;
    }
    nets_.halve(net, direction, &halves[0].net->net, &halves[1].net->net);
    if (direction == Direction::kU)
      halves[0].u1 = halves[1].u0 = 0.5 * (piece.u0 + piece.u1);
    else
      halves[0].v1 = halves[1].v0 = 0.5 * (piece.v0 + piece.v1);
    for (Piece& half : halves) open_.push_back(std::move(half));
  }

  const Model& model_;
  const Scene scene_;
  const std::size_t most_;
  const NetOperations& nets_ = *ActiveKernels().value().nets;
  std::vector<Piece> open_;
  std::vector<Box3> boxes_;
};

}  // namespace

std::vector<Box3> LeafBoxes(const Model& model, std::size_t most) {
  return Divider(model, most).Divide();
}

}  // namespace facetless
