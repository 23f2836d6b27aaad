#include "render/compare/surface_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <queue>

#include "render/kernels/dispatch.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

// The relative rounding error of a control point when it is put into a box.
constexpr double kBoxRounding = 64 * std::numeric_limits<double>::epsilon();
// A piece is flat enough for a start if its control points turn along either parameter by no more than about
// this angle, radians.
constexpr double kMostTurn = 0.125;
// Limits of the halvings of one patch, and of the pieces of a surface.
constexpr int kMostLevels = 12;
constexpr std::size_t kMostPieces = 1 << 16;

Vec3 PointOf(const BezierNet& net, int k, int l) {
  const int i = k * net.stride() + l;
  return (1 / net.at(i, kW)) * Vec3{net.at(i, kX), net.at(i, kY), net.at(i, kQ)};
}

// Returns the parameter along which the control points lie farther apart.
Direction LongerOf(const BezierNet& net) {
  double u = 0, v = 0;
  for (int l = 0; l <= net.degree_v; ++l) {
    double length = 0;
    for (int k = 0; k < net.degree_u; ++k) length += Length(PointOf(net, k + 1, l) - PointOf(net, k, l));
    u = std::max(u, length);
  }
  for (int k = 0; k <= net.degree_u; ++k) {
    double length = 0;
    for (int l = 0; l < net.degree_v; ++l) length += Length(PointOf(net, k, l + 1) - PointOf(net, k, l));
    v = std::max(v, length);
  }
  return u >= v ? Direction::kU : Direction::kV;
}

// Returns by how much the control points turn along a parameter, as the largest second difference divided by
// the longest line of control points.
double TurnAlong(const BezierNet& net, Direction direction) {
  const bool along_u = direction == Direction::kU;
  const int degree = along_u ? net.degree_u : net.degree_v, lines = along_u ? net.degree_v : net.degree_u;
  const auto point = [&](int i, int line) { return along_u ? PointOf(net, i, line) : PointOf(net, line, i); };
  double longest = 0, bend = 0;
  for (int line = 0; line <= lines; ++line) {
    double length = 0, own = 0;
    for (int i = 0; i < degree; ++i) {
      const Vec3 step = point(i + 1, line) - point(i, line);
      length += Length(step);
      if (i > 0) own += Length(step - (point(i, line) - point(i - 1, line)));
    }
    longest = std::max(longest, length);
    bend = std::max(bend, own);
  }
  return longest > 0 ? bend / longest : 0;
}

}  // namespace

double SurfacePieces::Box::SquaredTo(Vec3 point) const {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double beyond = std::fabs(Dot(axis[k], point - center)) - half[k];
    if (beyond > 0) sum += beyond * beyond;
  }
  return sum;
}

SurfacePieces::Box SurfacePieces::BoxOf(const BezierNet& net) {
  // The box is aligned with the sides of the net. If a side has collapsed, its axis follows from the others.
  const Vec3 corner[4] = {PointOf(net, 0, 0), PointOf(net, net.degree_u, 0), PointOf(net, 0, net.degree_v),
                          PointOf(net, net.degree_u, net.degree_v)};
  const Vec3 u = corner[1] - corner[0] + corner[3] - corner[2],
             v = corner[2] - corner[0] + corner[3] - corner[1];
  const bool u_longer = Length(u) >= Length(v);
  const Vec3 longer = u_longer ? u : v, shorter = u_longer ? v : u;
  Box box;
  box.axis[0] = Length(longer) > 0 ? Normalized(longer) : Vec3{1, 0, 0};
  Vec3 across = Cross(box.axis[0], shorter);
  if (!(Length(across) > 1e-9 * Length(shorter)) || !(Length(across) > 0)) {
    const Vec3 size{std::fabs(box.axis[0].x), std::fabs(box.axis[0].y), std::fabs(box.axis[0].z)};
    across = Cross(box.axis[0], size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                                : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                                     : Vec3{0, 0, 1});
  }
  box.axis[2] = Normalized(across);
  box.axis[1] = Cross(box.axis[2], box.axis[0]);
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, size = 0;
  for (int k = 0; k <= net.degree_u; ++k) {
    for (int l = 0; l <= net.degree_v; ++l) {
      const Vec3 p = PointOf(net, k, l);
      size = std::max(size, Length(p));
      for (int a = 0; a < 3; ++a) {
        const double at = Dot(box.axis[a], p);
        low[a] = std::min(low[a], at);
        high[a] = std::max(high[a], at);
      }
    }
  }
  box.center = {};
  for (int a = 0; a < 3; ++a) {
    box.center = box.center + (0.5 * (low[a] + high[a])) * box.axis[a];
    box.half[a] = 0.5 * (high[a] - low[a]) + kBoxRounding * size;
  }
  return box;
}

void SurfacePieces::Load(std::uint32_t patch, OwnedNet* net) const {
  net->SetDegrees(surface_.degree_u, surface_.degree_v);
  const Vec4* points = PatchPoints(model_, surface_, patch).data();
  std::fill_n(net->net.error, int{kNetComponents}, 0.0);
  for (int i = 0; i < net->net.points(); ++i) {
    net->net.at(i, kX) = points[i].x;
    net->net.at(i, kY) = points[i].y;
    net->net.at(i, kQ) = points[i].z;
    net->net.at(i, kW) = points[i].w;
  }
}

