#include "render/nurbs/trim_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "render/model/walk.h"

namespace facetless {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// The error of a hit of the tracer is about this many units in the last place of the surface's largest
// coordinate plus the model's diagonal, because the eye is about a diagonal away.
constexpr double kPointUlps = 16;
// A safety factor: the metric is sampled only at the ends and the middle of a piece and may be larger in
// between, and the p-curve lies up to one gap away from the edge.
constexpr double kBandSafety = 2;
// A piece is divided while its strip takes more than this share of its box …
constexpr double kStripShare = 0.5;
// … but next to an extremum the share does not decrease with the length of the piece, so there is a limit.
constexpr int kStripCuts = 2;
// A piece is divided while its widest band exceeds both kBandRatio times its narrowest band and kBandShare of
// the grid. It is divided at kBandCut of its length from the widest end: towards a pole, the band grows like
// one over the distance, so one division per decade is needed.
constexpr double kBandRatio = 2, kBandShare = 1.0 / 64, kBandCut = 0.1;
constexpr int kBandCuts = 20;

bool Within(Vec2 a, Vec2 b, Vec2 tolerance) {
  return std::fabs(a.x - b.x) <= tolerance.x && std::fabs(a.y - b.y) <= tolerance.y;
}

bool SameBits(Vec2 a, Vec2 b) {
  return a.x == b.x && a.y == b.y;
}

float RoundedUp(double x) {
  const float nearest = static_cast<float>(x);
  return nearest >= x ? nearest : std::nextafterf(nearest, std::numeric_limits<float>::infinity());
}

class Maker {
 public:
  Maker(const Model& model, const Face& face, const SurfaceEval& surface)
      : model_(model),
        surface_(surface),
        rounding_mm_(kPointUlps * kEpsilon * (surface.magnitude() + model.Diagonal())),
        grid_{surface.u_end() - surface.u_begin(), surface.v_end() - surface.v_begin()} {
    FindSlits(face);
    for (const Loop& loop : LoopsOf(model, face)) AddLoop(loop);
    if (out_.pieces.empty()) AddBorder();
    out_.loop_first.push_back(static_cast<std::uint32_t>(out_.pieces.size()));
  }

  TrimPieces Take() {
    out_.pieces.shrink_to_fit();
    out_.curves.shrink_to_fit();
    out_.points.shrink_to_fit();
    return std::move(out_);
  }

 private:
  struct Source {  // the coedge to which the current pieces belong
    std::uint32_t coedge = kNoIndex;
    double gap_mm = 0;
    bool slit = false;
  };

  PlaneCurve TrimSegmentCurve(const TrimSegment& segment) const {
    return {PointsOf(model_, segment).data(), segment.degree};
  }

  // The point of a coedge's p-curve at the middle of its edge parameters.
  Vec2 MiddleOf(const Coedge& coedge) const {
    const std::span<const TrimSegment> segments = SegmentsOf(model_, coedge);
    const double middle = 0.5 * (segments.front().edge_begin + segments.back().edge_end);
    for (const TrimSegment& segment : segments) {
      const double width = segment.edge_end - segment.edge_begin;
      const double t = (middle - segment.edge_begin) / width;
      if (t >= 0 && t <= 1) return PointOn(TrimSegmentCurve(segment), t);
    }
    return PointOn(TrimSegmentCurve(segments.front()), 0.5);
  }

  // Finds slits (law 3): opposite coedges of one edge whose begins, ends and middles coincide in surface
  // parameters.
  void FindSlits(const Face& face) {
    std::unordered_map<std::uint32_t, std::uint32_t> first_use;
    for (const Coedge& coedge : CoedgesOf(model_, face)) {
      if (coedge.edge == kNoIndex || coedge.segments.count == 0 || model_.edges[coedge.edge].degenerate)
        continue;
      const std::uint32_t c = IndexWithin(model_.coedges, coedge);
      const auto [use, is_first] = first_use.try_emplace(coedge.edge, c);
      if (is_first || model_.coedges[use->second].reversed == coedge.reversed) continue;
      if (RunToAndFro(model_.coedges[use->second], coedge)) {
        twin_[c] = use->second;
        twin_[use->second] = use->second;
      }
    }
  }

