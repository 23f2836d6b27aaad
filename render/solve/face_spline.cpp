#include "render/solve/face_spline.h"

#include <algorithm>

namespace facetless {
namespace {

// The shares of de Boor's algorithm: level r = 1 … degree, and within it entry j = r … degree.
class Shares {
 public:
  // `knots`: the first of the 2·degree knots around the span that holds t.
  Shares(const double* knots, int degree, double t) {
    double* out = shares_.data();
    for (int r = 1; r <= degree; ++r)
      for (int j = r; j <= degree; ++j) *out++ = (t - knots[j - 1]) / (knots[j + degree - r] - knots[j - 1]);
  }

  // Replaces the control points by those of the last level but one, which are entries degree − 1 and degree. Returns
  // the share of the last level.
  template <typename Point>
  double Run(Point* points, int degree) const {
    const double* share = shares_.data();
    for (int r = 1; r < degree; ++r, share += degree - r + 1) {
      for (int j = degree; j >= r; --j) {
        const double a = share[j - r];
        for (std::size_t c = 0; c < points[j].size(); ++c)
          points[j][c] = (1 - a) * points[j - 1][c] + a * points[j][c];
      }
    }
    return *share;
  }

 private:
  std::array<double, kMaxDegree*(kMaxDegree + 1) / 2> shares_;
};

}  // namespace

FaceSpline::FaceSpline(const SolverScene& scene, const SolverFace& face) : scene_(scene), face_(face) {
  for (const bool along_u : {true, false}) {
    Axis& axis = along_u ? u_ : v_;
    axis.spans = along_u ? face.columns : face.rows;
    for (std::uint64_t k = 0; k < std::uint64_t{face.columns} * face.rows; ++k) {
      const std::uint32_t patch = scene.PatchAt(face, static_cast<std::uint32_t>(k / face.rows),
                                                static_cast<std::uint32_t>(k % face.rows));
      if (patch == kNoIndex) continue;
      axis.degree = along_u ? scene.patches()[patch].degree_u : scene.patches()[patch].degree_v;
      break;
    }
    const std::vector<double> breaks = scene.NativeBreaks(face, along_u);
    const double scale = axis.spans / (breaks.back() - breaks.front());
    for (std::size_t k = 0; k < breaks.size(); ++k) {
      const bool end = k == 0 || k + 1 == breaks.size();
      const double knot = k + 1 == breaks.size() ? axis.spans : scale * (breaks[k] - breaks.front());
      axis.knots.insert(axis.knots.end(), static_cast<std::size_t>(axis.degree + end), knot);
    }
  }
}

double FaceSpline::Axis::FromFace(double parameter) const {
  const double at = std::clamp(parameter, 0.0, double(spans));
  const std::uint32_t span = std::min(static_cast<std::uint32_t>(at), spans - 1);
  return Break(span) + (at - span) * (Break(span + 1) - Break(span));
}

double FaceSpline::Axis::InSpan(double s, std::uint32_t span) const {
  return std::clamp((s - Break(span)) / (Break(span + 1) - Break(span)), 0.0, 1.0);
}

bool FaceSpline::Axis::Find(double s, std::uint32_t* span) const {
  if (!(s >= 0 && s <= spans)) return false;
  std::uint32_t low = 0, high = spans;
  while (high - low > 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    (s < Break(middle) ? high : low) = middle;
  }
  *span = low;
  return true;
}

bool FaceSpline::Locate(double s, double t, Place* place, bool* inside) const {
  place->s = s;
  place->t = t;
  const bool found = u_.Find(s, &place->i) && v_.Find(t, &place->j);
  if (inside != nullptr) *inside = found;
  if (!found) return false;
  place->patch = scene_.PatchAt(face_, place->i, place->j);
  return place->patch != kNoIndex;
}

// De Boor's algorithm along v for each row of the control points, and then along u. Since inner knots occur as often as the
// degree says, the control points of a span are those of its patch.
template <bool kJet>
PatchJet<3> FaceSpline::Evaluate(const Place& place) const {
  const SolverPatch& patch = scene_.patches()[place.patch];
  const ViewProjection::Point* points = scene_.screen(patch);
  const int du = u_.degree, dv = v_.degree;
  // The knots around span i begin one after the first of the degree + 1 (or degree) equal ones.
  const double* const knots_u = u_.knots.data() + static_cast<std::size_t>(du) * place.i + 1;
  const double* const knots_v = v_.knots.data() + static_cast<std::size_t>(dv) * place.j + 1;
  const Shares in_u(knots_u, du, place.s), in_v(knots_v, dv, place.t);
  // With derivatives, a point has three more numbers, which are its derivative along v.
  using Point = std::array<double, kJet ? 6 : 3>;
  std::array<Point, kMaxDegree + 1> column;
  std::array<std::array<double, 3>, kMaxDegree + 1> row;
  const double slope_v = dv / (knots_v[dv] - knots_v[dv - 1]), slope_u = du / (knots_u[du] - knots_u[du - 1]);
  for (int k = 0; k <= du; ++k) {
    for (int l = 0; l <= dv; ++l, ++points)
      row[static_cast<std::size_t>(l)] = {points->x, points->y, points->w};
    const double share = in_v.Run(row.data(), dv);
    const auto &a = row[static_cast<std::size_t>(dv - 1)], &b = row[static_cast<std::size_t>(dv)];
    Point& out = column[static_cast<std::size_t>(k)];
    for (std::size_t c = 0; c < 3; ++c) {
      out[c] = (1 - share) * a[c] + share * b[c];
      if constexpr (kJet) out[3 + c] = slope_v * (b[c] - a[c]);
    }
  }
  const double share = in_u.Run(column.data(), du);
  const Point &a = column[static_cast<std::size_t>(du - 1)], &b = column[static_cast<std::size_t>(du)];
  PatchJet<3> jet;
  for (std::size_t c = 0; c < 3; ++c) {
    jet.value[c] = (1 - share) * a[c] + share * b[c];
    if constexpr (kJet) {
      jet.du[c] = slope_u * (b[c] - a[c]);
      jet.dv[c] = (1 - share) * a[3 + c] + share * b[3 + c];
    }
  }
  return jet;
}

PatchJet<3> FaceSpline::Jet(const Place& place) const {
  return Evaluate<true>(place);
}

PatchJet<3> FaceSpline::Value(const Place& place) const {
  return Evaluate<false>(place);
}

}  // namespace facetless