void SurfacePieces::SetMiddle(Piece* piece) const {
  piece->u = u_maps_[piece->patch / surface_.v_spans.count].ToNative(0.5 * (piece->u0 + piece->u1));
  piece->v = v_maps_[piece->patch % surface_.v_spans.count].ToNative(0.5 * (piece->v0 + piece->v1));
}

SurfacePieces::SurfacePieces(const Model& model, std::uint32_t surface)
    : model_(model), surface_(model.surfaces[surface]), nets_(*ActiveKernels().value().nets) {
  for (const Span& span : USpansOf(model, surface_)) u_maps_.emplace_back(span);
  for (const Span& span : VSpansOf(model, surface_)) v_maps_.emplace_back(span);
  pieces_.resize(surface_.PatchCount());
  struct Open {
    std::unique_ptr<OwnedNet> net;
    std::uint32_t piece;
    int level;
  };
  std::vector<Open> level, next;
  for (std::uint32_t patch = 0; patch < pieces_.size(); ++patch) {
    auto net = std::make_unique<OwnedNet>();
    Load(patch, net.get());
    pieces_[patch].patch = patch;
    pieces_[patch].box = BoxOf(net->net);
    SetMiddle(&pieces_[patch]);
    level.push_back({std::move(net), patch, 0});
  }
  // Halve the pieces that are not flat, level by level, with all patches at the same level.
  for (int depth = 0; depth < kMostLevels && !level.empty(); ++depth) {
    for (Open& open : level) {
      const Piece piece = pieces_[open.piece];
      const double turn_u = TurnAlong(open.net->net, Direction::kU),
                   turn_v = TurnAlong(open.net->net, Direction::kV);
      if (!(std::max(turn_u, turn_v) > kMostTurn)) continue;
      if (pieces_.size() + 2 > kMostPieces + surface_.PatchCount()) continue;
      const Direction direction = turn_u >= turn_v ? Direction::kU : Direction::kV;
      Open half[2] = {{std::make_unique<OwnedNet>(), 0, 0}, {std::make_unique<OwnedNet>(), 0, 0}};
      for (Open& one : half) one.net->SetDegrees(surface_.degree_u, surface_.degree_v);
      nets_.halve(open.net->net, direction, &half[0].net->net, &half[1].net->net);
      pieces_[open.piece].first_child = static_cast<std::uint32_t>(pieces_.size());
      for (int k = 0; k < 2; ++k) {
        Piece child = piece;
        child.first_child = 0;
        if (direction == Direction::kU) (k == 0 ? child.u1 : child.u0) = 0.5 * (piece.u0 + piece.u1);
        if (direction == Direction::kV) (k == 0 ? child.v1 : child.v0) = 0.5 * (piece.v0 + piece.v1);
        child.box = BoxOf(half[k].net->net);
        SetMiddle(&child);
        half[k].piece = static_cast<std::uint32_t>(pieces_.size());
        pieces_.push_back(child);
        next.push_back(std::move(half[k]));
      }
    }
    level = std::move(next);
    next.clear();
  }
}

double SurfacePieces::LowerBound(Vec3 point, double enough, int most_pieces) const {
  struct Entry {
    double squared;
    std::uint64_t order;
    std::unique_ptr<OwnedNet> net;
  };
  const auto later = [](const Entry& a, const Entry& b) {
    return std::pair{a.squared, a.order} > std::pair{b.squared, b.order};
  };
  std::vector<Entry> heap;
  std::uint64_t order = 0;
  const auto add = [&](std::unique_ptr<OwnedNet> net) {
    const double squared = BoxOf(net->net).SquaredTo(point);
    heap.push_back({squared, order++, std::move(net)});
    std::push_heap(heap.begin(), heap.end(), later);
  };
  for (std::uint32_t patch = 0; patch < surface_.PatchCount(); ++patch) {
    if (pieces_[patch].box.SquaredTo(point) >= enough * enough) continue;
    auto net = std::make_unique<OwnedNet>();
    Load(patch, net.get());
    add(std::move(net));
  }
  for (int count = 0; !heap.empty() && heap.front().squared < enough * enough; ++count) {
    if (count >= most_pieces) return std::sqrt(heap.front().squared);
    std::pop_heap(heap.begin(), heap.end(), later);
    const std::unique_ptr<OwnedNet> net = std::move(heap.back().net);
    heap.pop_back();
    auto low = std::make_unique<OwnedNet>(), high = std::make_unique<OwnedNet>();
    low->SetDegrees(surface_.degree_u, surface_.degree_v);
    high->SetDegrees(surface_.degree_u, surface_.degree_v);
    nets_.halve(net->net, LongerOf(net->net), &low->net, &high->net);
    add(std::move(low));
    add(std::move(high));
  }
  return enough;
}

}  // namespace facetless
