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

// A piece that bends by more than kMostBend of its diagonal is halved, so that most rays have a certificate. A piece
// that bends by less than kLeastBend is flat enough.
constexpr double kMostBend = 1.0 / 6, kLeastBend = 1.0 / 512;
// A piece that bends by more than this share of the sum of two opposite sides is halved, so that cones are narrow.
constexpr double kMostTurn = 1.0 / 20;
// The largest numbers of halvings of one patch in one direction, for the bend and for the trim line.
constexpr int kMostHalvings = 6, kMostTrimHalvings = 12;

constexpr double kEpsilon = 0x1p-53;

Vec3 Cartesian(const BezierNet& net, int k, int l) {
  const int i = k * net.stride() + l;
  const double w = net.at(i, kW);
  return {net.at(i, kX) / w, net.at(i, kY) / w, net.at(i, kQ) / w};
}

// The distance of the control points from the parallelogram of the corners, in two parts: the part that halving along u
// reduces (lines along u that are bent or unevenly spaced), and the part that halving along v reduces.
struct Bend {
  double u = 0, v = 0;
  double diagonal = 0;
  double length_u = 0, length_v = 0;  // sums of the lengths of the two sides along u, and along v
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
  // Halving in either direction reduces the twist equally; add it to the direction with the longer sides.
  const double twist = 0.25 * Length((c11 - c10) - (c01 - c00));
  bend.length_u = Length(c10 - c00) + Length(c11 - c01);
  bend.length_v = Length(c01 - c00) + Length(c11 - c10);
  (bend.length_u >= bend.length_v ? bend.u : bend.v) += twist;
  return bend;
}

// The differences of neighbouring control points in one direction, as they act on a ray through a point q of the net:
// w·Δp + Δw·(p − q). |Δw| is at most `weight`.
class Differences {
 public:
  Differences(const BezierNet& net, Direction direction)
      : net_(net),
        step_(direction == Direction::kU ? net.stride() : 1),
        last_k_(net.degree_u - (direction == Direction::kU ? 1 : 0)),
        last_l_(net.degree_v - (direction == Direction::kV ? 1 : 0)) {
    Box3 box;
    ForEach([&](int i) {
      box.Add(At(i));
      weight = std::max(weight, std::fabs(net_.at(i + step_, kW) - net_.at(i, kW)));
    });
    center = box.center();
  }

  // Measures how far the first terms are from their centre along a normal, and across it.
  void Measure(Vec3 normal) {
    ForEach([&](int i) {
      const Vec3 off = At(i) - center;
      const double up = Dot(off, normal);
      along = std::max(along, std::fabs(up));
      across = std::max(across, Length(off - up * normal));
    });
  }

  Vec3 center;
  double weight = 0, along = 0, across = 0;

 private:
  Vec3 At(int i) const {
    const double ratio = net_.at(i + step_, kW) / net_.at(i, kW);
    return {net_.at(i + step_, kX) - ratio * net_.at(i, kX), net_.at(i + step_, kY) - ratio * net_.at(i, kY),
            net_.at(i + step_, kQ) - ratio * net_.at(i, kQ)};
  }
  template <typename Do>
  void ForEach(const Do& act) const {
    for (int k = 0; k <= last_k_; ++k)
      for (int l = 0; l <= last_l_; ++l) act(k * net_.stride() + l);
  }

  const BezierNet& net_;
  const int step_, last_k_, last_l_;
};

// Returns a bound of the distance of two control points of a net, measured perpendicular to a direction.
double WidthAcross(const BezierNet& net, Vec3 direction) {
  const Vec3 along = Normalized(direction), first = Cartesian(net, 0, 0);
  double most = 0;
  for (int k = 0; k <= net.degree_u; ++k)
    for (int l = 0; l <= net.degree_v; ++l)
      most = std::max(most, Length(Cross(Cartesian(net, k, l) - first, along)));
  return 2 * most;
}

// The largest distance of two control points along a unit vector.
double Thickness(const BezierNet& net, Vec3 along) {
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k <= net.degree_u; ++k) {
    for (int l = 0; l <= net.degree_v; ++l) {
      const double at = Dot(Cartesian(net, k, l), along);
      low = std::min(low, at);
      high = std::max(high, at);
    }
  }
  return high - low;
}

}  // namespace

