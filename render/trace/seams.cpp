#include "render/trace/seams.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "render/base/parallel.h"
#include "render/model/walk.h"
#include "render/nurbs/angle_map.h"
#include "render/nurbs/edge_points.h"
#include "render/nurbs/point_room.h"
#include "render/trace/edge_winding.h"
#include "render/trace/projected_edges.h"

namespace facetless {
namespace {

// The gap is measured at discrete points of a p-curve, and may be twice as large between them.
constexpr double kReachSafety = 2;
// A reach below this, in samples, is within the rounding of a projected edge, which projected_edges.cpp
// allows for.
constexpr double kRoundingPx = 0x1p-20;
// A piece of an edge is replaced by its chord if it deviates from it by no more than this, in samples.
constexpr double kFlatPx = 1.0 / 64;
constexpr int kMaxHalvings = 40;
// If the distance between a face and its edge exceeds this share of the edge's length, one of the two must be
// wrong (the importer warns from 1 % on). Such a gap is left visible if it is wider than kMostReachPx
// samples, because treating all its samples took a minute and a half for three faces.
constexpr double kOffSurface = 2e-3;
constexpr double kMostReachPx = 8;

Vec3 EndOf(const Model& model, const Edge& edge, bool last) {
  const std::span<const EdgeSegment> segments = SegmentsOf(model, edge);
  const std::span<const Vec4> points = PointsOf(model, last ? segments.back() : segments.front());
  const Vec4& p = last ? points.back() : points.front();
  return {p.x / p.w, p.y / p.w, p.z / p.w};
}

// The edges that the face uses an odd number of times; empty if the face is not treated (law 4).
std::vector<std::uint32_t> FaceBorder(const Model& model, const Face& face) {
  const bool closed_solid = face.solid != kNoIndex && model.solids[face.solid].closed;
  std::map<std::uint32_t, int> edges, ends;
  for (const Coedge& coedge : CoedgesOf(model, face)) {
    const std::uint32_t edge = coedge.edge;
    // In a closed solid, a coedge without an edge belongs to a cut that is traversed in both directions.
    if (edge == kNoIndex && !closed_solid) return {};
    if (edge == kNoIndex || model.edges[edge].segments.count == 0) continue;
    ++edges[edge];
    for (const std::uint32_t vertex : model.edges[edge].vertices) {
      if (vertex == kNoIndex) return {};
      ++ends[vertex];
    }
  }
  for (const auto& [vertex, count] : ends)
    if (count % 2 != 0) return {};
  std::vector<std::uint32_t> border;
  for (const auto& [edge, count] : edges)
    if (count % 2 != 0) border.push_back(edge);
  return border;
}

}  // namespace

SeamTable::SeamTable(const Model& model) {
  // Borders.
  for (const Face& face : model.faces) {
    const std::vector<std::uint32_t> border = FaceBorder(model, face);
    border_of.push_back(
        {static_cast<std::uint32_t>(edges.size()), static_cast<std::uint32_t>(border.size())});
    edges.insert(edges.end(), border.begin(), border.end());
  }

  for (const Part& part : model.parts) {
    // Collect the uses of each edge and vertex, and the distances by which faces miss them.
    struct Missed {
      double reach_mm = 0;
      double most_mm =
          0;  // limit of the reach: a gap wider than the length of the edge carries no information
      std::vector<Use> uses;
    };
    std::map<std::uint32_t, Missed> at_edge, at_vertex;
    for (const std::uint32_t f : Indices(part.faces)) {
      for (const Coedge& coedge : CoedgesOf(model, model.faces[f])) {
        const std::uint32_t e = coedge.edge;
        if (e == kNoIndex || model.edges[e].segments.count == 0 || coedge.segments.count == 0) continue;
        const Use use{f, IndexWithin(model.coedges, coedge)};
        Missed& missed = at_edge[e];
        missed.reach_mm = std::max(missed.reach_mm, coedge.gap_mm);
        missed.uses.push_back(use);
        for (const std::uint32_t v : model.edges[e].vertices)
          if (v != kNoIndex) at_vertex[v].uses.push_back(use);
      }
    }
    for (auto& [e, missed] : at_edge) {
      const Edge& edge = model.edges[e];
      missed.most_mm = PolygonLength(model, edge);
      for (const bool last : {false, true}) {
        if (edge.vertices[last] == kNoIndex) continue;
        Missed& vertex = at_vertex[edge.vertices[last]];
        const double distance = Length(EndOf(model, edge, last) - model.vertices[edge.vertices[last]].point);
        vertex.reach_mm = std::max(vertex.reach_mm, distance + missed.reach_mm);
        vertex.most_mm = std::max(vertex.most_mm, missed.most_mm);
      }
    }
    const auto first = static_cast<std::uint32_t>(sources.size());
    const auto add = [&](Source source, const Missed& missed) {
      if (!(missed.reach_mm > 0)) return;
      source.reach_mm = std::min(kReachSafety * missed.reach_mm, missed.most_mm);
      source.off_surface = missed.reach_mm > kOffSurface * missed.most_mm;
      source.uses = {static_cast<std::uint32_t>(uses.size()), static_cast<std::uint32_t>(missed.uses.size())};
      uses.insert(uses.end(), missed.uses.begin(), missed.uses.end());
      sources.push_back(source);
      max_reach_mm = std::max(max_reach_mm, source.reach_mm);
    };
    for (const auto& [e, missed] : at_edge) add({e, kNoIndex, 0, {}, false}, missed);
    for (const auto& [v, missed] : at_vertex) add({kNoIndex, v, 0, {}, false}, missed);
    of_part.push_back({first, static_cast<std::uint32_t>(sources.size()) - first});
  }
}

std::size_t SeamTable::bytes() const {
  return sources.capacity() * sizeof(Source) + uses.capacity() * sizeof(Use) +
         (of_part.capacity() + border_of.capacity()) * sizeof(Range) +
         edges.capacity() * sizeof(std::uint32_t);
}

namespace {

class Finder {
 public:
  Finder(const Model& model, const SeamTable& table, const Camera& camera, const CameraFrame& frame,
         std::uint32_t instance, const SeamSampleFilter& filter, SplitBudget* budget,
         std::vector<SeamSample>* found)
      : model_(model),
        table_(table),
        frame_(frame),
        columns_(camera.width_px),
        rows_(camera.height_px),
        instance_(instance),
        perspective_(frame.projection == Projection::kPerspective),
        edges_(model, model.instances[instance].placement, frame),
        filter_(filter),
        budget_(budget),
        found_(found) {}

