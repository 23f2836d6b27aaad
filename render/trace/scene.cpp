#include "render/trace/scene.h"

#include <algorithm>
#include <cmath>

#include "render/base/parallel.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

// Patches are continued by this many gaps. A ray that passes an edge within its gap meets the surface within
// gap/cosine of it, so this is sufficient for all rays except the most grazing ones.
constexpr double kContinueGaps = 8;
// No patch is continued by more than this share of its Bézier parameter, within which extrapolation is
// stable.
constexpr double kMaxContinued = 1.0 / 8;

Vec3 Cartesian(const Vec4& p) {
  return {p.x / p.w, p.y / p.w, p.z / p.w};
}

struct Border {
  bool across_u, high;
};

// The amount, in Bézier parameters, by which the patches at a border are continued beyond it. It follows from
// the lowest speed across the border, given by the first differences of control points. A collapsed border is
// not continued.
double ContinueBy(const Model& model, const Surface& surface, Border border, double reach_mm) {
  const int pu = surface.degree_u, pv = surface.degree_v, stride = pv + 1;
  const std::uint32_t nu = surface.u_spans.count, nv = surface.v_spans.count;
  const int degree = border.across_u ? pu : pv, last = border.across_u ? pv : pu;
  const int outer = border.high ? degree : 0, inner = border.high ? degree - 1 : 1;
  double slowest = INFINITY, ratio = 1;
  for (std::uint32_t n = 0; n < (border.across_u ? nv : nu); ++n) {
    const std::uint32_t edge = border.high ? (border.across_u ? nu : nv) - 1 : 0;
    const std::uint32_t patch = border.across_u ? edge * nv + n : n * nv + edge;
    const std::span<const Vec4> points = PatchPoints(model, surface, patch);
    for (int k = 0; k <= last; ++k) {
      const Vec4& on = points[border.across_u ? outer * stride + k : k * stride + outer];
      const Vec4& off = points[border.across_u ? inner * stride + k : k * stride + inner];
      slowest = std::min(slowest, degree * Length(Cartesian(on) - Cartesian(off)));
    }
    for (std::uint32_t i = 0; i < surface.PointsPerPatch(); ++i)
      for (std::uint32_t k = 0; k < i; ++k)
        ratio = std::max({ratio, points[i].w / points[k].w, points[k].w / points[i].w});
  }
  // Keep the weights positive: extrapolation by e changes them by less than (1 + 2e)^degree − 1 of the
  // largest.
  const double tame = std::min(kMaxContinued, 1 / (4 * degree * ratio));
  return slowest > 0 ? std::min(tame, reach_mm / slowest) : 0;
}

FaceData MakeFaceData(const Model& model, std::uint32_t index) {
  const Face& face = model.faces[index];
  const Surface& surface = model.surfaces[face.surface];
  FaceData data{FaceTrim::Build(model, index), {}, {}, {}};
  for (const Vec4& p : PointsOf(model, surface)) data.bounds.Add(Cartesian(p));

  // Continue the grid on the sides where the face ends with it.
  const Span &u_first = model.spans[surface.u_spans.first], &u_last = model.spans[surface.u_spans.end() - 1];
  const Span &v_first = model.spans[surface.v_spans.first], &v_last = model.spans[surface.v_spans.end() - 1];
  double u_low = u_first.begin, u_high = u_last.end, v_low = v_first.begin, v_high = v_last.end;
  if (const double reach_mm = kContinueGaps * LargestGap(model, face); reach_mm > 0) {
    const auto by = [&](bool across_u, bool high) {
      return ContinueBy(model, surface, {across_u, high}, reach_mm);
    };
    if (!surface.extendable_u) {
      u_low = BezierToNative(u_first, -by(true, false));
      u_high = BezierToNative(u_last, 1 + by(true, true));
    }
    if (!surface.extendable_v) {
      v_low = BezierToNative(v_first, -by(false, false));
      v_high = BezierToNative(v_last, 1 + by(false, true));
    }
    data.u_low_continued = u_low < u_first.begin;
    data.u_high_continued = u_high > u_last.end;
    data.v_low_continued = v_low < v_first.begin;
    data.v_high_continued = v_high > v_last.end;
    // Twice the distance bounds the continuation, because it is only slightly curved.
    const Vec3 margin{2 * reach_mm, 2 * reach_mm, 2 * reach_mm};
    data.bounds = {data.bounds.low - margin, data.bounds.high + margin};
  }

  data.continued = {NativeToBezier(u_first, u_low), NativeToBezier(u_last, u_high),
                    NativeToBezier(v_first, v_low), NativeToBezier(v_last, v_high)};

  data.patches.reserve(surface.PatchCount());
  for (std::uint32_t i = 0; i < surface.u_spans.count; ++i) {
    for (std::uint32_t j = 0; j < surface.v_spans.count; ++j) {
      const Span &u = model.spans[surface.u_spans.first + i], &v = model.spans[surface.v_spans.first + j];
      data.patches.push_back(
          data.trim.Classify(i == 0 ? u_low : u.begin, i + 1 == surface.u_spans.count ? u_high : u.end,
                             j == 0 ? v_low : v.begin, j + 1 == surface.v_spans.count ? v_high : v.end));
    }
  }
  return data;
}

}  // namespace

std::size_t Scene::Data::bytes() const {
  std::size_t sum =
      faces.capacity() * sizeof(FaceData) + spans.capacity() * sizeof(SpanParameter) + seams.bytes();
  for (const FaceData& face : faces) sum += face.trim.bytes() + face.patches.capacity() * sizeof(RectClass);
  return sum;
}

Scene::Scene(const Model& model) : data_(std::make_unique<Data>()) {
  data_->model = &model;
  data_->faces.resize(model.faces.size());
  ParallelFor(std::size_t{0}, model.faces.size(),
              [&](std::size_t i) { data_->faces[i] = MakeFaceData(model, static_cast<std::uint32_t>(i)); });
  data_->seams = SeamTable(model);
  data_->spans.reserve(model.spans.size());
  for (const Span& span : model.spans) data_->spans.emplace_back(span);
  data_->has_closed_solid =
      std::any_of(model.solids.begin(), model.solids.end(), [](const Solid& s) { return s.closed; });
}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
const Model& Scene::model() const {
  return *data_->model;
}

}  // namespace facetless
