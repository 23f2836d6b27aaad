#include "render/nurbs/trim_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "render/model/walk.h"

namespace facetless {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The tree has at most 32 levels for 2^32 pieces, because nodes are split by halving, and at most seven
// siblings wait on the stack at each level.
constexpr int kStackSize = 7 * 32 + 1;

// cross(chord, q − low) with a bound of its rounding error: each product has three roundings, the difference
// has one.
struct Offset {
  double value, error;
};
Offset OffsetFromChord(const TrimPiece& piece, Vec2 q) {
  const double du = piece.high.x - piece.low.x, dv = piece.high.y - piece.low.y;
  const double a = du * (q.y - piece.low.y), b = dv * (q.x - piece.low.x);
  return {a - b, 3 * kEpsilon * (std::fabs(a) + std::fabs(b))};
}

// Two lanes of the compiler's vector extension (GCC, Clang). They are only compared, so the answer does not
// depend on the instructions used.
using Lanes2 = double __attribute__((vector_size(16)));
using Bits2 = std::int64_t __attribute__((vector_size(16)));
Lanes2 Two(const double* lanes, int pair) {
  Lanes2 two;
  std::memcpy(&two, lanes + 2 * pair, sizeof two);
  return two;
}
// 1 in the lanes where the comparison holds, and 0 elsewhere.
Bits2 One(Bits2 comparison) {
  return comparison ? Bits2{1, 1} : Bits2{0, 0};
}

// A corner counts as near within this many band widths. The neighbour's band may be narrower, and bands are
// boxes, whose corners are 1.5 times as far away as their sides.
constexpr double kCornerReach = 2;

bool Spans(const TrimPiece& piece, double v) {
  return piece.low.y <= v && v < piece.high.y;
}

}  // namespace

// ---- Building
// ----------------------------------------------------------------------------------------------------

// A run of pieces of one loop, or a run of whole loops.
struct FaceTrim::Stretch {
  bool chain = true;
  std::uint32_t first = 0, end = 0;  // pieces, or positions in Builder::order
  std::uint32_t piece_count = 0;
};

struct FaceTrim::Builder {
  TrimPieces& pieces;
  std::vector<Node>& nodes;
  std::vector<std::uint32_t> order;  // loops, in spatial order
  std::vector<Vec2> center;          // of the loops' boxes

  std::uint32_t LoopPieces(std::uint32_t loop) const {
    return pieces.loop_first[loop + 1] - pieces.loop_first[loop];
  }

  Stretch Group(std::uint32_t first, std::uint32_t end) const {
    if (end - first == 1) {
      const std::uint32_t loop = order[first];
      return {true, pieces.loop_first[loop], pieces.loop_first[loop + 1], LoopPieces(loop)};
    }
    Stretch group{false, first, end, 0};
    for (std::uint32_t i = first; i < end; ++i) group.piece_count += LoopPieces(order[i]);
    return group;
  }