  void Visit(std::uint32_t index) {
    const SeamTable::Source& source = table_.sources[index];
    source_ = &source;
    source_index_ = index;
    candidates_.clear();
    if (source.vertex != kNoIndex) {
      const Vec3& p = model_.vertices[source.vertex].point;
      const Vec3 h = edges_.Relative({p.x, p.y, p.z, 1}, 0, 0);
      if (h.z > 0) VisitVertex({h.x / h.z, h.y / h.z}, ReachPx(h.z));
    } else {
      for (const EdgeSegment& segment : SegmentsOf(model_, model_.edges[source.edge])) VisitSegment(segment);
    }
    // Merge samples that two pieces of one edge found.
    std::sort(candidates_.begin(), candidates_.end());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end(),
                                  [](const Candidate& a, const Candidate& b) {
                                    return a.row == b.row && a.column == b.column;
                                  }),
                      candidates_.end());
    for (const Candidate& candidate : candidates_) {
      if (budget_->Stopped()) return;
      AddUses(candidate);
    }
  }

 private:
  struct Candidate {
    int row, column;
    double distance_px, parameter;
    bool operator<(const Candidate& o) const {
      return std::tie(row, column, distance_px, parameter) <
             std::tie(o.row, o.column, o.distance_px, o.parameter);
    }
  };

