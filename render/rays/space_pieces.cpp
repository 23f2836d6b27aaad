#include "render/rays/space_pieces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include "render/base/parallel.h"
#include "render/kernels/dispatch.h"
#include "render/model/walk.h"
#include "render/trace/scene.h"

namespace facetless {
namespace {

// A piece whose control points lie within this share of its diagonal from a parallelogram turns by a few degrees from
// end to end, so most rays meet it with a certificate.
constexpr double kFlatness = 1.0 / 32;
constexpr int kMostHalvings = 6;  // of one patch in one direction

constexpr double kEpsilon = 0x1p-53;

Vec3 Cartesian(const BezierNet& net, int k, int l) {
  const int i = k * net.stride() + l;
  const double w = net.at(i, kW);
  return {net.at(i, kX) / w, net.at(i, kY) / w, net.at(i, kQ) / w};
}

// How far the control points are from the parallelogram of the corners, and how much of it a halving in each direction
// removes: lines along u that are bent or unevenly spaced, and lines along v.
struct Bend {
  double u = 0, v = 0;
  double diagonal = 0;
};

Bend MeasureBend(const BezierNet& net) {
  const int p = net.degree_u, q = net.degree_v;
  const Vec3 c00 = Cartesian(net, 0, 0), c01 = Cartesian(net, 0, q), c10 = Cartesian(net, p, 0),
             c11 = Cartesian(net, p, q);
  Bend bend;
  bend.diagonal = std::max(Length(c11 - c00), Length(c10 - c01));
  for (int k = 0; k <= p; ++k) {
    const double s = static_cast<double>(k) / p;
    for (int l = 0; l <= q; ++l) {
      const double t = static_cast<double>(l) / q;
      const Vec3 point = Cartesian(net, k, l);
      bend.u = std::max(bend.u, Length(point - ((1 - s) * Cartesian(net, 0, l) + s * Cartesian(net, p, l))));
      bend.v = std::max(bend.v, Length(point - ((1 - t) * Cartesian(net, k, 0) + t * Cartesian(net, k, q))));
    }
  }
  // A twist is halved in both directions alike: take the one whose sides are longer.
  const double twist = 0.25 * Length((c11 - c10) - (c01 - c00));
  (Length(c10 - c00) + Length(c11 - c01) >= Length(c01 - c00) + Length(c11 - c10) ? bend.u : bend.v) += twist;
  return bend;
}

}  // namespace

// Divides the patches of one face after the other; each thread has its own.
class SpacePieces::Divider {
 public:
  Divider(const Scene::Data& scene, const NetOperations& nets) : scene_(scene), nets_(nets) {}

  // Appends the pieces of a face.
  void Divide(std::uint32_t face, Vec3 origin, std::vector<SpacePiece>* pieces, CoefficientArena* arena) {
    const Model& model = *scene_.model;
    const Surface& surface = model.surfaces[model.faces[face].surface];
    face_ = &scene_.faces[face];
    face_index_ = face;
    origin_ = origin;
    pieces_ = pieces;
    arena_ = arena;
    for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
      if (face_->patches[patch] == RectClass::kOutside) continue;
      const std::uint32_t i = patch / surface.v_spans.count, j = patch % surface.v_spans.count;
      bounds_ = SetBoxBounds(*face_, surface, i, j);
      u_map_ = &scene_.spans[surface.u_spans.first + i];
      v_map_ = &scene_.spans[surface.v_spans.first + j];
      Node& root = Level(0, 0);
      FillRoot(model, surface, patch, &root);
      Visit(root, face_->patches[patch]);
    }
  }

 private:
  struct Node : OwnedNet {
    LeafPlace place;
    int level = 0;
  };

  Node& Level(int level, int side) {
    const std::size_t index = 2 * static_cast<std::size_t>(level) + side;
    while (levels_.size() <= index) levels_.push_back(std::make_unique<Node>());
    return *levels_[index];
  }

