#include "render/trace/section_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <queue>

#include "render/kernels/dispatch.h"
#include "render/model/walk.h"
#include "render/nurbs/net_operations.h"

namespace facetless {
namespace {

// The meaning of the components of a net in this file, each multiplied by the weight: height above the plane,
// position along the axis of the scan, and position along its rays.
constexpr NetComponent kHeight = kX, kAxis = kY, kWeight = kW, kAlong = kQ;
// The rounding of the height of a placed control point: three products and three sums, twice.
constexpr double kHeightRounding = 16 * std::numeric_limits<double>::epsilon();
// A monotone piece is not divided further if the slab covers less than this share of its parameter range.
constexpr double kNarrow = 0.125;
// The largest ratio by which the derivative along the monotone parameter may vary within one piece.
constexpr double kSteady = 8;

// A piece smaller than this share of the cut's extent is not divided only because it is larger than its arc.
constexpr double kTiny = 0x1p-21;

// A piece that the work limit leaves undivided counts as touching the plane if its height range is within
// this factor of the finest one.
constexpr double kNearlyFinest = 16;

// A net that is being divided, with its part of the face's parameters.
struct Cell {
  OwnedNet net;
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  std::uint32_t source = 0;
  double area = 0;  // upper bound of the area that its part in the slab covers
  double key = 0;   // priority: the cell with the largest key is divided first
};

// The patch to which cells belong.
struct Source {
  const FaceData* data;
  const SpanParameter* u_map;
  const SpanParameter* v_map;
  std::uint32_t face, placed_face;
  bool mixed;   // some of the patch lies outside the face
  bool counts;  // the face belongs to a closed solid, and is not left out
};

struct Interval {
  double low = INFINITY, high = -INFINITY;
  void Add(double value) { low = std::min(low, value), high = std::max(high, value); }
  double width() const { return high - low; }
};

// Bounds over one cell.
struct CellBounds {
  Interval height, axis, along, weight;
  bool above = true, below = true;  // the whole cell lies above, or below, the slab
  Interval rise[2];  // of height − level·weight along u and v, over all levels of the slab, rounding included
  double speed[2] = {0, 0};  // of the projection along u and v
  double tilt[2] = {0, 0};   // variation of the height along u and v
};

CellBounds Measure(const BezierNet& net, double low, double high) {
  CellBounds bounds;
  const double error = net.error[kHeight] + net.error[kWeight] * std::max(std::fabs(low), std::fabs(high));
  for (int i = 0; i < net.points(); ++i) {
    const double w = net.at(i, kWeight), h = net.at(i, kHeight);
    bounds.above = bounds.above && h - high * w > error;
    bounds.below = bounds.below && h - low * w < -error;
    bounds.weight.Add(w);
    bounds.height.Add(h / w);
    bounds.axis.Add(net.at(i, kAxis) / w);
    bounds.along.Add(net.at(i, kAlong) / w);
  }
  const double ratio = bounds.weight.high / bounds.weight.low;
  for (int direction = 0; direction < 2; ++direction) {
    const int degree = direction == 0 ? net.degree_u : net.degree_v;
    const int step = direction == 0 ? net.stride() : 1;
    double longest = 0;
    for (int k = 0; k <= net.degree_u; ++k) {
      for (int l = 0; l <= net.degree_v; ++l) {
        if ((direction == 0 ? k : l) == degree) continue;
        const int i = k * net.stride() + l, j = i + step;
        const double dh = net.at(j, kHeight) - net.at(i, kHeight), wi = net.at(i, kWeight),
                     wj = net.at(j, kWeight);
        bounds.rise[direction].Add(degree * (dh - low * (wj - wi)));
        bounds.rise[direction].Add(degree * (dh - high * (wj - wi)));
        bounds.tilt[direction] =
            std::max(bounds.tilt[direction], std::fabs(net.at(j, kHeight) / wj - net.at(i, kHeight) / wi));
        const double da = net.at(j, kAxis) / wj - net.at(i, kAxis) / wi,
                     ds = net.at(j, kAlong) / wj - net.at(i, kAlong) / wi;
        longest = std::max(longest, da * da + ds * ds);
      }
    }
    bounds.rise[direction].low -= 2 * degree * error;
    bounds.rise[direction].high += 2 * degree * error;
    bounds.speed[direction] = degree * ratio * std::sqrt(longest);
  }
  return bounds;
}

// The least and the largest magnitude of a derivative that keeps its sign. The least is 0 if it may change
// its sign.
std::pair<double, double> DerivativeMagnitudes(const Interval& rise) {
  if (rise.low > 0) return {rise.low, rise.high};
  if (rise.high < 0) return {-rise.high, -rise.low};
  return {0, std::max(-rise.low, rise.high)};
}

class Subdivision {
 public:
  Subdivision(const Scene::Data& scene, const SectionScan& scan, const SectionSolids& solids, double low,
              double high, double finest, std::size_t most_pieces, std::span<const std::uint32_t> leave_out)
      : scene_(scene),
        model_(*scene.model),
        scan_(scan),
        solids_(solids),
        low_(low),
        high_(high),
        finest_(finest),
        tiny_(kTiny * (scan.end - scan.begin)),
        most_pieces_(most_pieces),
        leave_out_(leave_out),
        nets_(*ActiveKernels().value().nets),
        gaps_(model_.faces.size(), 0) {}

