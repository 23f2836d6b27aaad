#include "import/face_loops.h"

#include <BRep_Tool.hxx>
#include <Geom_ConicalSurface.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "import/pcurve.h"

namespace facetless {
namespace {

// Ends that are closer than this, relative to the loop's size, differ only by rounding and are made equal.
constexpr double kSnap = 64 * std::numeric_limits<double>::epsilon();

// Invented lines may make up at most this share of a loop's length.
constexpr double kMostInvented = 0.5;

// If a face's edges lie farther off its surface than this share of its longest loop, the surface is the wrong
// one: it was read in another unit, or it belongs to another face. The share is about a tenth of the diameter
// of a circle of that length.
constexpr double kFarOff = 0.03;

// Loops whose area is less than this share of their box enclose nothing: edges that are followed forwards and
// backwards leave only rounding. A sliver that is a nanometre wide and a metre long has a hundred times as
// much area.
constexpr double kNoArea = 1e-11;

struct Period {
  double u = 0, v = 0;
};

// Evaluates points of the face's surface, for lengths in millimetres.
struct SurfacePoints {
  const Handle(Geom_Surface) & surface;
  double scale = 1;

  double Distance(Vec2 a, Vec2 b) const {
    return scale * surface->Value(a.x, a.y).Distance(surface->Value(b.x, b.y));
  }
};

// A use of an edge, before its position in a loop is known.
struct Use {
  LoopCoedge coedge;
  TopoDS_Vertex start, end;
};

Vec2 Point(const Vec4& p) {
  return {p.x / p.w, p.y / p.w};
}
Vec2 Start(const LoopCoedge& coedge) {
  return Point(coedge.segments.front().points.front());
}
Vec2 End(const LoopCoedge& coedge) {
  return Point(coedge.segments.back().points.back());
}
Vec2 Start(const FaceLoop& loop) {
  return Start(loop.coedges.front());
}
Vec2 End(const FaceLoop& loop) {
  return End(loop.coedges.back());
}

void Shift(LoopCoedge& coedge, Vec2 by) {
  if (by.x == 0 && by.y == 0) return;
  for (LoopSegment& segment : coedge.segments) {
    for (Vec4& p : segment.points) {
      p.x += p.w * by.x;
      p.y += p.w * by.y;
    }
  }
}

void Shift(FaceLoop& loop, Vec2 by) {
  for (LoopCoedge& coedge : loop.coedges) Shift(coedge, by);
}

// Returns the multiple of the period that is nearest to `distance`.
double WholePeriods(double distance, double period) {
  return period > 0 ? std::round(distance / period) * period : 0;
}

Use MakeUse(const TopoDS_Edge& edge, Pcurve pcurve) {
  Use use;
  use.coedge.edge = edge;
  use.coedge.reversed = edge.Orientation() == TopAbs_REVERSED;
  use.coedge.from_file = pcurve.from_file;
  use.coedge.degenerate = BRep_Tool::Degenerated(edge);
  use.coedge.gap_mm = pcurve.gap_mm;
  for (CurvePiece& piece : pcurve.pieces)
    use.coedge.segments.push_back({std::move(piece.points), piece.begin, piece.end});
  if (use.coedge.reversed) {
    std::reverse(use.coedge.segments.begin(), use.coedge.segments.end());
    for (LoopSegment& segment : use.coedge.segments) {
      std::reverse(segment.points.begin(), segment.points.end());
      std::swap(segment.edge_begin, segment.edge_end);
    }
  }
  use.start = TopExp::FirstVertex(edge, true);
  use.end = TopExp::LastVertex(edge, true);
  return use;
}

bool Linked(const Use& from, const Use& to) {
  return !from.end.IsNull() && !to.start.IsNull() && from.end.IsSame(to.start);
}

bool InOrder(const std::vector<Use>& uses) {
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (!Linked(uses[i], uses[(i + 1) % uses.size()])) return false;
  }
  return true;
}

FaceLoop LoopFrom(std::vector<Use> uses) {
  FaceLoop loop;
  for (Use& use : uses) loop.coedges.push_back(std::move(use.coedge));
  return loop;
}

// Puts the uses of one wire in order. The given order is kept if the vertices agree. Otherwise, each use is
// followed by one that starts at its last vertex, or, if several or none do, by the one with the nearest
// start.
std::vector<FaceLoop> Chained(std::vector<Use> uses) {
  std::vector<FaceLoop> loops;
  if (InOrder(uses)) {
    loops.push_back(LoopFrom(std::move(uses)));
    return loops;
  }
  while (!uses.empty()) {
    std::vector<Use> chain{std::move(uses.front())};
    uses.erase(uses.begin());
    while (!uses.empty()) {
      const Vec2 end = End(chain.back().coedge);
      const bool closed = Linked(chain.back(), chain.front());
      std::size_t next = uses.size();
      bool next_linked = false;
      double next_distance = INFINITY;
      for (std::size_t i = 0; i < uses.size(); ++i) {
        const bool linked = Linked(chain.back(), uses[i]);
        const double distance = Length(Start(uses[i].coedge) - end);
        if (linked > next_linked || (linked == next_linked && distance < next_distance)) {
          next = i;
          next_linked = linked;
          next_distance = distance;
        }
      }
      // A chain that is closed continues only with a use that fits its end better than its own start does.
      if (closed && (!next_linked || Length(Start(chain.front().coedge) - end) <= next_distance)) break;
      if (next == uses.size()) break;
      chain.push_back(std::move(uses[next]));
      uses.erase(uses.begin() + static_cast<std::ptrdiff_t>(next));
    }
    loops.push_back(LoopFrom(std::move(chain)));
  }
  return loops;
}

// Moves each coedge by whole periods to the end of the coedge before it.
void Unwrap(FaceLoop& loop, const Period& period) {
  for (std::size_t i = 1; i < loop.coedges.size(); ++i) {
    const Vec2 gap = End(loop.coedges[i - 1]) - Start(loop.coedges[i]);
    Shift(loop.coedges[i], {WholePeriods(gap.x, period.u), WholePeriods(gap.y, period.v)});
  }
}

// Returns by how many periods the loop advances in one turn.
Vec2 Winding(const FaceLoop& loop, const Period& period) {
  const Vec2 gap = End(loop) - Start(loop);
  return {WholePeriods(gap.x, period.u), WholePeriods(gap.y, period.v)};
}

LoopCoedge Connector(Vec2 from, Vec2 to) {
  LoopCoedge coedge;
  coedge.segments.push_back({{{from.x, from.y, 0, 1}, {to.x, to.y, 0, 1}}, 0, 0});
  return coedge;
}

void Append(FaceLoop& loop, std::vector<LoopCoedge> coedges) {
  for (LoopCoedge& coedge : coedges) loop.coedges.push_back(std::move(coedge));
}

// The parameters v at which the surface ends in a pole; infinite if it does not.
struct Poles {
  double low = -INFINITY, high = INFINITY;
};

Poles PolesOf(const Handle(Geom_Surface) & surface) {
  Poles poles;
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(surface); !cone.IsNull()) {
    const double apex = -cone->RefRadius() / std::sin(cone->SemiAngle());
    (cone->SemiAngle() > 0 ? poles.low : poles.high) = apex;
    return poles;
  }
  if (!Precision::IsInfinite(v0)) poles.low = v0;
  if (!Precision::IsInfinite(v1)) poles.high = v1;
  return poles;
}

