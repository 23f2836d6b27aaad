#include "render/nurbs/trim_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace facetless {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// A surface point of the tracer is off by about this many units in the last place of the surface's largest
// coordinate.
constexpr double kPointUlps = 16;
// The metric is sampled at the ends and the middle of a piece; it may exceed the samples in between, and the
// p-curve lies up to one gap away from the edge itself.
constexpr double kBandSafety = 2;
// A piece is cut while its strip takes more than this share of its box …
constexpr double kStripShare = 1.0 / 8;
// … but next to an extremum the share stays the same however short the piece: stop after this many cuts.
constexpr int kStripCuts = 3;
// A piece is cut while the band at its widest is over kBandRatio times that at its narrowest and over
// kBandShare of the grid. Next to a pole that takes one cut per factor of two.
constexpr double kBandRatio = 2, kBandShare = 1.0 / 64;
constexpr int kBandCuts = 48;

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
        rounding_mm_(kPointUlps * kEpsilon * surface.magnitude()),
        grid_{surface.u_end() - surface.u_begin(), surface.v_end() - surface.v_begin()} {
    FindSlits(face);
    for (std::uint32_t l = face.loops.first; l < face.loops.end(); ++l) AddLoop(model.loops[l]);
    if (out_.pieces.empty()) AddBorder();
    out_.loop_first.push_back(static_cast<std::uint32_t>(out_.pieces.size()));
  }

  TrimPieces Take() { return std::move(out_); }

 private:
  struct Source {  // what the pieces being made belong to
    std::uint32_t coedge = kNoIndex;
    double gap_mm = 0;
    bool slit = false;
  };

  PlaneCurve CurveOf(const TrimSegment& segment) const {
    return {model_.trim_points.data() + segment.first_point, segment.degree};
  }

  // The point of a coedge's p-curve at half of its edge's parameters.
  Vec2 MiddleOf(const Coedge& coedge) const {
    const TrimSegment& first = model_.trim_segments[coedge.segments.first];
    const TrimSegment& last = model_.trim_segments[coedge.segments.end() - 1];
    const double middle = 0.5 * (first.edge_begin + last.edge_end);
    for (std::uint32_t s = coedge.segments.first; s < coedge.segments.end(); ++s) {
      const TrimSegment& segment = model_.trim_segments[s];
      const double width = segment.edge_end - segment.edge_begin;
      const double t = (middle - segment.edge_begin) / width;
      if (t >= 0 && t <= 1) return PointOn(CurveOf(segment), t);
    }
    return PointOn(CurveOf(first), 0.5);
  }

  // Law 3: opposite coedges of one edge whose begin, end and middle coincide on the surface's parameters.
  void FindSlits(const Face& face) {
    std::unordered_map<std::uint32_t, std::uint32_t> first_use;
    for (std::uint32_t l = face.loops.first; l < face.loops.end(); ++l) {
      const Range coedges = model_.loops[l].coedges;
      for (std::uint32_t c = coedges.first; c < coedges.end(); ++c) {
        const Coedge& coedge = model_.coedges[c];
        if (coedge.edge == kNoIndex || coedge.segments.count == 0 || model_.edges[coedge.edge].degenerate)
          continue;
        const auto [use, is_first] = first_use.try_emplace(coedge.edge, c);
        if (is_first || model_.coedges[use->second].reversed == coedge.reversed) continue;
        if (RunToAndFro(model_.coedges[use->second], coedge)) {
          twin_[c] = use->second;
          twin_[use->second] = use->second;
        }
      }
    }
  }

  bool RunToAndFro(const Coedge& a, const Coedge& b) const {
    const auto begin = [&](const Coedge& c) {
      return PointOn(CurveOf(model_.trim_segments[c.segments.first]), 0);
    };
    const auto end = [&](const Coedge& c) {
      return PointOn(CurveOf(model_.trim_segments[c.segments.end() - 1]), 1);
    };
    const double reach = std::max(a.gap_mm, b.gap_mm) + rounding_mm_;
    const auto same = [&](Vec2 p, Vec2 q) { return Within(p, q, HalfWidths(p, reach)); };
    return same(begin(a), end(b)) && same(end(a), begin(b)) && same(MiddleOf(a), MiddleOf(b));
  }

  void AddLoop(const Loop& loop) {
    std::uint32_t last = kNoIndex;
    for (std::uint32_t c = loop.coedges.first; c < loop.coedges.end(); ++c)
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
    for (std::uint32_t s = coedge.segments.first; s < coedge.segments.end(); ++s) {
      const TrimSegment& segment = model_.trim_segments[s];
      AddCurve(CurveOf(segment), source, segment.edge_begin, segment.edge_end,
               last_of_loop && s + 1 == coedge.segments.end());
      // The joining piece, if one was needed, belongs to the coedge before.
      if (slit && s == coedge.segments.first) made_[c].first = curve_first_;
    }
    if (slit) made_[c].count = static_cast<std::uint32_t>(out_.pieces.size()) - made_[c].first;
  }

  // The second side of a slit.
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

  // A straight piece from where the loop has got to, if that isn't `point` already. It belongs to the coedge
  // before.
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
    Split(0, end_, 1, point, 0);
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
    // Begin where the loop has got to: to the bit if rounding explains the difference, else along a straight
    // piece.
    const Vec2 error = EvaluationError(curve);
    const Vec2 tolerance = 2 * error;
    Vec2 begin = PointOn(curve, 0), end = PointOn(curve, 1);
    if (started_ && Within(begin, end_, tolerance)) begin = end_;
    JoinTo(begin);
    if (last_of_loop && Within(end, first_, tolerance)) end = first_;
    curve_first_ = static_cast<std::uint32_t>(out_.pieces.size());
    curve_ = NewCurve(curve, source, edge_begin, edge_end);

    // Cut where u or v turns.
    std::vector<double> cuts;
    AppendTurns(curve, cuts);
    std::sort(cuts.begin(), cuts.end());
    cuts.push_back(1);
    double t = 0;
    Vec2 point = begin;
    for (double next : cuts) {
      if (!(next > t)) continue;
      const Vec2 target = next < 1 ? PointOn(curve, next) : end;
      Split(t, point, next, target, 0);
      t = next;
      point = target;
    }
    end_ = end;
  }

  // One monotone stretch of curve_, cut until it hugs its chord and its band is about constant.
  void Split(double t0, Vec2 p0, double t1, Vec2 p1, int depth) {
    const PlaneCurve curve{out_.points.data() + curve_.first_point, static_cast<int>(curve_.degree)};
    const bool upwards = p1.y > p0.y || (p1.y == p0.y && p1.x >= p0.x);
    TrimPiece piece;
    piece.low = upwards ? p0 : p1;
    piece.high = upwards ? p1 : p0;
    piece.forward = upwards;
    piece.coedge = source_.coedge;
    piece.slit = source_.slit;

    // The strip: the hull's distances from the chord, and what rounding and snapped ends may add.
    const Vec2 chord = piece.high - piece.low;
    const double slack = 4 * (std::fabs(chord.x) * curve_.error.y + std::fabs(chord.y) * curve_.error.x);
    if (curve.degree > 1) {
      StretchHull(curve, t0, t1, hull_);
      for (Vec2 c : hull_) {
        const double offset = Cross(chord, c - piece.low);
        piece.strip_low = std::min(piece.strip_low, offset);
        piece.strip_high = std::max(piece.strip_high, offset);
      }
    }
    const double thickness = piece.strip_high - piece.strip_low;
    const bool cut_for_strip = depth < kStripCuts && thickness > kStripShare * std::fabs(chord.x * chord.y);
    piece.strip_low -= slack;
    piece.strip_high += slack;

    // The band, from the metric at both ends and the middle.
    const double tm = 0.5 * (t0 + t1);
    Vec2 middle = PointOn(curve, tm);
    middle = {std::clamp(middle.x, std::min(p0.x, p1.x), std::max(p0.x, p1.x)),
              std::clamp(middle.y, piece.low.y, piece.high.y)};
    bool cut_for_band = false;
    if (source_.coedge != kNoIndex) {
      const Vec2 a = HalfWidths(p0, curve_.reach_mm), b = HalfWidths(middle, curve_.reach_mm),
                 c = HalfWidths(p1, curve_.reach_mm);
      const Vec2 widest{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})};
      const Vec2 narrowest{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})};
      piece.band_u = RoundedUp(kBandSafety * widest.x);
      piece.band_v = RoundedUp(kBandSafety * widest.y);
      cut_for_band =
          depth < kBandCuts && ((widest.x > kBandRatio * narrowest.x && widest.x > kBandShare * grid_.x) ||
                                (widest.y > kBandRatio * narrowest.y && widest.y > kBandShare * grid_.y));
    }

    if ((cut_for_strip || cut_for_band) && tm > t0 && tm < t1) {
      Split(t0, p0, tm, middle, depth + 1);
      Split(tm, middle, t1, p1, depth + 1);
      return;
    }
    curve_.t_low = upwards ? t0 : t1;
    curve_.t_high = upwards ? t1 : t0;
    out_.pieces.push_back(piece);
    out_.curves.push_back(curve_);
  }

  // How far u and v may move while the surface point moves by `reach_mm`; at most the whole grid.
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