  SlabContact Run() {
    for (std::size_t f = 0; f < model_.faces.size(); ++f) gaps_[f] = LargestGap(model_, model_.faces[f]);
    for (const Instance& instance : model_.instances)
      for (const PlacedFace face : WalkPlacedFaces(model_, instance)) Add(instance, face);
    // Divide the largest cell first, which is the best use of the limited work.
    for (std::size_t count = 0; !open_.empty(); ++count) {
      std::pop_heap(open_.begin(), open_.end(), Later);
      std::unique_ptr<Cell> cell = std::move(open_.back());
      open_.pop_back();
      if (count < most_pieces_) {
        Divide(std::move(cell));
      } else {
        meeting_.complete = false;
        const CellBounds bounds = Measure(cell->net.net, low_, high_);
        if (bounds.height.width() <= kNearlyFinest * finest_ && Wide(bounds) >= kTangentAspect * finest_)
          meeting_.touching_faces.push_back(sources_[cell->source].placed_face);
        Finish(*cell, bounds, bounds.speed[0] + bounds.speed[1]);
      }
    }
    std::sort(meeting_.touching_faces.begin(), meeting_.touching_faces.end());
    meeting_.touching_faces.erase(std::unique(meeting_.touching_faces.begin(), meeting_.touching_faces.end()),
                                  meeting_.touching_faces.end());
    return std::move(meeting_);
  }

 private:
  static bool Later(const std::unique_ptr<Cell>& a, const std::unique_ptr<Cell>& b) {
    return a->key < b->key;
  }

  void Add(const Instance& instance, PlacedFace face) {
    const FaceData& data = scene_.faces[face.face];
    if (data.bounds.empty() || !BoxMeets(data.bounds, instance.placement)) return;
    const Surface& surface = model_.surfaces[model_.faces[face.face].surface];
    if (std::binary_search(leave_out_.begin(), leave_out_.end(), face.id)) return;
    for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
      if (data.patches[patch] == RectClass::kOutside) continue;
      auto cell = std::make_unique<Cell>();
      cell->net.SetDegrees(surface.degree_u, surface.degree_v);
      BezierNet& net = cell->net.net;
      const Vec4* points = PatchPoints(model_, surface, patch).data();
      std::fill_n(net.error, int{kNetComponents}, 0.0);
      for (int i = 0; i < net.points(); ++i) {
        const Vec4 p = points[i];
        const Vec3 placed = instance.placement.Point({p.x / p.w, p.y / p.w, p.z / p.w}) - scan_.origin;
        net.at(i, kHeight) = p.w * Dot(scan_.plane.normal, placed);
        net.at(i, kAxis) = p.w * Dot(scan_.axis, placed);
        net.at(i, kAlong) = p.w * Dot(scan_.along, placed);
        net.at(i, kWeight) = p.w;
        net.error[kHeight] =
            std::max(net.error[kHeight], kHeightRounding * p.w * (Length(placed) + Length(scan_.origin)));
      }
      const CellBounds bounds = Measure(net, low_, high_);
      if (bounds.above || bounds.below) continue;
      const std::uint32_t i = patch / surface.v_spans.count, j = patch % surface.v_spans.count;
      sources_.push_back({&data, &scene_.spans[surface.u_spans.first + i],
                          &scene_.spans[surface.v_spans.first + j], face.face, face.id,
                          data.patches[patch] == RectClass::kMixed,
                          solids_.ClosedSolidOfFace(face.id) != kNoIndex});
      cell->source = static_cast<std::uint32_t>(sources_.size() - 1);
      Push(std::move(cell), bounds);
    }
  }