  // Halves a chain in its middle, and a group of loops along the longer side of the box of their centres.
  std::array<Stretch, 2> Halve(const Stretch& s) {
    const std::uint32_t middle = s.first + (s.end - s.first) / 2;
    if (s.chain)
      return {Stretch{true, s.first, middle, middle - s.first}, Stretch{true, middle, s.end, s.end - middle}};
    Vec2 low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
    for (std::uint32_t i = s.first; i < s.end; ++i) {
      const Vec2 c = center[order[i]];
      low = {std::min(low.x, c.x), std::min(low.y, c.y)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y)};
    }
    const bool by_u = high.x - low.x > high.y - low.y;
    const auto key = [&](std::uint32_t loop) { return by_u ? center[loop].x : center[loop].y; };
    std::nth_element(
        order.begin() + s.first, order.begin() + middle, order.begin() + s.end,
        [&](std::uint32_t a, std::uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
    return {Group(s.first, middle), Group(middle, s.end)};
  }

  // Adds the node over `s` after its children; returns its index.
  std::uint32_t Add(const Stretch& s) {
    std::vector<Stretch> children{s};
    while (children.size() < kWidth) {
      const auto largest =
          std::max_element(children.begin(), children.end(),
                           [](const Stretch& a, const Stretch& b) { return a.piece_count < b.piece_count; });
      if (largest->piece_count <= 1) break;
      const auto halves = Halve(*largest);
      *largest = halves[0];
      children.insert(largest + 1, halves[1]);
    }
    Node node;
    for (const Stretch& child : children) AddChild(node, child);
    for (std::uint32_t i = node.count; i < kWidth; ++i) {
      const std::uint32_t lane = ChildLane(i);
      node.u_low[lane] = node.v_low[lane] = kInfinity;
      node.u_high[lane] = node.v_high[lane] = -kInfinity;
      node.v_begin[lane] = node.v_end[lane] = 0;
      node.child[i] = 0;
    }
    nodes.push_back(node);
    return static_cast<std::uint32_t>(nodes.size() - 1);
  }

  void AddChild(Node& node, const Stretch& child) {
    const std::uint32_t i = node.count++, lane = ChildLane(i);
    if (child.piece_count == 1) {
      const TrimPiece& piece = pieces.pieces[child.first];
      const Vec2 error = pieces.curves[child.first].error;
      node.u_low[lane] = std::min(piece.low.x, piece.high.x) - error.x;
      node.u_high[lane] = std::max(piece.low.x, piece.high.x) + error.x;
      node.v_low[lane] = piece.low.y - error.y;
      node.v_high[lane] = piece.high.y + error.y;
      node.child[i] = child.first | kPieceBit;
      node.band_u = std::max(node.band_u, piece.band_u);
      node.band_v = std::max(node.band_v, piece.band_v);
    } else {
      node.child[i] = Add(child);
      const Node& below = nodes[node.child[i]];
      node.u_low[lane] = *std::min_element(below.u_low, below.u_low + kWidth);
      node.u_high[lane] = *std::max_element(below.u_high, below.u_high + kWidth);
      node.v_low[lane] = *std::min_element(below.v_low, below.v_low + kWidth);
      node.v_high[lane] = *std::max_element(below.v_high, below.v_high + kWidth);
      node.band_u = std::max(node.band_u, below.band_u);
      node.band_v = std::max(node.band_v, below.band_v);
    }
    // Whole loops end where they begin.
    node.v_begin[lane] = child.chain ? pieces.Begin(child.first).y : 0;
    node.v_end[lane] = child.chain ? pieces.End(child.end - 1).y : 0;
  }
};

FaceTrim FaceTrim::Build(const Model& model, std::uint32_t face) {
  FaceTrim trim;
  const Face& source = model.faces[face];
  const SurfaceEval surface(model, source.surface);
  trim.pieces_ = MakeTrimPieces(model, face, surface);

  // The tree.
  TrimPieces& all = trim.pieces_;
  Builder builder{all, trim.nodes_, {}, {}};
  for (std::uint32_t loop = 0; loop + 1 < all.loop_first.size(); ++loop) {
    Vec2 low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
    for (std::uint32_t i = all.loop_first[loop]; i < all.loop_first[loop + 1]; ++i) {
      const TrimPiece& p = all.pieces[i];
      low = {std::min({low.x, p.low.x, p.high.x}), std::min(low.y, p.low.y)};
      high = {std::max({high.x, p.low.x, p.high.x}), std::max(high.y, p.high.y)};
    }
    builder.center.push_back(0.5 * (low + high));
    if (builder.LoopPieces(loop) > 0) builder.order.push_back(loop);
  }
  if (!builder.order.empty()) builder.Add(builder.Group(0, static_cast<std::uint32_t>(builder.order.size())));
  trim.nodes_.shrink_to_fit();

  trim.FindNeighbours(model, source);
  trim.FindEndsAndMaterial();
  trim.FindWhole(surface);
  return trim;
}

void FaceTrim::FindNeighbours(const Model& model, const Face& face) {
  if (face.loops.count == 0) return;
  std::uint32_t low = kNoIndex, high = 0;
  for (const Loop& loop : LoopsOf(model, face)) {
    low = std::min(low, loop.coedges.first);
    high = std::max(high, loop.coedges.end());
  }
  first_coedge_ = low;
  ends_.resize(high - low);
  for (const Loop& loop : LoopsOf(model, face)) {
    // A collapsed edge is a point: its neighbours meet there.
    std::vector<std::uint32_t> around;
    for (const std::uint32_t c : Indices(loop.coedges)) {
      const Coedge& coedge = model.coedges[c];
      const std::span<const TrimSegment> segments = SegmentsOf(model, coedge);
      if (segments.empty() || (coedge.edge != kNoIndex && model.edges[coedge.edge].degenerate)) continue;
      around.push_back(c);
      ends_[c - low].begin = segments.front().edge_begin;
      ends_[c - low].end = segments.back().edge_end;
    }
    const auto askable = [&](std::uint32_t c) { return model.coedges[c].edge == kNoIndex ? kNoIndex : c; };
    for (std::size_t i = 0, n = around.size(); i < n; ++i) {
      ends_[around[i] - low].previous = askable(around[(i + n - 1) % n]);
      ends_[around[i] - low].next = askable(around[(i + 1) % n]);
    }
  }
}

// The ends of each coedge, and its material by its longest piece.
void FaceTrim::FindEndsAndMaterial() {
  std::vector<std::uint32_t> longest(ends_.size(), kNoIndex);
  const auto length = [&](std::uint32_t i) {
    const TrimPiece& p = pieces_.pieces[i];
    return std::fabs(p.high.x - p.low.x) + (p.high.y - p.low.y);
  };
  for (std::uint32_t i = 0; i < pieces_.pieces.size(); ++i) {
    const std::uint32_t coedge = pieces_.pieces[i].coedge;
    if (coedge == kNoIndex) continue;
    // Pieces come in loop order.
    Ends& ends = ends_[coedge - first_coedge_];
    if (longest[coedge - first_coedge_] == kNoIndex) ends.begin_point = pieces_.Begin(i);
    ends.end_point = pieces_.End(i);
    std::uint32_t& best = longest[coedge - first_coedge_];
    if (best == kNoIndex || length(i) > length(best)) best = i;
  }
  for (std::size_t c = 0; c < ends_.size(); ++c)
    if (longest[c] != kNoIndex) ends_[c].material_left = MaterialLeft(longest[c]);
}

bool FaceTrim::MaterialLeft(std::uint32_t i) const {
  const TrimPiece& piece = pieces_.pieces[i];
  const MonotonePiece curve = pieces_.Monotone(i);
  Vec2 middle = PointOn(curve.curve, 0.5 * (curve.t_low + curve.t_high));
  // Of a piece that rises by a rounding or two the middle may round to the upper end, where its neighbour
  // counts already.
  if (!Spans(piece, middle.y)) middle.y = piece.low.y;
  const bool odd = OddExcept(middle, i);
  // Without this piece the count is that of its right side; on a horizontal one, by the half-open rule, that
  // of the upper side, which is on the left of a piece that runs towards +u.
  const bool upwards_left = piece.low.y < piece.high.y ? !odd : odd;
  return upwards_left == piece.forward;
}

void FaceTrim::FindWhole(const SurfaceEval& surface) {
  const double u0 = surface.u_begin(), u1 = surface.u_end(), v0 = surface.v_begin(), v1 = surface.v_end();
  // The border of the grid and that of the loops may differ by the band, or by a rounding of the knots.
  const double knot_u = 4 * kEpsilon * std::max(std::fabs(u0), std::fabs(u1));
  const double knot_v = 4 * kEpsilon * std::max(std::fabs(v0), std::fabs(v1));
  for (const TrimPiece& p : pieces_.pieces) {
    if (p.slit) continue;
    const double reach_u = std::max<double>(p.band_u, knot_u), reach_v = std::max<double>(p.band_v, knot_v);
    const double low = std::min(p.low.x, p.high.x), high = std::max(p.low.x, p.high.x);
    if (!(high <= u0 + reach_u || low >= u1 - reach_u || p.high.y <= v0 + reach_v || p.low.y >= v1 - reach_v))
      return;
  }
  whole_ = OddExcept({0.5 * (u0 + u1), 0.5 * (v0 + v1)}, kNoIndex);
}

std::size_t FaceTrim::bytes() const {
  return sizeof(*this) + nodes_.capacity() * sizeof(Node) + ends_.capacity() * sizeof(Ends) +
         pieces_.pieces.capacity() * sizeof(TrimPiece) + pieces_.curves.capacity() * sizeof(TrimPieceCurve) +
         pieces_.points.capacity() * sizeof(Vec3) + pieces_.loop_first.capacity() * sizeof(std::uint32_t);
}

// ---- Queries
// -----------------------------------------------------------------------------------------------------

// Counts the crossings of the half-line from `point` towards +u with all stretches whose box, grown by the
// bands below its node, is clear of `rect`, and hands each piece that isn't clear to open_piece(piece, odd),
// which says whether to go on. Returns false if it was stopped.
template <typename OpenPiece>
bool FaceTrim::Walk(Vec2 point, const Rect& rect, double band_scale, bool& odd,
                    const OpenPiece& open_piece) const {
  if (nodes_.empty()) return true;
  std::uint32_t stack[kStackSize];
  int waiting = 0;
  stack[waiting++] = static_cast<std::uint32_t>(nodes_.size() - 1);
  while (waiting > 0) {
    const Node& node = nodes_[stack[--waiting]];
    // Compare all boxes at once: bit i of `open` is set where box i meets the rectangle, of `crossing` where
    // its two ends are on different sides of the half-line's height and it lies to the right.
    const double grow_u = band_scale * node.band_u, grow_v = band_scale * node.band_v;
    const double u_low = rect.u_low - grow_u, u_high = rect.u_high + grow_u;
    const double v_low = rect.v_low - grow_v, v_high = rect.v_high + grow_v;
    Bits2 meets{0, 0}, crosses{0, 0};
    for (int i = kWidth / 2 - 1; i >= 0; --i) {
      const Lanes2 left = Two(node.u_low, i);
      meets = meets + meets +
              (One(left <= u_high) & One(Two(node.u_high, i) >= u_low) & One(Two(node.v_low, i) <= v_high) &
               One(Two(node.v_high, i) >= v_low));
      crosses =
          crosses + crosses +
          ((One(Two(node.v_begin, i) <= point.y) ^ One(Two(node.v_end, i) <= point.y)) & One(left > point.x));
    }
    // Now bit i of each is child i's: the first lanes of the pairs, then the second ones.
    auto open = static_cast<unsigned>(meets[0] | meets[1] << kWidth / 2);
    const auto crossing = static_cast<unsigned>(crosses[0] | crosses[1] << kWidth / 2);
    odd ^= __builtin_parity(crossing & ~open);
    for (; open != 0; open &= open - 1) {
      const std::uint32_t child = node.child[__builtin_ctz(open)];
      if ((child & kPieceBit) == 0) {
        stack[waiting++] = child;
      } else if (!open_piece(child & ~kPieceBit, odd)) {
        return false;
      }
    }
  }
  return true;
}

// Returns where `rect`, enlarged by the band of the piece, lies relative to the piece.
FaceTrim::PieceSide FaceTrim::SideOfRect(std::uint32_t i, const Rect& rect, double band_scale,
                                         TrimPath& path) const {
  const TrimPiece& piece = pieces_.pieces[i];
  const double grow_u = band_scale * piece.band_u, grow_v = band_scale * piece.band_v;
  const double u_left = std::min(piece.low.x, piece.high.x), u_right = std::max(piece.low.x, piece.high.x);
  const Vec2 error = pieces_.curves[i].error;
  // Clear of the box: right of it there is no crossing; left of, above and below it the ends decide, as for a
  // box on the right.
  const double u0 = rect.u_low - grow_u, u1 = rect.u_high + grow_u, v0 = rect.v_low - grow_v,
               v1 = rect.v_high + grow_v;
  if (u0 > u_right + error.x) return PieceSide::kRight;
  if (u1 < u_left - error.x || v0 > piece.high.y + error.y || v1 < piece.low.y - error.y)
    return PieceSide::kLeft;

  // Cut off what lies outside the box. A monotone curve runs from corner to corner of it, so the rest is
  // clear of the curve iff its corner next to the curve is: the right one to the left of the curve, or the
  // left one to the right.
  const bool rising = piece.high.x >= piece.low.x;
  const double a0 = std::max(u0, u_left), a1 = std::min(u1, u_right), b0 = std::max(v0, piece.low.y),
               b1 = std::min(v1, piece.high.y);
  if (!(a0 <= a1 && b0 <= b1)) return PieceSide::kMeets;
  path = std::max(path, TrimPath::kStrip);
  const Vec2 right{a1, rising ? b0 : b1}, left{a0, rising ? b1 : b0};
  const Offset r = OffsetFromChord(piece, right), l = OffsetFromChord(piece, left);
  if (r.value - r.error > piece.strip_high) return PieceSide::kLeft;
  if (l.value + l.error < piece.strip_low) return PieceSide::kRight;

  // A corner in the strip: ask the curve.
  const bool ask_right = r.value + r.error >= piece.strip_low,
             ask_left = l.value - l.error <= piece.strip_high;
  if (!ask_right && !ask_left) return PieceSide::kMeets;
  path = TrimPath::kCurve;
  const MonotonePiece curve = pieces_.Monotone(i);
  if (ask_right && SideOf(curve, right) == CurveSide::kLeft) return PieceSide::kLeft;
  if (ask_left && SideOf(curve, left) == CurveSide::kRight) return PieceSide::kRight;
  return PieceSide::kMeets;
}

// Returns whether the half-line from `point` towards +u crosses the piece. Within rounding of the curve the
// chord decides.
bool FaceTrim::CrossesRayTowardsU(std::uint32_t i, Vec2 point, TrimPath& path) const {
  const TrimPiece& piece = pieces_.pieces[i];
  if (!Spans(piece, point.y)) return false;
  if (point.x < std::min(piece.low.x, piece.high.x)) return true;
  if (point.x > std::max(piece.low.x, piece.high.x)) return false;
  path = std::max(path, TrimPath::kStrip);
  const Offset offset = OffsetFromChord(piece, point);
  if (offset.value - offset.error > piece.strip_high) return true;
  if (offset.value + offset.error < piece.strip_low) return false;
  path = TrimPath::kCurve;
  const CurveSide side = SideOf(pieces_.Monotone(i), point);
  return side != CurveSide::kOn ? side == CurveSide::kLeft : offset.value > 0;
}

bool FaceTrim::OddExcept(Vec2 point, std::uint32_t excluded) const {
  bool odd = false;
  TrimPath path = TrimPath::kBoxes;
  // Without bands every piece that is opened counts by its own shape.
  const auto open_piece = [&](std::uint32_t piece, bool& count) {
    if (piece != excluded) count ^= CrossesRayTowardsU(piece, point, path);
    return true;
  };
  Walk(point, {point.x, point.x, point.y, point.y}, 0, odd, open_piece);
  return odd;
}

bool FaceTrim::PiecesIn(const Rect& rect, double band_scale, int most, std::uint32_t* found,
                        int* count) const {
  bool odd = false;
  *count = 0;
  return Walk({rect.u_low, rect.v_low}, rect, band_scale, odd, [&](std::uint32_t i, bool&) {
    if (pieces_.pieces[i].slit) return true;
    if (*count == most) return false;
    found[(*count)++] = i;
    return true;
  });
}

RectClass FaceTrim::Classify(double u0, double u1, double v0, double v1, double band_scale) const {
  if (!(u0 <= u1 && v0 <= v1 && u1 - u0 < kInfinity && v1 - v0 < kInfinity)) return RectClass::kMixed;
  const Rect rect{u0, u1, v0, v1};
  const Vec2 point{u0, v0};
  bool odd = false;
  TrimPath path = TrimPath::kBoxes;
  const auto open_piece = [&](std::uint32_t i, bool& count) {
    const TrimPiece& piece = pieces_.pieces[i];
    if (piece.slit) {
      count ^= CrossesRayTowardsU(i, point, path);
      return true;
    }
    const PieceSide side = SideOfRect(i, rect, band_scale, path);
    count ^= side == PieceSide::kLeft && Spans(piece, point.y);
    return side != PieceSide::kMeets;
  };
  if (!Walk(point, rect, band_scale, odd, open_piece)) return RectClass::kMixed;
  return odd ? RectClass::kInside : RectClass::kOutside;
}

// The nearest point on each of the nearest coedges.
struct FaceTrim::Contacts {
  struct Contact {
    std::uint32_t coedge, piece;
    double distance_mm, edge_parameter;
  };
  static constexpr int kMost = 4;  // two are asked; the others leave room for neighbours at crowded corners
  Contact entries[kMost];
  int count = 0;