  // The reach in samples, at the depth of a point with weight w.
  double ReachPx(double w) const {
    return source_->reach_mm / (std::min(frame_.pixel_x, frame_.pixel_y) * (perspective_ ? w : 1));
  }

  bool IsLeftVisible(double reach) const { return source_->off_surface && reach > kMostReachPx; }

  // A range of samples, clipped to the image.
  struct Samples {
    int begin, end;
  };
  static Samples Between(double low, double high, int count) {
    const double first = std::ceil(low - 0.5), last = std::floor(high - 0.5);
    if (!(first <= last) || first >= count || last < 0) return {0, 0};
    return {static_cast<int>(std::max(first, 0.0)), static_cast<int>(std::min(last, count - 1.0)) + 1};
  }

  void VisitVertex(Vec2 at, double reach) {
    if (!(reach >= kRoundingPx) || IsLeftVisible(reach)) return;
    const Samples rows = Between(at.y - reach, at.y + reach, rows_),
                  columns = Between(at.x - reach, at.x + reach, columns_);
    for (int row = rows.begin; row < rows.end; ++row)
      for (int column = columns.begin; column < columns.end; ++column) {
        if (!filter_.Wants(column, row)) continue;
        const double distance = Length(Vec2{column + 0.5, row + 0.5} - at);
        if (distance <= reach) candidates_.push_back({row, column, distance, 0});
      }
  }

  void VisitSegment(const EdgeSegment& segment) {
    PointRoom room;
    Vec3* const p = room.points;
    for (int i = 0; i <= segment.degree; ++i) {
      p[i] = edges_.Relative(model_.edge_points[segment.first_point + static_cast<std::uint32_t>(i)], 0, 0);
      if (!(p[i].z > 0)) return;
    }
    Walk(p, segment.degree, segment.begin, segment.end, 0);
  }

  // Finds the samples near the part [begin, end] of the edge.
  void Walk(Vec3* p, int degree, double begin, double end, int halvings) {
    Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
    double weight = INFINITY, bend = 0;
    const Vec2 first{p[0].x / p[0].z, p[0].y / p[0].z};
    const Vec2 last{p[degree].x / p[degree].z, p[degree].y / p[degree].z}, chord = last - first;
    const double length = Length(chord);
    for (int i = 0; i <= degree; ++i) {
      const Vec2 at{p[i].x / p[i].z, p[i].y / p[i].z};
      low = {std::min(low.x, at.x), std::min(low.y, at.y)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y)};
      weight = std::min(weight, p[i].z);
      // Measure how far the control point is from the chord, beside it or beyond its ends.
      const Vec2 away = at - first;
      const double along = length > 0 ? std::clamp(Dot(away, chord) / (length * length), 0.0, 1.0) : 0;
      bend = std::max(bend, Length(away - along * chord));
    }
    const double reach = ReachPx(weight);
    if (!(reach >= kRoundingPx) || IsLeftVisible(reach)) return;
    const Samples rows = Between(low.y - reach, high.y + reach, rows_),
                  columns = Between(low.x - reach, high.x + reach, columns_);
    if (rows.begin == rows.end || columns.begin == columns.end) return;

    if (bend > std::max(kFlatPx, reach / 2) && halvings < kMaxHalvings) {
      PointRoom room;
      Vec3* const left = room.points;
      left[0] = p[0];
      for (int level = 1; level <= degree; ++level) {
        for (int i = 0; i <= degree - level; ++i) p[i] = 0.5 * (p[i] + p[i + 1]);
        left[level] = p[0];
      }
      const double middle = 0.5 * (begin + end);
      Walk(left, degree, begin, middle, halvings + 1);
      Walk(p, degree, middle, end, halvings + 1);
      return;
    }