  bool RunToAndFro(const Coedge& a, const Coedge& b) const {
    const auto begin = [&](const Coedge& c) {
      return PointOn(TrimSegmentCurve(SegmentsOf(model_, c).front()), 0);
    };
    const auto end = [&](const Coedge& c) {
      return PointOn(TrimSegmentCurve(SegmentsOf(model_, c).back()), 1);
    };
    const double reach = std::max(a.gap_mm, b.gap_mm) + rounding_mm_;
    const auto same = [&](Vec2 p, Vec2 q) { return Within(p, q, HalfWidths(p, reach)); };
    return same(begin(a), end(b)) && same(end(a), begin(b)) && same(MiddleOf(a), MiddleOf(b));
  }

  void AddLoop(const Loop& loop) {
    std::uint32_t last = kNoIndex;
    for (const std::uint32_t c : Indices(loop.coedges))
      if (model_.coedges[c].segments.count > 0) last = c;
    if (last == kNoIndex) return;
    out_.loop_first.push_back(static_cast<std::uint32_t>(out_.pieces.size()));
    started_ = false;
    for (std::uint32_t c = loop.coedges.first; c <= last; ++c) AddCoedge(c, c == last);
    JoinTo(first_);
  }

  void AddCoedge(std::uint32_t c, bool last_of_loop) {
    const Coedge& coedge = model_.coedges[c];
    const auto twin = twin_.find(c);
    if (twin != twin_.end() && twin->second != c) {
      AddReversed(made_[twin->second]);
      return;
    }
    const bool askable = coedge.edge != kNoIndex && !model_.edges[coedge.edge].degenerate;
    const bool slit = twin != twin_.end();
    Source source;
    if (askable && !slit) source = {c, coedge.gap_mm, false};
    source.slit = slit;
    for (const std::uint32_t s : Indices(coedge.segments)) {
      const TrimSegment& segment = model_.trim_segments[s];
      AddCurve(TrimSegmentCurve(segment), source, segment.edge_begin, segment.edge_end,
               last_of_loop && s + 1 == coedge.segments.end());
      // A joining piece, if one was needed, belongs to the previous coedge.
      if (slit && s == coedge.segments.first) made_[c].first = curve_first_;
    }
    if (slit) made_[c].count = static_cast<std::uint32_t>(out_.pieces.size()) - made_[c].first;
  }

  // Adds the second side of a slit.
  void AddReversed(Range pieces) {
    for (std::uint32_t i = pieces.end(); i-- > pieces.first;) {
      TrimPiece piece = out_.pieces[i];
      const TrimPieceCurve curve = out_.curves[i];
      piece.forward = !piece.forward;
      JoinTo(piece.forward ? piece.low : piece.high);
      out_.pieces.push_back(piece);
      out_.curves.push_back(curve);
      end_ = piece.forward ? piece.high : piece.low;
    }
  }

  void AddBorder() {
    out_.loop_first.assign(1, 0);
    const double u0 = surface_.u_begin(), u1 = surface_.u_end(), v0 = surface_.v_begin(),
                 v1 = surface_.v_end();
    const Vec3 corners[5] = {{u0, v0, 1}, {u1, v0, 1}, {u1, v1, 1}, {u0, v1, 1}, {u0, v0, 1}};
    started_ = false;
    for (int i = 0; i < 4; ++i) AddCurve({corners + i, 1}, {}, 0, 0, i == 3);
  }

  // Adds a straight piece from the current end of the loop to `point`, if they differ. It belongs to the
  // previous coedge.
  void JoinTo(Vec2 point) {
    if (!started_) {
      started_ = true;
      first_ = end_ = point;
    }
    if (SameBits(end_, point)) return;
    const Vec3 line[2] = {{end_.x, end_.y, 1}, {point.x, point.y, 1}};
    Source source;
    double parameter = 0;
    if (out_.pieces.size() > out_.loop_first.back()) {
      const TrimPieceCurve& before = out_.curves.back();
      const TrimPiece& piece = out_.pieces.back();
      source = {piece.coedge, before.reach_mm - rounding_mm_, false};
      const double t = piece.forward ? before.t_high : before.t_low;
      parameter = before.edge_begin + t * (before.edge_end - before.edge_begin);
    }
    curve_ = NewCurve({line, 1}, source, parameter, parameter);
    Split(EndAt(0, end_), EndAt(1, point), 0);
    end_ = point;
  }