  void Add(const Contact& contact) {
    // One entry per coedge, nearest first.
    int i = 0;
    while (i < count && entries[i].coedge != contact.coedge) ++i;
    if (i < count && entries[i].distance_mm <= contact.distance_mm) return;
    if (i == count && count < kMost) ++count;
    if (i == kMost) {
      if (entries[--i].distance_mm <= contact.distance_mm) return;
    }
    for (; i > 0 && entries[i - 1].distance_mm > contact.distance_mm; --i) entries[i] = entries[i - 1];
    entries[i] = contact;
  }
  const Contact* Find(std::uint32_t coedge) const {
    for (int i = 1; i < count; ++i)
      if (entries[i].coedge == coedge) return &entries[i];
    return nullptr;
  }
};

// Answers for `point`, known to within ±error, which is `rect`. walk(open_piece, odd) calls open_piece for all pieces that
// may meet the rectangle, and counts the crossings of the others.
template <typename WalkPieces>
TrimAnswer FaceTrim::Answer(Vec2 point, Vec2 error, const Rect& rect, double band_scale,
                            const WalkPieces& walk) const {
  TrimAnswer answer;
  Contacts contacts;
  const auto open_piece = [&](std::uint32_t i, bool& count) {
    const TrimPiece& piece = pieces_.pieces[i];
    if (piece.slit) {
      count ^= CrossesRayTowardsU(i, point, answer.path);
      return true;
    }
    // Out of the band the piece counts by its side.
    const PieceSide side = SideOfRect(i, rect, band_scale, answer.path);
    if (side != PieceSide::kMeets) {
      count ^= side == PieceSide::kLeft && Spans(piece, point.y);
      return true;
    }
    count ^= CrossesRayTowardsU(i, point, answer.path);
    const bool band = band_scale > 0 && (piece.band_u > 0 || piece.band_v > 0);
    if (answer.certain && (!band || SideOfRect(i, rect, 0, answer.path) == PieceSide::kMeets))
      answer.certain = false;
    if (piece.coedge == kNoIndex) return true;

    // In the band: the nearest point, in millimetres by the band's own metric.
    const TrimPieceCurve& curve = pieces_.curves[i];
    const Vec2 scale{curve.reach_mm / piece.band_u, curve.reach_mm / piece.band_v};
    const MonotonePiece monotone = pieces_.Monotone(i);
    const double t = NearestParameter(monotone, point, scale);
    const Vec2 away = PointOn(monotone.curve, t) - point;
    contacts.Add({piece.coedge, i, Length(Vec2{scale.x * away.x, scale.y * away.y}),
                  curve.edge_begin + t * (curve.edge_end - curve.edge_begin)});
    return true;
  };
  walk(open_piece, answer.inside);
  if (contacts.count == 0) return answer;

  const Contacts::Contact& nearest = contacts.entries[0];
  const Ends& ends = ends_[nearest.coedge - first_coedge_];
  answer.coedge = nearest.coedge;
  answer.edge_parameter = nearest.edge_parameter;
  answer.material_left = ends.material_left;
  // At a corner the neighbour is asked as well: if its band holds the point, too, as along both sides of a
  // narrow wedge, or if the corner is near.
  const Contacts::Contact* next = contacts.Find(ends.next);
  const Contacts::Contact* previous = contacts.Find(ends.previous);
  const bool nearer_end =
      std::fabs(nearest.edge_parameter - ends.end) <= std::fabs(nearest.edge_parameter - ends.begin);
  const bool at_end = (next != nullptr) == (previous != nullptr) ? nearer_end : next != nullptr;
  const Contacts::Contact* contact = at_end ? next : previous;
  const std::uint32_t neighbour = at_end ? ends.next : ends.previous;
  if (neighbour == kNoIndex || neighbour == nearest.coedge) return answer;
  const TrimPiece& piece = pieces_.pieces[nearest.piece];
  const Vec2 away = point - (at_end ? ends.end_point : ends.begin_point);
  const bool corner_is_near = std::fabs(away.x) <= kCornerReach * (error.x + band_scale * piece.band_u) &&
                              std::fabs(away.y) <= kCornerReach * (error.y + band_scale * piece.band_v);
  if (contact == nullptr && !corner_is_near) return answer;
  const Ends& other = ends_[neighbour - first_coedge_];
  answer.other_coedge = neighbour;
  answer.other_is_next = at_end;
  answer.other_edge_parameter = contact != nullptr ? contact->edge_parameter
                                : at_end           ? other.begin
                                                   : other.end;
  answer.other_material_left = other.material_left;
  return answer;
}

TrimAnswer FaceTrim::Query(double u, double v, double error_u, double error_v, double band_scale) const {
  const Vec2 point{u, v};
  const Rect rect{u - error_u, u + error_u, v - error_v, v + error_v};
  if (!(rect.u_low <= u && u <= rect.u_high && rect.v_low <= v && v <= rect.v_high &&
        rect.u_high - rect.u_low < kInfinity && rect.v_high - rect.v_low < kInfinity)) {
    TrimAnswer answer;
    answer.certain = false;
    return answer;
  }
  return Answer(point, {error_u, error_v}, rect, band_scale,
                [&](const auto& open_piece, bool& odd) { Walk(point, rect, band_scale, odd, open_piece); });
}

TrimAnswer FaceTrim::Query(const TrimWindow& window, double u, double v, double error_u, double error_v,
                           double band_scale) const {
  const Vec2 point{u, v};
  const Rect rect{u - error_u, u + error_u, v - error_v, v + error_v};
  if (!window.Holds(rect.u_low, rect.u_high, rect.v_low, rect.v_high, band_scale))
    return Query(u, v, error_u, error_v, band_scale);
  return Answer(point, {error_u, error_v}, rect, band_scale, [&](const auto& open_piece, bool& odd) {
    odd = window.odd;
    for (int i = 0; i < window.end_count; ++i) odd ^= window.ends[i] <= v;
    for (int i = 0; i < window.piece_count; ++i) open_piece(window.pieces[i], odd);
  });
}

}  // namespace facetless