// Treats loops that wind around the surface, which enclose no area in the parameter plane: it joins two of
// them by a cut, or closes one through the pole on the side of its material.
bool JoinWindingLoops(std::vector<FaceLoop>& loops, const Period& period, const Poles& poles,
                      std::vector<std::string>& joins) {
  std::vector<FaceLoop> closed, winding;
  for (FaceLoop& loop : loops) {
    const Vec2 turns = Winding(loop, period);
    (turns.x == 0 && turns.y == 0 ? closed : winding).push_back(std::move(loop));
  }
  while (!winding.empty()) {
    FaceLoop loop = std::move(winding.back());
    winding.pop_back();
    const Vec2 turn = Winding(loop, period);
    const auto partner = std::find_if(winding.begin(), winding.end(), [&](const FaceLoop& other) {
      const Vec2 opposite = Winding(other, period);
      return opposite.x == -turn.x && opposite.y == -turn.y;
    });
    const Vec2 start = Start(loop);
    if (partner != winding.end()) {
      // Cut along a line from one loop to the other, and back one turn earlier.
      FaceLoop other = std::move(*partner);
      winding.erase(partner);
      const Vec2 gap = End(loop) - Start(other);
      Shift(other, {WholePeriods(gap.x, period.u), WholePeriods(gap.y, period.v)});
      const Vec2 other_start = Start(other), other_end = other_start - turn;
      Append(loop, {Connector(End(loop), other_start)});
      Append(loop, std::move(other.coedges));
      Append(loop, {Connector(other_end, start)});
      joins.push_back("a cut was made between two bounds that go around the surface");
    } else {
      // The material is on the left: on the side of higher v if the loop runs in the direction of growing u.
      const double pole = turn.x > 0 ? poles.high : poles.low;
      if (turn.y != 0 || !std::isfinite(pole)) return false;
      const Vec2 end = End(loop);
      Append(loop, {Connector(end, {end.x, pole}), Connector({end.x, pole}, {start.x, pole}),
                    Connector({start.x, pole}, start)});
      joins.push_back("a bound that goes around the surface was closed through its pole");
    }
    closed.push_back(std::move(loop));
  }
  loops = std::move(closed);
  return true;
}