  TrimPieceCurve NewCurve(const PlaneCurve& curve, const Source& source, double edge_begin, double edge_end) {
    TrimPieceCurve result;
    result.first_point = static_cast<std::uint32_t>(out_.points.size());
    result.degree = static_cast<std::uint32_t>(curve.degree);
    result.error = EvaluationError(curve);
    result.edge_begin = edge_begin;
    result.edge_end = edge_end;
    result.reach_mm = source.coedge == kNoIndex ? 0 : source.gap_mm + rounding_mm_;
    source_ = source;
    out_.points.insert(out_.points.end(), curve.points, curve.points + curve.degree + 1);
    return result;
  }

  void AddCurve(const PlaneCurve& curve, const Source& source, double edge_begin, double edge_end,
                bool last_of_loop) {
    // Begin at the current end of the loop: with identical bits if rounding explains the difference, and
    // otherwise with a straight piece in between.
    const Vec2 error = EvaluationError(curve);
    const Vec2 tolerance = 2 * error;
    Vec2 begin = PointOn(curve, 0), end = PointOn(curve, 1);
    if (started_ && Within(begin, end_, tolerance)) begin = end_;
    JoinTo(begin);
    if (last_of_loop && Within(end, first_, tolerance)) end = first_;
    curve_first_ = static_cast<std::uint32_t>(out_.pieces.size());
    curve_ = NewCurve(curve, source, edge_begin, edge_end);

    // Divide at the extrema of u and v.
    std::vector<double> cuts;
    AppendTurns(curve, cuts);
    std::sort(cuts.begin(), cuts.end());
    cuts.push_back(1);
    End from = EndAt(0, begin);
    for (double next : cuts) {
      if (!(next > from.t)) continue;
      const End to = EndAt(next, next < 1 ? PointOn(curve, next) : end);
      Split(from, to, 0);
      from = to;
    }
    end_ = end;
  }

  // An end of a monotone interval, with the half-widths of the band there.
  struct End {
    double t = 0;
    Vec2 point, band;
  };

  End EndAt(double t, Vec2 point) const {
    return {t, point, source_.coedge == kNoIndex ? Vec2{} : HalfWidths(point, curve_.reach_mm)};
  }

  PlaneCurve Current() const {
    return {out_.points.data() + curve_.first_point, static_cast<int>(curve_.degree)};
  }

  // The point of curve_ at t between two ends of a monotone interval, clamped to their box in spite of
  // rounding.
  End Between(const End& a, const End& b, double t) const {
    const Vec2 p = PointOn(Current(), t);
    return EndAt(t, {std::clamp(p.x, std::min(a.point.x, b.point.x), std::max(a.point.x, b.point.x)),
                     std::clamp(p.y, std::min(a.point.y, b.point.y), std::max(a.point.y, b.point.y))});
  }

  // Divides a monotone interval of curve_ until it is close to its chord.
  void Split(const End& begin, const End& end, int cuts) {
    const End middle = Between(begin, end, 0.5 * (begin.t + end.t));
    if (cuts < kStripCuts && middle.t > begin.t && middle.t < end.t) {
      const Vec2 chord = end.point - begin.point;
      const auto [low, high] = Strip(begin, end);
      if (high - low > kStripShare * std::fabs(chord.x * chord.y)) {
        Split(begin, middle, cuts + 1);
        Split(middle, end, cuts + 1);
        return;
      }
    }
    SplitForBand(begin, middle, end, 0);
  }

  // Divides until the band is approximately constant.
  void SplitForBand(const End& begin, const End& middle, const End& end, int cuts) {
    const auto uneven = [](double a, double b, double c, double grid) {
      const double widest = std::max({a, b, c});
      return widest > kBandRatio * std::min({a, b, c}) && widest > kBandShare * grid;
    };
    const bool in_u = uneven(begin.band.x, middle.band.x, end.band.x, grid_.x);
    const bool in_v = uneven(begin.band.y, middle.band.y, end.band.y, grid_.y);
    if ((in_u || in_v) && cuts < kBandCuts) {
      const auto width = [&](const End& e) { return in_u ? e.band.x : e.band.y; };
      const bool widest_inside = width(middle) >= std::max(width(begin), width(end));
      const double share = widest_inside ? 0.5 : width(begin) > width(end) ? kBandCut : 1 - kBandCut;
      const End cut = Between(begin, end, begin.t + share * (end.t - begin.t));
      if (cut.t > begin.t && cut.t < end.t) {
        SplitForBand(begin, Between(begin, cut, 0.5 * (begin.t + cut.t)), cut, cuts + 1);
        SplitForBand(cut, Between(cut, end, 0.5 * (cut.t + end.t)), end, cuts + 1);
        return;
      }
    }
    AddPiece(begin, middle, end);
  }