  bool BoxMeets(const Box3& box, const Placement& placement) const {
    Interval heights;
    double size = 0;
    for (int i = 0; i < 8; ++i) {
      const Vec3 p = placement.Point({i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                                      i & 4 ? box.high.z : box.low.z}) -
                     scan_.origin;
      heights.Add(Dot(scan_.plane.normal, p));
      size = std::max(size, Length(p) + Length(scan_.origin));
    }
    const double error = kHeightRounding * size;
    return heights.low <= high_ + error && heights.high >= low_ - error;
  }

  // An upper bound of the area of the whole cell's projection.
  static double BoxArea(const CellBounds& bounds) {
    return std::min(bounds.axis.width() * bounds.along.width(), bounds.speed[0] * bounds.speed[1]);
  }

  // A sliver along the cut is long, and as flat as it is narrow. Only a piece that is wide in both directions
  // touches the plane.
  static double Wide(const CellBounds& bounds) { return std::min(bounds.speed[0], bounds.speed[1]); }

  void Push(std::unique_ptr<Cell> cell, const CellBounds& bounds) {
    cell->area = BoxArea(bounds);
    cell->key = bounds.axis.width() * bounds.along.width();
    open_.push_back(std::move(cell));
    std::push_heap(open_.begin(), open_.end(), Later);
  }

  void Finish(const Cell& cell, const CellBounds& bounds, double outline) {
    const Source& source = sources_[cell.source];
    if (!source.counts) return;
    meeting_.area_mm2 += cell.area;
    meeting_.outline_mm += outline;
    meeting_.gap_mm2 += outline * gaps_[source.face];
    meeting_.pieces.push_back(
        {bounds.axis.low, bounds.axis.high, bounds.along.low, bounds.along.high, source.placed_face});
  }

  void Divide(std::unique_ptr<Cell> cell) {
    const BezierNet& net = cell->net.net;
    const CellBounds bounds = Measure(net, low_, high_);
    const Source& source = sources_[cell->source];
    if (source.mixed &&
        source.data->trim.Classify(source.u_map->ToNative(cell->u_low), source.u_map->ToNative(cell->u_high),
                                   source.v_map->ToNative(cell->v_low),
                                   source.v_map->ToNative(cell->v_high)) == RectClass::kOutside)
      return;

    // A cell entirely within the slab counts completely.
    if (bounds.height.low >= low_ && bounds.height.high <= high_ && high_ - low_ > finest_) {
      Finish(*cell, bounds, bounds.speed[0] + bounds.speed[1]);
      return;
    }
    // If the cut is a single arc, the derivative along the steeper parameter bounds the share that the slab
    // covers.
    int best = -1;
    double share = 1;
    for (int direction = 0; direction < 2; ++direction) {
      const auto [least, most] = DerivativeMagnitudes(bounds.rise[direction]);
      if (!(least > 0) || !(most <= kSteady * least)) continue;
      const double taken = std::min(1.0, (high_ - low_) * bounds.weight.high / least);
      if (best < 0 || taken < share ||
          (taken == share && least > DerivativeMagnitudes(bounds.rise[best]).first)) {
        best = direction;
        share = taken;
      }
    }
    const bool tiny = std::max(bounds.speed[0], bounds.speed[1]) <= tiny_;
    if (best >= 0 && share <= kNarrow) {
      // If the arc does not run from end to end, the piece may be much larger than the arc.
      if (tiny || Crosses(net, best)) {
        cell->area = std::min(cell->area, bounds.speed[0] * bounds.speed[1] * share);
        const double slope = DerivativeMagnitudes(bounds.rise[1 - best]).second /
                             DerivativeMagnitudes(bounds.rise[best]).first;
        Finish(*cell, bounds, bounds.speed[1 - best] + bounds.speed[best] * std::min(1.0, slope));
        return;
      }
      Halve(*cell, bounds.speed[0] >= bounds.speed[1] ? Direction::kU : Direction::kV);
      return;
    }
    if (bounds.height.width() <= finest_ || cell->u_high - cell->u_low < 0x1p-48 ||
        cell->v_high - cell->v_low < 0x1p-48) {
      if (Wide(bounds) >= kTangentAspect * finest_) meeting_.touching_faces.push_back(source.placed_face);
      Finish(*cell, bounds, bounds.speed[0] + bounds.speed[1]);
      return;
    }
    Halve(*cell,
          bounds.tilt[0] * net.degree_u >= bounds.tilt[1] * net.degree_v ? Direction::kU : Direction::kV);
  }

