#include "render/nurbs/surface_eval.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/model/walk.h"

namespace facetless {
namespace {

constexpr int kMaxPoints = 256;  // the degree is 8 bits wide

// Bernstein polynomials of one degree at one parameter, with derivatives.
struct Basis {
  std::array<double, kMaxPoints> value, first, second;
};

// Raises the degree of the Bernstein polynomials in `b` from d − 1 to d.
void Raise(std::array<double, kMaxPoints>& b, int d, double t) {
  b[d] = t * b[d - 1];
  for (int i = d - 1; i > 0; --i) b[i] = (1 - t) * b[i] + t * b[i - 1];
  b[0] *= 1 - t;
}

// Computes the derivatives of degree d from the values of degree d − 1: B' = d·(b[i−1] − b[i]).
void Differentiate(const std::array<double, kMaxPoints>& lower, int d, std::array<double, kMaxPoints>& out) {
  for (int i = 0; i <= d; ++i) out[i] = d * ((i > 0 ? lower[i - 1] : 0) - (i < d ? lower[i] : 0));
}

void EvaluateBasis(int degree, double t, int order, Basis& basis) {
  auto& b = basis.value;
  b[0] = 1;
  for (int d = 1; d <= degree; ++d) {
    if (order >= 2 && d == degree - 1) {
      // Differentiate the derivatives of degree − 1 once more.
      std::array<double, kMaxPoints> slope;
      Differentiate(b, d, slope);
      Differentiate(slope, degree, basis.second);
    }
    if (order >= 1 && d == degree) Differentiate(b, d, basis.first);
    Raise(b, d, t);
  }
  if (order >= 1 && degree == 0) basis.first[0] = 0;
  if (order >= 2 && degree < 2) std::fill_n(basis.second.begin(), degree + 1, 0.0);
}

Vec3 Spatial(Vec4 h) {
  return {h.x, h.y, h.z};
}

std::vector<double> Knots(const Model& model, Range spans) {
  std::vector<double> knots{model.spans[spans.first].begin};
  for (const Span& span : Elements(model.spans, spans)) knots.push_back(span.end);
  return knots;
}

std::vector<SpanParameter> Maps(const Model& model, Range spans) {
  std::vector<SpanParameter> maps;
  for (const Span& span : Elements(model.spans, spans)) maps.emplace_back(span);
  return maps;
}

// The span that contains x; the first or the last span for x outside the grid.
std::size_t FindSpanIndex(const std::vector<double>& knots, double x) {
  return static_cast<std::size_t>(std::upper_bound(knots.begin() + 1, knots.end() - 1, x) - knots.begin()) -
         1;
}

}  // namespace

SurfaceEval::SurfaceEval(const Model& model, std::uint32_t surface)
    : model_(&model),
      surface_(model.surfaces[surface]),
      u_knots_(Knots(model, surface_.u_spans)),
      v_knots_(Knots(model, surface_.v_spans)),
      u_maps_(Maps(model, surface_.u_spans)),
      v_maps_(Maps(model, surface_.v_spans)) {
  for (const Vec4& p : PointsOf(model, surface_)) {
    magnitude_ = std::max({magnitude_, std::fabs(p.x / p.w), std::fabs(p.y / p.w), std::fabs(p.z / p.w)});
  }
}

SurfacePoint SurfaceEval::Evaluate(double u, double v, int order) const {
  // Find the patch and the Bézier parameters.
  const std::size_t i = FindSpanIndex(u_knots_, u), j = FindSpanIndex(v_knots_, v);
  const double s = u_maps_[i].ToBezier(u), t = v_maps_[j].ToBezier(v);
  const int p = surface_.degree_u, q = surface_.degree_v;
  Basis bu, bv;
  EvaluateBasis(p, s, order, bu);
  EvaluateBasis(q, t, order, bv);

  // Sum the homogeneous point and its derivatives, row by row.
  const Vec4* row =
      PatchPoints(*model_, surface_, static_cast<std::uint32_t>(i * surface_.v_spans.count + j)).data();
  const Vec4 zero{0, 0, 0, 0};
  Vec4 h = zero, hu = zero, hv = zero, huu = zero, huv = zero, hvv = zero;
  for (int k = 0; k <= p; ++k, row += q + 1) {
    Vec4 r = zero, rv = zero, rvv = zero;
    for (int l = 0; l <= q; ++l) {
      r = r + bv.value[l] * row[l];
      if (order >= 1) rv = rv + bv.first[l] * row[l];
      if (order >= 2) rvv = rvv + bv.second[l] * row[l];
    }
    h = h + bu.value[k] * r;
    if (order >= 1) hu = hu + bu.first[k] * r, hv = hv + bu.value[k] * rv;
    if (order >= 2) {
      huu = huu + bu.second[k] * r;
      huv = huv + bu.first[k] * rv;
      hvv = hvv + bu.value[k] * rvv;
    }
  }

  // Quotient rule.
  SurfacePoint result;
  const double w = 1 / h.w;
  result.position = w * Spatial(h);
  if (order < 1) return result;
  const Vec3 su = w * (Spatial(hu) - hu.w * result.position);
  const Vec3 sv = w * (Spatial(hv) - hv.w * result.position);
  const double ru = u_maps_[i].Rate(s), rv = v_maps_[j].Rate(t);
  result.du = ru * su;
  result.dv = rv * sv;
  if (order < 2) return result;
  const Vec3 suu = w * (Spatial(huu) - huu.w * result.position - 2 * hu.w * su);
  const Vec3 suv = w * (Spatial(huv) - huv.w * result.position - hu.w * sv - hv.w * su);
  const Vec3 svv = w * (Spatial(hvv) - hvv.w * result.position - 2 * hv.w * sv);

  // Chain rule: from Bézier to native parameters.
  result.duu = ru * ru * suu + u_maps_[i].RateOfRate(s) * su;
  result.duv = ru * rv * suv;
  result.dvv = rv * rv * svv + v_maps_[j].RateOfRate(t) * sv;
  return result;
}

Vec3 SurfaceEval::Position(double u, double v) const {
  return Evaluate(u, v, 0).position;
}

SurfacePoint SurfaceEval::First(double u, double v) const {
  return Evaluate(u, v, 1);
}

SurfacePoint SurfaceEval::Second(double u, double v) const {
  return Evaluate(u, v, 2);
}

}  // namespace facetless