    // Walk along the chord by rows or by columns, whichever it crosses more of. The distance across is then
    // at most √2 times the distance from the chord.
    const bool by_rows = std::fabs(chord.y) >= std::fabs(chord.x);
    const double across = 1.5 * (reach + bend);
    const Samples steps = by_rows ? rows : columns;
    for (int step = steps.begin; step < steps.end && !budget_->Stopped(); ++step) {
      const double run = by_rows ? chord.y : chord.x, from = by_rows ? first.y : first.x;
      const double t = run != 0 ? std::clamp((step + 0.5 - from) / run, 0.0, 1.0) : 0.5;
      const Vec2 at = first + t * chord;
      const double center = by_rows ? at.x : at.y;
      const Samples others = Between(center - across, center + across, by_rows ? columns_ : rows_);
      for (int other = others.begin; other < others.end; ++other)
        Ask(by_rows ? step : other, by_rows ? other : step, begin + t * (end - begin), reach);
    }
  }

  void Ask(int row, int column, double guess, double reach) {
    if (!filter_.Wants(column, row)) return;
    const EdgeSide side = edges_.SideOf(source_->edge, guess, column + 0.5, row + 0.5);
    if (side.side == Side::kUnknown) {
      // The image of this piece is a point; use the reach as its distance.
      candidates_.push_back({row, column, reach, guess});
    } else if (side.distance_px <= reach) {
      candidates_.push_back({row, column, side.distance_px, side.parameter});
    }
  }

  void AddUses(const Candidate& candidate) {
    std::uint32_t before = kNoIndex;
    for (const SeamTable::Use& use : Elements(table_.uses, source_->uses)) {
      // Add a face that occurs twice, at a seam or a vertex, only once.
      if (use.face == before) continue;
      before = use.face;
      const std::optional<bool> odd = Winds(use.face, candidate.column + 0.5, candidate.row + 0.5);
      if (odd) Add(candidate, use, *odd);
    }
  }

  // Returns whether the border of the face winds around the pixel an odd number of times (law 1).
  std::optional<bool> Winds(std::uint32_t face, double x, double y) const {
    const Range border = table_.border_of[face];
    if (border.count == 0) return std::nullopt;
    bool odd = false;
    for (const std::uint32_t edge : Elements(table_.edges, border)) {
      const std::optional<bool> crosses = CrossesHalfLine(edges_, edge, x, y);
      if (!crosses) return std::nullopt;
      odd ^= *crosses;
    }
    return odd;
  }

  void Add(const Candidate& candidate, const SeamTable::Use& use, bool odd) {
    const Coedge& coedge = model_.coedges[use.coedge];
    const Edge& edge = model_.edges[coedge.edge];
    double parameter = candidate.parameter;
    if (source_->vertex != kNoIndex) {
      const std::span<const EdgeSegment> segments = SegmentsOf(model_, edge);
      parameter = edge.vertices[0] == source_->vertex ? segments.front().begin : segments.back().end;
    }
    if (source_->vertex == kNoIndex) parameter = RoundedEdgeParameter(edge, parameter);
    SeamSample sample{instance_, use.face, candidate.column,      candidate.row, 0, 0, 0,
                      0,         odd,      candidate.distance_px, source_index_};
    const Vec3 point =
        model_.instances[instance_].placement.Point(EvaluateEdge(model_, edge, parameter).position);
    sample.depth = Dot(point - frame_.eye, frame_.forward);
    const Vec2 uv = EvaluateCoedge(model_, coedge, parameter);
    const Surface& surface = model_.surfaces[model_.faces[use.face].surface];
    const std::uint32_t i = SpanOf(surface.u_spans, uv.x), j = SpanOf(surface.v_spans, uv.y);
    sample.patch = i * surface.v_spans.count + j;
    sample.u = std::clamp(NativeToBezier(model_.spans[surface.u_spans.first + i], uv.x), 0.0, 1.0);
    sample.v = std::clamp(NativeToBezier(model_.spans[surface.v_spans.first + j], uv.y), 0.0, 1.0);
    found_->push_back(sample);
    budget_->bytes_left.fetch_sub(static_cast<std::int64_t>(sizeof(SeamLeaf)), std::memory_order_relaxed);
  }

  // The parameter, rounded as coarsely as the image of the point allows. If an edge runs along the ray, only
  // half of the digits of its nearest point are known, and the rays of the opposite view must find the same
  // point.
  double RoundedEdgeParameter(const Edge& edge, double parameter) const {
    const EdgeSegment& segment = SegmentAt(model_, edge, parameter);
    double length = 0, weight = INFINITY;
    Vec2 before;
    bool first = true;
    for (const Vec4& point : PointsOf(model_, segment)) {
      const Vec3 h = edges_.Relative(point, 0, 0);
      const Vec2 at{h.x / h.z, h.y / h.z};
      if (!first) length += Length(at - before);
      before = at;
      first = false;
      weight = std::min(weight, h.z);
    }
    constexpr double kShare = 1.0 / 16;  // share of the reach by which a point may move
    const double most = kShare * std::min(1.0, ReachPx(weight) / length);
    const double grid = std::ldexp(1, std::ilogb(std::clamp(most, 0x1p-40, kShare)));
    const double width = segment.end - segment.begin;
    const double t = std::floor((parameter - segment.begin) / width / grid + 0.5) * grid;
    return segment.begin + std::clamp(t, 0.0, 1.0) * width;
  }

  std::uint32_t SpanOf(Range spans, double native) const {
    std::uint32_t i = 0;
    while (i + 1 < spans.count && model_.spans[spans.first + i].end < native) ++i;
    return i;
  }

  const Model& model_;
  const SeamTable& table_;
  const CameraFrame& frame_;
  const int columns_, rows_;
  const std::uint32_t instance_;
  const bool perspective_;
  const ProjectedEdges edges_;
  const SeamSampleFilter& filter_;
  SplitBudget* const budget_;
  std::vector<SeamSample>* found_;
  const SeamTable::Source* source_ = nullptr;
  std::uint32_t source_index_ = 0;
  std::vector<Candidate> candidates_;
};