  // Returns whether the height, which is monotone along `direction`, passes from one side of the slab to the
  // other on every line of that direction, or ends within the slab, as it does if the cut runs along a border
  // of patches.
  bool Crosses(const BezierNet& net, int direction) const {
    bool rising = true, falling = true;
    const int count = direction == 0 ? net.degree_v : net.degree_u;
    for (int k = 0; k <= count; ++k) {
      const int first = direction == 0 ? k : k * net.stride();
      const int last = direction == 0 ? net.degree_u * net.stride() + k : first + net.degree_v;
      // Heights that differ by less than finest_ cannot be distinguished.
      const auto over = [&](int i, double level, double sign) {
        const double w = net.at(i, kWeight);
        return sign * (net.at(i, kHeight) - level * w) <= net.error[kHeight] + finest_ * w;
      };
      rising = rising && over(first, high_, 1) && over(last, low_, -1);
      falling = falling && over(first, low_, -1) && over(last, high_, 1);
    }
    return rising || falling;
  }

  void Halve(const Cell& cell, Direction direction) {
    const BezierNet& net = cell.net.net;
    for (int half = 0; half < 2; ++half) halves_[half].SetDegrees(net.degree_u, net.degree_v);
    nets_.halve(net, direction, &halves_[0].net, &halves_[1].net);
    const double u = 0.5 * (cell.u_low + cell.u_high), v = 0.5 * (cell.v_low + cell.v_high);
    for (int half = 0; half < 2; ++half) {
      const CellBounds part = Measure(halves_[half].net, low_, high_);
      if (part.above || part.below) continue;
      auto next = std::make_unique<Cell>();
      next->net.SetDegrees(net.degree_u, net.degree_v);
      std::copy_n(halves_[half].net.value, kNetComponents * net.points(), next->net.net.value);
      std::copy_n(halves_[half].net.error, int{kNetComponents}, next->net.net.error);
      next->source = cell.source;
      next->u_low = cell.u_low;
      next->u_high = cell.u_high;
      next->v_low = cell.v_low;
      next->v_high = cell.v_high;
      if (direction == Direction::kU) (half == 0 ? next->u_high : next->u_low) = u;
      if (direction == Direction::kV) (half == 0 ? next->v_high : next->v_low) = v;
      Push(std::move(next), part);
    }
  }

  const Scene::Data& scene_;
  const Model& model_;
  const SectionScan& scan_;
  const SectionSolids& solids_;
  const double low_, high_, finest_, tiny_;
  const std::size_t most_pieces_;
  const std::span<const std::uint32_t> leave_out_;
  const NetOperations& nets_;
  std::vector<double> gaps_;  // largest gap of each face's edges, mm
  std::vector<Source> sources_;
  std::vector<std::unique_ptr<Cell>> open_;  // a heap
  OwnedNet halves_[2];
  SlabContact meeting_;
};

}  // namespace

SlabContact ExamineSlab(const Scene::Data& scene, const SectionScan& scan, const SectionSolids& solids,
                        double low, double high, double finest, std::size_t most_pieces,
                        std::span<const std::uint32_t> leave_out) {
  return Subdivision(scene, scan, solids, low, high, finest, most_pieces, leave_out).Run();
}

std::vector<SlabComponent> ThinComponents(std::span<const SlabPiece> pieces, double width, double margin) {
  // Sweep along the axis, and merge pieces whose boxes overlap.
  std::vector<std::uint32_t> order(pieces.size()), parent(pieces.size()), active;
  std::iota(order.begin(), order.end(), 0u);
  std::iota(parent.begin(), parent.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair{pieces[a].axis_low, a} < std::pair{pieces[b].axis_low, b};
  });
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const std::uint32_t i : order) {
    const SlabPiece& piece = pieces[i];
    std::erase_if(active, [&](std::uint32_t j) { return pieces[j].axis_high + margin < piece.axis_low; });
    for (const std::uint32_t j : active) {
      if (pieces[j].along_low <= piece.along_high + margin &&
          piece.along_low <= pieces[j].along_high + margin)
        parent[root(i)] = root(j);
    }
    active.push_back(i);
  }
  std::vector<Interval> axis(pieces.size()), along(pieces.size());
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    const std::uint32_t r = root(i);
    axis[r].Add(pieces[i].axis_low), axis[r].Add(pieces[i].axis_high);
    along[r].Add(pieces[i].along_low), along[r].Add(pieces[i].along_high);
  }
  std::vector<SlabComponent> thin;
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    if (parent[i] == i && axis[i].width() < width)
      thin.push_back({axis[i].low, axis[i].high, axis[i].width() * along[i].width()});
  }
  return thin;
}

}  // namespace facetless
