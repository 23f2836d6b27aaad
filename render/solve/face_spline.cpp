#include "render/solve/face_spline.h"

#include <algorithm>

namespace facetless {
namespace {

// The B-spline basis functions that are not zero in a span, and their derivatives, by the recursion of Cox and de Boor.
struct SplineBasis {
  std::array<double, kMaxDegree + 1> value, slope;

  // `knots`: the 2·degree knots around the span that holds t. `reciprocals`: of that span.
  SplineBasis(const double* knots, const double* reciprocals, int degree, double t) {
    value[0] = 1;
    for (int d = 1; d <= degree; ++d) {
      // The last level gives the slopes, too: degree times the differences of what is multiplied by t.
      double before = 0, share_before = 0;
      for (int r = 0; r < d; ++r) {
        const double share = value[r] * *reciprocals++;
        if (d == degree) slope[r] = degree * (share_before - share);
        value[r] = before + (knots[degree + r] - t) * share;
        before = (t - knots[degree - d + r]) * share;
        share_before = share;
      }
      value[d] = before;
      if (d == degree) slope[d] = degree * share_before;
    }
  }
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
    for (std::uint32_t span = 0; span < axis.spans; ++span) {
      const double* around = axis.Around(span);
      for (int d = 1; d <= axis.degree; ++d)
        for (int r = 0; r < d; ++r)
          axis.reciprocals.push_back(1 / (around[axis.degree + r] - around[axis.degree - d + r]));
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
  // With even spans, this is the answer.
  const std::uint32_t likely = std::min(static_cast<std::uint32_t>(s), spans - 1);
  if (s >= Break(likely) && s < Break(likely + 1)) {
    *span = likely;
    return true;
  }
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

// Since inner knots occur as often as the degree says, the control points of a span are those of its patch.
template <bool kJet>
PatchJet<3> FaceSpline::Evaluate(const Place& place) const {
  const SolverPatch& patch = scene_.patches()[place.patch];
  const double* point = &scene_.screen(patch)->x;
  const SplineBasis in_u(u_.Around(place.i), u_.reciprocals.data() + u_.shares() * place.i, u_.degree,
                         place.s),
      in_v(v_.Around(place.j), v_.reciprocals.data() + v_.shares() * place.j, v_.degree, place.t);
  PatchJet<3> jet;
  for (int k = 0; k <= u_.degree; ++k) {
    std::array<double, 3> row{}, row_slope{};
    for (int l = 0; l <= v_.degree; ++l, point += 4)
      for (int c = 0; c < 3; ++c) {
        row[c] += in_v.value[l] * point[c];
        if constexpr (kJet) row_slope[c] += in_v.slope[l] * point[c];
      }
    for (int c = 0; c < 3; ++c) {
      jet.value[c] += in_u.value[k] * row[c];
      if constexpr (kJet) {
        jet.du[c] += in_u.slope[k] * row[c];
        jet.dv[c] += in_u.value[k] * row_slope[c];
      }
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