auto SampleKey(const SeamSample& s) {
  return std::tie(s.instance, s.face, s.row, s.column);
}

}  // namespace

std::vector<SeamSample> FindSeamSamples(const Model& model, const SeamTable& table, const Camera& camera,
                                        const CameraFrame& frame, SplitBudget* budget,
                                        const SeamSampleFilter& filter) {
  PerThread<std::vector<SeamSample>> found;
  ParallelFor(std::uint32_t{0}, static_cast<std::uint32_t>(model.instances.size()), [&](std::uint32_t i) {
    const Range sources = table.of_part[model.instances[i].part];
    ParallelForBlocks(sources.first, sources.end(), 16, [&](std::size_t first, std::size_t last) {
      Finder finder(model, table, camera, frame, i, filter, budget, &found.local());
      for (std::size_t s = first; s < last; ++s) finder.Visit(static_cast<std::uint32_t>(s));
    });
  });
  std::vector<SeamSample> all;
  for (const std::vector<SeamSample>& some : found) all.insert(all.end(), some.begin(), some.end());

  // Keep one sample per face and ray: the one at the nearest of the edges that the ray passes. The choice
  // must be the same for the opposite direction of the ray.
  ParallelSort(all.begin(), all.end(), [](const SeamSample& a, const SeamSample& b) {
    return std::tie(a.instance, a.face, a.row, a.column, a.distance_px, a.source) <
           std::tie(b.instance, b.face, b.row, b.column, b.distance_px, b.source);
  });
  all.erase(
      std::unique(all.begin(), all.end(),
                  [](const SeamSample& a, const SeamSample& b) { return SampleKey(a) == SampleKey(b); }),
      all.end());
  return all;
}

}  // namespace facetless