// Divides the patches of faces into pieces. Each thread has a Divider of its own.
class SpacePieces::Divider {
 public:
  Divider(const Scene::Data& scene, const NetOperations& nets, double open_share)
      : scene_(scene),
        nets_(nets),
        open_area_(open_share * scene.model->Diagonal() * scene.model->Diagonal()) {}

  // Appends the pieces of a face.
  void Divide(std::uint32_t face, Vec3 origin, std::vector<SpacePiece>* pieces, CoefficientArena* arena) {
    const Model& model = *scene_.model;
    const Surface& surface = model.surfaces[model.faces[face].surface];
    face_ = &scene_.faces[face];
    face_index_ = face;
    plane_ = surface.kind == SurfaceKind::kPlane;
    origin_ = origin;
    pieces_ = pieces;
    arena_ = arena;
    for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
      if (face_->patches[patch] == RectClass::kOutside) continue;
      const std::uint32_t i = patch / surface.v_spans.count, j = patch % surface.v_spans.count;
      bounds_ = SetBoxBounds(*face_, surface, i, j);
      const Span &u = model.spans[surface.u_spans.first + i], &v = model.spans[surface.v_spans.first + j];
      patch_low_ = {u.begin, v.begin};
      patch_high_ = {u.end, v.end};
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
    TrimLine line = TrimLine::Whole();
    if (trim == RectClass::kMixed) {
      line = FindLine(node.place);
      const bool decided = line.w == 0;
      if (decided && line.c < 0) return;
      if (decided) trim = RectClass::kInside;
    }
    const Bend bend = MeasureBend(node.net);
    const double area = bend.diagonal * bend.diagonal;
    // The bend that is allowed, in mm.
    const double enough = std::clamp(open_area_ / area, kLeastBend, kMostBend) * bend.diagonal;
    const double turn_u = kMostTurn * bend.length_u, turn_v = kMostTurn * bend.length_v;
    const bool along_u = bend.u > std::min(enough, turn_u) && node.place.u_halvings < kMostHalvings;
    const bool along_v = bend.v > std::min(enough, turn_v) && node.place.v_halvings < kMostHalvings;
    Direction direction = along_u && (!along_v || bend.u >= bend.v) ? Direction::kU : Direction::kV;
    if (!along_u && !along_v) {
      const bool may_u = node.place.u_halvings < kMostTrimHalvings,
                 may_v = node.place.v_halvings < kMostTrimHalvings;
      if (std::min(line.w, 1.0) * area <= open_area_ || (!may_u && !may_v)) return Keep(node, trim, line);
      direction = may_u && (!may_v || bend.length_u >= bend.length_v) ? Direction::kU : Direction::kV;
    }
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

  // What the trimming leaves of what a piece covers, with its overlap with its neighbours.
  TrimLine FindLine(const LeafPlace& place) const {
    const ParameterRect rect = RectOf(place, bounds_);
    constexpr double kBorder = 1 + 2 * kBorderOverlap;
    const auto u = [&](double s) {
      return u_map_->ToNative(std::clamp(rect.U(s), bounds_.u_low, bounds_.u_high));
    };
    const auto v = [&](double t) {
      return v_map_->ToNative(std::clamp(rect.V(t), bounds_.v_low, bounds_.v_high));
    };
    TrimLine line = face_->trim.FindLine(u(-kBorder), u(kBorder), v(-kBorder), v(kBorder), kSteepBand);
    // The line's coordinates are those of the piece but for the overlap.
    if (line.a != 0 || line.b != 0) line.w += 4 * kBorderOverlap * (std::fabs(line.a) + std::fabs(line.b));
    return line;
  }

  void Keep(const Node& node, RectClass trim, const TrimLine& line) {
    SpacePiece piece;
    piece.face = face_index_;
    piece.place = node.place;
    piece.whole = trim == RectClass::kInside;
    piece.line = line;
    const std::size_t count = std::size_t{kNetComponents} * node.net.points();
    double* const net = arena_->Allocate(count);
    std::copy_n(node.net.value, count, net);
    piece.net = net;
    std::copy_n(node.net.error, int{kNetComponents}, piece.error);
    if (!rational_) piece.error[kW] = 0;  // w is 1, and halving 1 does not round
    piece.box = BoxOf(node.net);
    const ParameterRect rect = RectOf(node.place, bounds_);
    piece.u_low = u_map_->ToNative(rect.U(-1));
    piece.u_high = u_map_->ToNative(rect.U(1));
    piece.v_low = v_map_->ToNative(rect.V(-1));
    piece.v_high = v_map_->ToNative(rect.V(1));
    piece.patch_low = patch_low_;
    piece.patch_high = patch_high_;
    if (!plane_) {
      piece.close = FindCone(node.net, kCloseShare);
      piece.wide = FindCone(node.net, kWideShare);
    }
    pieces_->push_back(piece);
  }

  // Finds the cone of a neighbourhood (law 5).
  SpacePiece::Cone FindCone(const BezierNet& own, double share) {
    // Native parameters may be angles, of at most a quarter turn in a patch. Their rate relative to the patch's own
    // parameter then varies by a factor of at most 1.18.
    const double more = 1.25 * share;
    wide_.SetDegrees(own.degree_u, own.degree_v);
    BezierNet& net = wide_.net;
    std::copy_n(own.value, std::size_t{kNetComponents} * own.points(), net.value);
    for (const NetComponent c : {kX, kY, kW, kQ}) {
      if (c == kW && !rational_) continue;
      Extend(&net, c, Direction::kU, more, more);
      Extend(&net, c, Direction::kV, more, more);
    }
    Box3 box;
    for (int k = 0; k <= net.degree_u; ++k) {
      for (int l = 0; l <= net.degree_v; ++l) {
        if (!(net.at(k * net.stride() + l, kW) > 0)) return {};
        box.Add(Cartesian(net, k, l));
      }
    }
    Differences a(net, Direction::kU), b(net, Direction::kV);
    const Vec3 product = Cross(a.center, b.center), normal = Normalized(product);
    a.Measure(normal);
    b.Measure(normal);
    // The cross product of two tangents has a part along `normal`, at least `least`, and one across it, at most `tilt`.
    // What the weights add to one factor along the other's centre drops out.
    const double size_a = Length(a.center), size_b = Length(b.center);
    double least = Length(product) - size_a * b.across - size_b * a.across - a.across * b.across;
    double plane_a = size_a + a.across, plane_b = size_b + b.across;
    double up_a = a.along, up_b = b.along;
    if (rational_) {
      const double diagonal = box.diagonal(), thickness = Thickness(net, normal);
      least -=
          size_a * b.weight * WidthAcross(net, a.center) + size_b * a.weight * WidthAcross(net, b.center) +
          diagonal * (a.across * b.weight + b.across * a.weight) + a.weight * b.weight * diagonal * diagonal;
      plane_a += a.weight * diagonal;
      plane_b += b.weight * diagonal;
      up_a += a.weight * thickness;
      up_b += b.weight * thickness;
    }
    const double tilt = plane_a * up_b + plane_b * up_a;
    if (!(tilt < least)) return {};
    return {normal, tilt / least + 0x1p-20};  // the rounding of all this is far smaller
  }

  // Returns the box of the control points with their errors. One error, for the smallest weight, serves all of them.
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
    // Add a margin for the rounding of the division and of the sum with the origin, and for roots in the overlap with
    // the neighbours.
    const double far = std::max({std::fabs(origin_.x), std::fabs(origin_.y), std::fabs(origin_.z)});
    const double margin = error + 4 * kEpsilon * (size + far) + 4 * kBorderOverlap * box.diagonal();
    const Vec3 slack{margin, margin, margin};
    return {box.low + origin_ - slack, box.high + origin_ + slack};
  }

  const Scene::Data& scene_;
  const NetOperations& nets_;
  const double open_area_;  // kOpenShare, as an area
  const FaceData* face_ = nullptr;
  std::uint32_t face_index_ = 0;
  Vec3 origin_;
  PatchBounds bounds_;
  const SpanParameter *u_map_ = nullptr, *v_map_ = nullptr;
  Vec2 patch_low_, patch_high_;
  bool rational_ = false, plane_ = false;
  OwnedNet wide_;  // the net of a neighbourhood
  std::vector<SpacePiece>* pieces_ = nullptr;
  CoefficientArena* arena_ = nullptr;
  std::vector<std::unique_ptr<Node>> levels_;
};

Result<SpacePieces> SpacePieces::Make(const Scene& scene, const std::vector<bool>& wanted, double open_share,
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
    Worker(const Scene::Data& scene, const NetOperations& nets, double open_share)
        : divider(scene, nets, open_share) {}
    Divider divider;
    CoefficientArena arena;
  };
  PerThread<Worker> workers([&] { return Worker(data, *kernels.value().nets, open_share); });
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