  void FillRoot(const Model& model, const Surface& surface, std::uint32_t patch, Node* root) {
    root->SetDegrees(surface.degree_u, surface.degree_v);
    root->place = {0, patch, 0, 0};
    root->level = 0;
    BezierNet& net = root->net;
    const std::span<const Vec4> points = PatchPoints(model, surface, patch);
    std::fill_n(net.error, int{kNetComponents}, 0.0);
    for (int i = 0; i < net.points(); ++i) {
      const Vec4& p = points[static_cast<std::size_t>(i)];
      // Each component is rounded once.
      net.at(i, kX) = std::fma(-p.w, origin_.x, p.x);
      net.at(i, kY) = std::fma(-p.w, origin_.y, p.y);
      net.at(i, kQ) = std::fma(-p.w, origin_.z, p.z);
      net.at(i, kW) = p.w;
      for (const NetComponent c : {kX, kY, kQ})
        net.error[c] = std::max(net.error[c], kEpsilon * std::fabs(net.at(i, c)));
    }
    rational_ = surface.rational;
    for (const NetComponent c : {kX, kY, kW, kQ}) {
      if (c == kW && !rational_) continue;
      if (bounds_.u_low < 0 || bounds_.u_high > 1)
        Extend(&net, c, Direction::kU, -bounds_.u_low, bounds_.u_high - 1);
      if (bounds_.v_low < 0 || bounds_.v_high > 1)
        Extend(&net, c, Direction::kV, -bounds_.v_low, bounds_.v_high - 1);
    }
  }

  void Visit(Node& node, RectClass trim) {
    if (trim == RectClass::kMixed && node.level > 0) {
      trim = Classify(node.place);
      if (trim == RectClass::kOutside) return;
    }
    const Bend bend = MeasureBend(node.net);
    const double enough = kFlatness * bend.diagonal;
    const bool along_u = bend.u > enough && node.place.u_halvings < kMostHalvings;
    const bool along_v = bend.v > enough && node.place.v_halvings < kMostHalvings;
    if (!along_u && !along_v) return Keep(node, trim);
    const Direction direction = along_u && (!along_v || bend.u >= bend.v) ? Direction::kU : Direction::kV;
    Node& low = Level(node.level + 1, 0);
    Node& high = Level(node.level + 1, 1);
    for (Node* half : {&low, &high}) {
      half->SetDegrees(node.net.degree_u, node.net.degree_v);
      half->level = node.level + 1;
      half->place = Halved(node.place, direction, half == &high);
    }
    nets_.halve(node.net, direction, &low.net, &high.net);
    Visit(low, trim);
    Visit(high, trim);
  }

  // Classifies what a piece covers, with its overlap with its neighbours.
  RectClass Classify(const LeafPlace& place) const {
    const ParameterRect rect = RectOf(place, bounds_);
    constexpr double kBorder = 1 + 2 * kBorderOverlap;
    const auto u = [&](double s) {
      return u_map_->ToNative(std::clamp(rect.U(s), bounds_.u_low, bounds_.u_high));
    };
    const auto v = [&](double t) {
      return v_map_->ToNative(std::clamp(rect.V(t), bounds_.v_low, bounds_.v_high));
    };
    return face_->trim.Classify(u(-kBorder), u(kBorder), v(-kBorder), v(kBorder));
  }

  void Keep(const Node& node, RectClass trim) {
    SpacePiece piece;
    piece.face = face_index_;
    piece.place = node.place;
    piece.whole = trim == RectClass::kInside;
    const std::size_t count = std::size_t{kNetComponents} * node.net.points();
    double* const net = arena_->Allocate(count);
    std::copy_n(node.net.value, count, net);
    piece.net = net;
    std::copy_n(node.net.error, int{kNetComponents}, piece.error);
    if (!rational_) piece.error[kW] = 0;  // w is 1, and halving 1 does not round
    piece.box = BoxOf(node.net);
    pieces_->push_back(piece);
  }