void Grow(ParameterBox& box, const FaceLoop& loop) {
  for (const LoopCoedge& coedge : loop.coedges) {
    for (const LoopSegment& segment : coedge.segments) {
      for (const Vec4& p : segment.points) {
        const Vec2 uv = Point(p);
        box = {std::min(box.u0, uv.x), std::max(box.u1, uv.x), std::min(box.v0, uv.y),
               std::max(box.v1, uv.y)};
      }
    }
  }
}

ParameterBox BoxOf(const std::vector<FaceLoop>& loops) {
  ParameterBox box{INFINITY, -INFINITY, INFINITY, -INFINITY};
  for (const FaceLoop& loop : loops) Grow(box, loop);
  return box;
}

// Returns twice the signed area of the polygon through points of the loop's segments.
double TwiceArea(const FaceLoop& loop) {
  constexpr int kSamples = 4;
  const Vec2 origin = Start(loop);
  double area = 0;
  Vec2 before{};
  for (const LoopCoedge& coedge : loop.coedges) {
    for (const LoopSegment& segment : coedge.segments) {
      for (int i = 0; i <= kSamples; ++i) {
        const Vec2 at = Point(EvaluateBezier(segment.points, static_cast<double>(i) / kSamples)) - origin;
        area += Cross(before, at);
        before = at;
      }
    }
  }
  return area;
}

void Reverse(FaceLoop& loop) {
  std::reverse(loop.coedges.begin(), loop.coedges.end());
  for (LoopCoedge& coedge : loop.coedges) {
    coedge.reversed = !coedge.reversed;
    std::reverse(coedge.segments.begin(), coedge.segments.end());
    for (LoopSegment& segment : coedge.segments) {
      std::reverse(segment.points.begin(), segment.points.end());
      std::swap(segment.edge_begin, segment.edge_end);
    }
  }
}

// Moves inner loops by whole periods into the box of the outermost loop, which is the one with the largest
// area.
void Gather(std::vector<FaceLoop>& loops, const Period& period) {
  if (loops.size() < 2 || (period.u == 0 && period.v == 0)) return;
  const auto outer = std::max_element(loops.begin(), loops.end(), [](const FaceLoop& a, const FaceLoop& b) {
    return std::fabs(TwiceArea(a)) < std::fabs(TwiceArea(b));
  });
  const ParameterBox frame = BoxOf({*outer});
  for (FaceLoop& loop : loops) {
    if (&loop == &*outer) continue;
    const ParameterBox box = BoxOf({loop});
    // Do not move a loop whose centre is already inside.
    const double u = 0.5 * (box.u0 + box.u1), v = 0.5 * (box.v0 + box.v1);
    Vec2 by{};
    if (u < frame.u0 || u > frame.u1) by.x = WholePeriods(0.5 * (frame.u0 + frame.u1) - u, period.u);
    if (v < frame.v0 || v > frame.v1) by.y = WholePeriods(0.5 * (frame.v0 + frame.v1) - v, period.v);
    Shift(loop, by);
  }
}

// The lengths of the lines that close a loop, in millimetres.
struct Opening {
  double longest = 0, all = 0;
};

// Makes consecutive ends equal: bit by bit if they differ only by rounding, with a straight segment if the
// file leaves a gap.
Opening Close(FaceLoop& loop, double size, const SurfacePoints& points) {
  Opening opening;
  const auto link = [&](const Vec2& end, LoopCoedge& next, std::size_t index) {
    LoopSegment& segment = next.segments[index];
    Vec4& first = segment.points.front();
    const Vec2 gap = Point(first) - end;
    if (gap.x == 0 && gap.y == 0) return false;
    if (std::fabs(gap.x) <= kSnap * size && std::fabs(gap.y) <= kSnap * size) {
      first.x = end.x * first.w;
      first.y = end.y * first.w;
      return false;
    }
    const Vec2 start = Point(first);
    const double length = points.Distance(end, start);
    opening.longest = std::fmax(opening.longest, length);
    opening.all += length;
    LoopSegment connector{
        {{end.x, end.y, 0, 1}, {start.x, start.y, 0, 1}}, segment.edge_begin, segment.edge_begin};
    next.segments.insert(next.segments.begin() + static_cast<std::ptrdiff_t>(index), std::move(connector));
    return true;
  };
  Vec2 end = End(loop);
  for (LoopCoedge& coedge : loop.coedges) {
    for (std::size_t i = 0; i < coedge.segments.size(); ++i) {
      if (link(end, coedge, i)) ++i;
      end = Point(coedge.segments[i].points.back());
    }
  }
  return opening;
}

