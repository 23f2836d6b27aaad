#include "render/trace/hit_geometry.h"

#include <cmath>

namespace facetless {
namespace {

struct Jet {
  double f = 0, ds = 0, dt = 0;
};

// Evaluates centred monomials by Horner's rule, with both first derivatives.
template <typename Real>
Jet Monomial(const Real* c, int degree_u, int degree_v, double s, double t) {
  Jet jet;
  for (int i = degree_u; i >= 0; --i) {
    const Real* row = c + i * (degree_v + 1);
    double value = row[degree_v], slope = 0;
    for (int j = degree_v - 1; j >= 0; --j) {
      slope = slope * t + value;
      value = value * t + row[j];
    }
    jet.ds = jet.ds * s + jet.f;
    jet.f = jet.f * s + value;
    jet.dt = jet.dt * s + slope;
  }
  return jet;
}

// Evaluates one component of a net over s, t ∈ [−1,1] by de Casteljau's algorithm, with both first
// derivatives.
Jet Bernstein(const double* net, NetComponent c, int degree_u, int degree_v, double s, double t) {
  const double u = 0.5 * (1 + s), v = 0.5 * (1 + t);
  double value[kMaxDegree + 1], slope[kMaxDegree + 1], row[kMaxDegree + 1];
  for (int i = 0; i <= degree_u; ++i) {
    for (int j = 0; j <= degree_v; ++j) row[j] = net[kNetComponents * (i * (degree_v + 1) + j) + c];
    for (int n = degree_v; n > 1; --n) {
      for (int j = 0; j < n; ++j) row[j] += v * (row[j + 1] - row[j]);
    }
    slope[i] = 0.5 * degree_v * (row[1] - row[0]);
    value[i] = row[0] + v * (row[1] - row[0]);
  }
  for (int n = degree_u; n > 1; --n) {
    for (int i = 0; i < n; ++i) {
      value[i] += u * (value[i + 1] - value[i]);
      slope[i] += u * (slope[i + 1] - slope[i]);
    }
  }
  return {value[0] + u * (value[1] - value[0]), 0.5 * degree_u * (value[1] - value[0]),
          slope[0] + u * (slope[1] - slope[0])};
}

struct Tangents {
  Vec3 ds, dt;
  double depth;
};

// The values that Tangents needs from a certified leaf: the derivatives of G and the jets of W and Q. `q` is
// unchanged if the leaf has no plane for it.
struct LeafJets {
  Jet g1, g2, w{1, 0, 0}, q;
};

template <typename Real>
LeafJets EvaluateLeaf(const Real* coefficients, const CertifiedLeaf& leaf, double s, double t) {
  const int pu = leaf.degree_u, pv = leaf.degree_v, n = leaf.points();
  LeafJets jets;
  jets.q.f = (leaf.flags & kLeafPerspective) ? 1 : 0;
  jets.g1 = Monomial(coefficients, pu, pv, s, t);
  jets.g2 = Monomial(coefficients + n, pu, pv, s, t);
  const Real* next = coefficients + 2 * n;
  if (leaf.flags & kLeafWeightVaries) {
    jets.w = Monomial(next, pu, pv, s, t);
    next += n;
  }
  if (leaf.flags & kLeafDepthVaries) jets.q = Monomial(next, pu, pv, s, t);
  return jets;
}

// F = (X − x·W, Y − y·W), W and Q with their derivatives. F itself vanishes at a root.
struct RootJets {
  Jet fx, fy, w, q;
};

RootJets JetsOf(const CertifiedLeaf& leaf, const KernelArithmetic& arithmetic, double s, double t, double x,
                double y) {
  const LeafJets jets = arithmetic.is_single() ? EvaluateLeaf(CoefficientsOf<float>(leaf), leaf, s, t)
                                               : EvaluateLeaf(CoefficientsOf<double>(leaf), leaf, s, t);
  const Jet &g1 = jets.g1, &g2 = jets.g2, &w = jets.w;
  const double dx = x - leaf.center_x, dy = y - leaf.center_y;
  const double b1 = leaf.c11 * dx + leaf.c12 * dy, b2 = leaf.c21 * dx + leaf.c22 * dy;
  const double h1s = g1.ds - b1 * w.ds, h1t = g1.dt - b1 * w.dt, h2s = g2.ds - b2 * w.ds,
               h2t = g2.dt - b2 * w.dt;
  // Undo C.
  const double determinant = leaf.c11 * leaf.c22 - leaf.c12 * leaf.c21;
  const double a11 = leaf.c22 / determinant, a12 = -leaf.c12 / determinant;
  const double a21 = -leaf.c21 / determinant, a22 = leaf.c11 / determinant;
  return {{0, a11 * h1s + a12 * h2s, a11 * h1t + a12 * h2t},
          {0, a21 * h1s + a22 * h2s, a21 * h1t + a22 * h2t},
          w,
          jets.q};
}

RootJets JetsOf(const LeafHeader& leaf, const double* net, double s, double t, double x, double y) {
  const int pu = leaf.degree_u, pv = leaf.degree_v;
  const Jet jx = Bernstein(net, kX, pu, pv, s, t), jy = Bernstein(net, kY, pu, pv, s, t);
  const Jet w = Bernstein(net, kW, pu, pv, s, t), q = Bernstein(net, kQ, pu, pv, s, t);
  return {{0, jx.ds - x * w.ds, jx.dt - x * w.dt}, {0, jy.ds - y * w.ds, jy.dt - y * w.dt}, w, q};
}

// The offset and the scale of a leaf's depth: the depth is scale·W/Q in perspective views, else offset + Q/W.
struct DepthUnits {
  double offset = 0, scale = 1;
};

// The pixel moves by F'/W; depth is Q/W, or W/Q in perspective, where the point is depth·(x, y, 1) in pixel
// units.
Tangents TangentsOf(const RootJets& jets, DepthUnits units, bool perspective, double x, double y,
                    const CameraFrame& frame) {
  const Jet &fx = jets.fx, &fy = jets.fy, &w = jets.w, &q = jets.q;
  const double xs = fx.ds / w.f, xt = fx.dt / w.f, ys = fy.ds / w.f, yt = fy.dt / w.f;
  if (!perspective) {
    const double depth = q.f / w.f;
    return {{xs * frame.pixel_x, ys * frame.pixel_y, (q.ds - depth * w.ds) / w.f},
            {xt * frame.pixel_x, yt * frame.pixel_y, (q.dt - depth * w.dt) / w.f},
            units.offset + depth};
  }
  const double scale = units.scale;
  const double depth = scale * w.f / q.f;
  const double depth_s = (scale * w.ds - depth * q.ds) / q.f, depth_t = (scale * w.dt - depth * q.dt) / q.f;
  return {{(depth_s * x + depth * xs) * frame.pixel_x, (depth_s * y + depth * ys) * frame.pixel_y, depth_s},
          {(depth_t * x + depth * xt) * frame.pixel_x, (depth_t * y + depth * yt) * frame.pixel_y, depth_t},
          depth};
}

// If the sine of the angle between the tangents, or the ratio of their lengths, is below this value, ds × dt
// has lost half of its digits to rounding.
constexpr double kSingular = 0x1p-26;

bool IsSingular(const Tangents& tangents, Vec3 normal) {
  const double longest = std::fmax(Dot(tangents.ds, tangents.ds), Dot(tangents.dt, tangents.dt));
  return !(Dot(normal, normal) > kSingular * kSingular * longest * longest);
}

// `tangents_at(s, t)` are the leaf's.
template <typename TangentsAt>
HitGeometry Geometry(const TangentsAt& tangents_at, double s, double t, bool perspective, double x, double y,
                     const CameraFrame& frame) {
  HitGeometry hit;
  Tangents tangents = tangents_at(s, t);
  hit.ds = tangents.ds;
  hit.dt = tangents.dt;
  hit.depth = tangents.depth;
  Vec3 normal = Cross(tangents.ds, tangents.dt);
  hit.singular = IsSingular(tangents, normal);
  // At a pole, step back towards the middle until the tangents span a plane.
  for (double back = 0x1p-16; back <= 1 && IsSingular(tangents, normal); back *= 16) {
    tangents = tangents_at(s - back * s, t - back * t);
    normal = Cross(tangents.ds, tangents.dt);
  }
  normal = Normalized(normal);
  Vec3 ray{0, 0, 1};
  if (perspective) ray = Normalized({x * frame.pixel_x, y * frame.pixel_y, 1});
  hit.cosine = std::fabs(Dot(normal, ray));
  hit.normal = normal.x * frame.right + normal.y * frame.down + normal.z * frame.forward;
  return hit;
}

HitGeometry EvaluateNet(const LeafHeader& leaf, const double* net, double s, double t, double x, double y,
                        const CameraFrame& frame) {
  const bool perspective = (leaf.flags & kLeafPerspective) != 0;
  const auto tangents_at = [&](double at_s, double at_t) {
    return TangentsOf(JetsOf(leaf, net, at_s, at_t, x, y), {}, perspective, x, y, frame);
  };
  return Geometry(tangents_at, s, t, perspective, x, y, frame);
}

}  // namespace

HitGeometry EvaluateHit(const CertifiedLeaf& leaf, const KernelArithmetic& arithmetic, double s, double t,
                        double x, double y, const CameraFrame& frame) {
  const bool perspective = (leaf.flags & kLeafPerspective) != 0;
  const DepthUnits units{leaf.depth_scale, leaf.depth_scale};
  const auto tangents_at = [&](double at_s, double at_t) {
    return TangentsOf(JetsOf(leaf, arithmetic, at_s, at_t, x, y), units, perspective, x, y, frame);
  };
  return Geometry(tangents_at, s, t, perspective, x, y, frame);
}

HitGeometry EvaluateHit(const HardLeaf& leaf, double s, double t, double x, double y,
                        const CameraFrame& frame) {
  return EvaluateNet(leaf, leaf.net, s, t, x, y, frame);
}

HitGeometry EvaluateHit(const SeamLeaf& leaf, double s, double t, double x, double y,
                        const CameraFrame& frame) {
  return EvaluateNet(leaf, leaf.net, s, t, x, y, frame);
}

}  // namespace facetless