  // The weights vary little over a piece, so the errors of all control points are alike.
  Box3 BoxOf(const BezierNet& net) const {
    Box3 box;
    double weight = INFINITY, size = 0;
    for (int k = 0; k <= net.degree_u; ++k) {
      for (int l = 0; l <= net.degree_v; ++l) {
        const Vec3 p = Cartesian(net, k, l);
        box.Add(p);
        weight = std::min(weight, net.at(k * net.stride() + l, kW));
        size = std::max({size, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
      }
    }
    const double of_weight = rational_ ? net.error[kW] : 0;
    const double error = weight > of_weight
                             ? (std::max({net.error[kX], net.error[kY], net.error[kQ]}) + size * of_weight) /
                                   (weight - of_weight)
                             : INFINITY;
    // Adding the origin rounds, and so does the division. Roots may lie in the overlap with the neighbours.
    const double far = std::max({std::fabs(origin_.x), std::fabs(origin_.y), std::fabs(origin_.z)});
    const double margin = error + 4 * kEpsilon * (size + far) + 4 * kBorderOverlap * box.diagonal();
    const Vec3 slack{margin, margin, margin};
    return {box.low + origin_ - slack, box.high + origin_ + slack};
  }

  const Scene::Data& scene_;
  const NetOperations& nets_;
  const FaceData* face_ = nullptr;
  std::uint32_t face_index_ = 0;
  Vec3 origin_;
  PatchBounds bounds_;
  const SpanParameter *u_map_ = nullptr, *v_map_ = nullptr;
  bool rational_ = false;
  std::vector<SpacePiece>* pieces_ = nullptr;
  CoefficientArena* arena_ = nullptr;
  std::vector<std::unique_ptr<Node>> levels_;
};

Result<SpacePieces> SpacePieces::Make(const Scene& scene, const std::vector<bool>& wanted,
                                      std::uint64_t max_bytes, const Execution& execution) {
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels) return kernels.error();
  const Scene::Data& data = scene.data();
  const std::size_t faces = data.faces.size();
  SpacePieces made;
  made.origins_.resize(faces);
  made.ranges_.resize(faces);

  // Divide the faces in parallel; a thread keeps the nets of the faces that it divides.
  struct Worker {
    explicit Worker(const Scene::Data& scene, const NetOperations& nets) : divider(scene, nets) {}
    Divider divider;
    CoefficientArena arena;
  };
  PerThread<Worker> workers([&] { return Worker(data, *kernels.value().nets); });
  std::vector<std::vector<SpacePiece>> pieces(faces);
  std::atomic<std::uint64_t> used{0};
  const auto stopped = [&] {
    return execution.cancelled() || used.load(std::memory_order_relaxed) > max_bytes;
  };
  RunWithThreads(execution.threads, [&] {
    ParallelFor(std::size_t{0}, faces, [&](std::size_t face) {
      if (!wanted[face] || stopped()) return;
      Worker& worker = workers.local();
      made.origins_[face] = data.faces[face].bounds.center();
      worker.divider.Divide(static_cast<std::uint32_t>(face), made.origins_[face], &pieces[face],
                            &worker.arena);
      const Surface& surface = scene.model().surfaces[scene.model().faces[face].surface];
      const std::size_t net_bytes = kNetComponents * sizeof(double) * surface.PointsPerPatch();
      used += pieces[face].size() * (sizeof(SpacePiece) + net_bytes);
    });
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "stopped while dividing the surfaces"};
  if (stopped())
    return Error{ErrorCode::kLimitExceeded, "the pieces of the surfaces need more than the memory limit of " +
                                                std::to_string(max_bytes >> 20) + " MiB"};

  // Put them together in the order of the faces.
  for (std::size_t face = 0; face < faces; ++face) {
    made.ranges_[face] = {static_cast<std::uint32_t>(made.pieces_.size()),
                          static_cast<std::uint32_t>(pieces[face].size())};
    made.pieces_.insert(made.pieces_.end(), pieces[face].begin(), pieces[face].end());
  }
  for (Worker& worker : workers) made.arenas_.push_back(std::move(worker.arena));
  return made;
}

std::size_t SpacePieces::bytes() const {
  std::size_t sum = pieces_.capacity() * sizeof(SpacePiece) + ranges_.capacity() * sizeof(Range) +
                    origins_.capacity() * sizeof(Vec3);
  for (const CoefficientArena& arena : arenas_) sum += arena.bytes();
  return sum;
}

}  // namespace facetless