// Returns the length of a loop's edges in millimetres, measured along polygons through points of its
// segments.
double LengthOf(const FaceLoop& loop, const SurfacePoints& points) {
  constexpr int kSamples = 4;
  double length = 0;
  for (const LoopCoedge& coedge : loop.coedges) {
    for (const LoopSegment& segment : coedge.segments) {
      Vec2 before = Point(segment.points.front());
      for (int i = 1; i <= kSamples; ++i) {
        const Vec2 at = Point(EvaluateBezier(segment.points, static_cast<double>(i) / kSamples));
        length += points.Distance(before, at);
        before = at;
      }
    }
  }
  return length;
}

std::string Millimetres(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.3g mm", value);
  return text;
}

}  // namespace

Result<FaceLoops> LoopsOf(const TopoDS_Face& oriented, bool pcurves_in_file, MissingPcurve missing) {
  const TopoDS_Face face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = Untrimmed(BRep_Tool::Surface(face, location));
  const Period period{surface->IsUPeriodic() ? surface->UPeriod() : 0,
                      surface->IsVPeriodic() ? surface->VPeriod() : 0};
  FaceLoops result;
  // Collect the edge uses of each wire and chain them.
  for (TopoDS_Iterator wires(face); wires.More(); wires.Next()) {
    if (wires.Value().ShapeType() != TopAbs_WIRE) continue;
    std::vector<Use> uses;
    for (TopoDS_Iterator edges(wires.Value()); edges.More(); edges.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(edges.Value());
      if (edge.Orientation() != TopAbs_FORWARD && edge.Orientation() != TopAbs_REVERSED) continue;
      Result<Pcurve> pcurve = MakePcurve(edge, face, pcurves_in_file, missing);
      if (pcurve.ok()) {
        uses.push_back(MakeUse(edge, std::move(pcurve.value())));
      } else if (missing == MissingPcurve::kByOpenCascade || !BRep_Tool::Degenerated(edge)) {
        // A pole that the file declares by a vertex alone has nothing to project. A loop around it is closed
        // there.
        result.lost_edges.push_back(edge);
      }
    }
    if (uses.empty()) continue;
    if (wires.Value().Orientation() == TopAbs_REVERSED) std::reverse(uses.begin(), uses.end());
    for (FaceLoop& loop : Chained(std::move(uses))) result.loops.push_back(std::move(loop));
  }
  if (result.loops.empty()) {
    if (result.lost_edges.empty()) return result;
    return Error{ErrorCode::kFormatBroken, "none of its edges has a curve on the surface"};
  }
  // Unwrap the loops, join those that wind around the surface, move all into one period, and close them.
  for (FaceLoop& loop : result.loops) Unwrap(loop, period);
  if (!JoinWindingLoops(result.loops, period, PolesOf(surface), result.joins))
    return Error{ErrorCode::kFormatBroken, "a bound goes around the surface and nothing closes it"};
  Gather(result.loops, period);
  // The material is on the left, so the loops together must enclose a positive area.
  double area = 0;
  for (const FaceLoop& loop : result.loops) area += TwiceArea(loop);
  if (area < 0) {
    for (FaceLoop& loop : result.loops) Reverse(loop);
    result.repairs.push_back("its bounds ran the wrong way around and were reversed");
  }
  result.box = BoxOf(result.loops);
  const double size = std::max({std::fabs(result.box.u0), std::fabs(result.box.u1), std::fabs(result.box.v0),
                                std::fabs(result.box.v1)});
  const SurfacePoints points{surface, std::fabs(location.Transformation().ScaleFactor())};
  double longest = 0, gap = 0;
  for (std::size_t i = 0; i < result.loops.size(); ++i) {
    // Measure the file's edges before anything is invented.
    const double length = LengthOf(result.loops[i], points);
    longest = std::fmax(longest, length);
    for (const LoopCoedge& coedge : result.loops[i].coedges) gap = std::fmax(gap, coedge.gap_mm);
    const Opening opening = Close(result.loops[i], size, points);
    if (opening.longest > result.open_mm) {
      result.open_mm = opening.longest;
      result.open_loop = i;
      result.open_share = opening.longest / length;
    }
    if (!(opening.all <= kMostInvented * length))
      return Error{ErrorCode::kFormatBroken, "its loop " + std::to_string(i + 1) + " of " +
                                                 std::to_string(result.loops.size()) +
                                                 " does not close: the ends of its edges are up to " +
                                                 Millimetres(opening.longest) + " apart"};
  }
  if (!(std::fabs(area) > kNoArea * (result.box.u1 - result.box.u0) * (result.box.v1 - result.box.v0)))
    return Error{ErrorCode::kFormatBroken, "its loops enclose no area"};
  if (gap > kFarOff * longest)
    return Error{ErrorCode::kFormatBroken, "one of its edges lies " + Millimetres(gap) + " off its surface"};
  return result;
}

}  // namespace facetless
