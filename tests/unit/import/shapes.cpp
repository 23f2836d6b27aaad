#include "tests/unit/import/shapes.h"

#include <algorithm>
#include <cmath>

#include "import/assembly.h"
#include "import/bezier_pieces.h"
#include "import/readers.h"
#include "import/source_file.h"
#include "render/model/walk.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

// Nodes and weights of five-point Gauss-Legendre quadrature on [−1, 1].
constexpr double kNodes[] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                             0.9061798459386640};
constexpr double kWeights[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                               0.2369268850561891};
// The number of straight steps that replace a curved segment. A circle of four segments then loses 1.8e-4 of
// its area.
constexpr int kSteps = 48;

struct Segment {
  Vec2 from, to;
};

std::vector<Segment> Polygon(const Model& model, const Face& face) {
  std::vector<Segment> polygon;
  for (const Coedge& coedge : CoedgesOf(model, face)) {
    for (const TrimSegment& segment : SegmentsOf(model, coedge)) {
      std::vector<Vec4> points;
      for (const Vec3& p : PointsOf(model, segment)) points.push_back({p.x, p.y, 0, p.z});
      const int steps = segment.degree == 1 ? 1 : kSteps;
      Vec3 before = Cartesian(points.front());
      for (int i = 1; i <= steps; ++i) {
        const Vec3 at = Cartesian(EvaluateBezier(points, static_cast<double>(i) / steps));
        polygon.push_back({{before.x, before.y}, {at.x, at.y}});
        before = at;
      }
    }
  }
  return polygon;
}

std::vector<double> Borders(const Model& model, Range spans) {
  std::vector<double> borders{model.spans[spans.first].begin};
  for (const Span& span : Elements(model.spans, spans)) borders.push_back(span.end);
  return borders;
}

class Evaluator {
 public:
  Evaluator(const Model& model, const Surface& surface) : model_(model), surface_(surface) {}

  Vec3 Point(double u, double v) const {
    const std::uint32_t i = Find(surface_.u_spans, u), j = Find(surface_.v_spans, v);
    const Span &a = model_.spans[surface_.u_spans.first + i], &b = model_.spans[surface_.v_spans.first + j];
    const std::size_t row = surface_.degree_v + 1u;
    const Vec4* patch = PatchPoints(model_, surface_, i * surface_.v_spans.count + j).data();
    std::vector<Vec4> column(surface_.degree_u + 1u);
    const double t = PieceParameter(b.begin, b.end, b.map, v);
    for (std::size_t k = 0; k < column.size(); ++k) column[k] = EvaluateBezier({patch + k * row, row}, t);
    return Cartesian(EvaluateBezier(column, PieceParameter(a.begin, a.end, a.map, u)));
  }

 private:
  std::uint32_t Find(Range spans, double native) const {
    std::uint32_t i = 0;
    while (i + 1 < spans.count && native > model_.spans[spans.first + i].end) ++i;
    return i;
  }

  const Model& model_;
  const Surface& surface_;
};

}  // namespace

Result<Conversion> ConvertShape(const TopoDS_Shape& shape) {
  CadDocument document;
  AddShape(shape, "shape", document);
  return Convert(std::move(document), [](double) {});
}

Result<Conversion> ConvertFile(const std::string& path) {
  const TemporaryFolder scratch;
  PrepareOpenCascade(scratch.path());
  Result<SourceFile> source = OpenSource(path, scratch.path());
  if (!source.ok()) return source.error();
  Result<CadDocument> document = ReadDocument(source.value(), [](const char*, double) {});
  if (!document.ok()) return document.error();
  return Convert(std::move(document.value()), [](double) {});
}

double SignedArea(const FaceLoops& loops) {
  double area = 0;
  for (const FaceLoop& loop : loops.loops) {
    for (const LoopCoedge& coedge : loop.coedges) {
      for (const LoopSegment& segment : coedge.segments) {
        Vec3 before = Cartesian(segment.points.front());
        for (int i = 1; i <= 64; ++i) {
          const Vec3 at = Cartesian(EvaluateBezier(segment.points, i / 64.0));
          area += before.x * at.y - before.y * at.x;
          before = at;
        }
      }
    }
  }
  return area;
}

double TrimmedArea(const Model& model, std::uint32_t index) {
  const Face& face = model.faces[index];
  const Surface& surface = model.surfaces[face.surface];
  const Evaluator evaluator(model, surface);
  std::vector<double> u_borders = Borders(model, surface.u_spans);
  const std::vector<double> v_borders = Borders(model, surface.v_spans);
  const double du = 1e-5 * (u_borders.back() - u_borders.front()),
               dv = 1e-5 * (v_borders.back() - v_borders.front());
  std::vector<Segment> polygon = Polygon(model, face);
  if (polygon.empty()) {
    const Vec2 a{u_borders.front(), v_borders.front()}, b{u_borders.back(), v_borders.front()};
    const Vec2 c{u_borders.back(), v_borders.back()}, d{u_borders.front(), v_borders.back()};
    polygon = {{a, b}, {b, c}, {c, d}, {d, a}};
  }
  double low = INFINITY, high = -INFINITY;
  for (const Segment& s : polygon) {
    low = std::min({low, s.from.x, s.to.x});
    high = std::max({high, s.from.x, s.to.x});
    u_borders.push_back(s.from.x);
  }
  std::sort(u_borders.begin(), u_borders.end());
  // Integrate strips of u, each along v between pairs of crossings.
  double area = 0;
  for (std::size_t k = 0; k + 1 < u_borders.size(); ++k) {
    const double begin = std::max(u_borders[k], low), end = std::min(u_borders[k + 1], high);
    if (!(end - begin > 1e-12 * (high - low))) continue;
    const int strips = std::max(1, static_cast<int>(std::ceil((end - begin) / (high - low) * 4)));
    for (int strip = 0; strip < strips; ++strip) {
      const double width = (end - begin) / strips, middle = begin + (strip + 0.5) * width;
      for (int g = 0; g < 5; ++g) {
        const double u = middle + 0.5 * width * kNodes[g];
        std::vector<double> crossings;
        for (const Segment& s : polygon) {
          if ((s.from.x <= u) != (s.to.x <= u))
            crossings.push_back(s.from.y + (s.to.y - s.from.y) * (u - s.from.x) / (s.to.x - s.from.x));
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
          std::vector<double> stops{crossings[i]};
          for (double border : v_borders) {
            if (border > crossings[i] && border < crossings[i + 1]) stops.push_back(border);
          }
          stops.push_back(crossings[i + 1]);
          for (std::size_t m = 0; m + 1 < stops.size(); ++m) {
            for (int h = 0; h < 5; ++h) {
              const double length = stops[m + 1] - stops[m],
                           v = 0.5 * (stops[m] + stops[m + 1]) + 0.5 * length * kNodes[h];
              const Vec3 along_u = (1 / (2 * du)) * (evaluator.Point(u + du, v) - evaluator.Point(u - du, v));
              const Vec3 along_v = (1 / (2 * dv)) * (evaluator.Point(u, v + dv) - evaluator.Point(u, v - dv));
              area += 0.25 * width * length * kWeights[g] * kWeights[h] * Length(Cross(along_u, along_v));
            }
          }
        }
      }
    }
  }
  return area;
}

}  // namespace facetless