  // The range of cross(chord from begin to end, c − begin) over the hull of the interval, its ends included.
  std::pair<double, double> Strip(const End& begin, const End& end) {
    const Vec2 chord = end.point - begin.point;
    double low = 0, high = 0;
    if (curve_.degree > 1) {
      StretchHull(Current(), begin.t, end.t, hull_);
      for (Vec2 c : hull_) {
        const double offset = Cross(chord, c - begin.point);
        low = std::min(low, offset);
        high = std::max(high, offset);
      }
    }
    return {low, high};
  }

  void AddPiece(const End& begin, const End& middle, const End& end) {
    const bool upwards =
        end.point.y > begin.point.y || (end.point.y == begin.point.y && end.point.x >= begin.point.x);
    const End& low = upwards ? begin : end;
    const End& high = upwards ? end : begin;
    TrimPiece piece;
    piece.low = low.point;
    piece.high = high.point;
    piece.forward = upwards;
    piece.coedge = source_.coedge;
    piece.slit = source_.slit;
    // Widen the strip by the effect of rounding and of snapped ends. For a reversed piece, the other end of
    // the chord serves equally well as the origin.
    const Vec2 chord = high.point - low.point;
    const double slack = 4 * (std::fabs(chord.x) * curve_.error.y + std::fabs(chord.y) * curve_.error.x);
    const auto [least, most] = Strip(begin, end);
    piece.strip_low = (upwards ? least : -most) - slack;
    piece.strip_high = (upwards ? most : -least) + slack;
    piece.band_u = RoundedUp(kBandSafety * std::max({begin.band.x, middle.band.x, end.band.x}));
    piece.band_v = RoundedUp(kBandSafety * std::max({begin.band.y, middle.band.y, end.band.y}));
    curve_.t_low = low.t;
    curve_.t_high = high.t;
    out_.pieces.push_back(piece);
    out_.curves.push_back(curve_);
  }

  // The largest change of u and v while the surface point moves by `reach_mm`; at most the whole grid.
  Vec2 HalfWidths(Vec2 at, double reach_mm) const {
    const SurfacePoint point = surface_.First(at.x, at.y);
    const double su = Length(point.du), sv = Length(point.dv), area = Length(Cross(point.du, point.dv));
    const double across_u = sv > 0 ? area / sv : su, across_v = su > 0 ? area / su : sv;
    const double u = reach_mm / across_u, v = reach_mm / across_v;
    return {u < grid_.x ? u : grid_.x, v < grid_.y ? v : grid_.y};
  }

  const Model& model_;
  const SurfaceEval& surface_;
  const double rounding_mm_;
  const Vec2 grid_;
  TrimPieces out_;
  std::unordered_map<std::uint32_t, std::uint32_t> twin_;  // coedge of a slit -> the first of the two
  std::unordered_map<std::uint32_t, Range> made_;          // pieces of the first side of a slit
  // The loop being made.
  bool started_ = false;
  Vec2 first_, end_;
  Source source_;
  TrimPieceCurve curve_;
  std::uint32_t curve_first_ = 0;
  std::vector<Vec2> hull_;
};

}  // namespace

MonotonePiece TrimPieces::Monotone(std::size_t piece) const {
  const TrimPieceCurve& c = curves[piece];
  return {{points.data() + c.first_point, static_cast<int>(c.degree)},
          c.t_low,
          c.t_high,
          pieces[piece].low,
          pieces[piece].high,
          c.error};
}

TrimPieces MakeTrimPieces(const Model& model, std::uint32_t face, const SurfaceEval& surface) {
  return Maker(model, model.faces[face], surface).Take();
}

}  // namespace facetless
