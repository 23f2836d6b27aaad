// The normals at the roots of the lanes in one certified leaf. Each tile_kernel_<isa>.cpp includes this file
// once, through tile_kernel.inl.h.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/kernels/leaf_solver.inl.h"

namespace facetless::FACETLESS_KERNEL_NAMESPACE {
namespace {

// If the sine of the angle between the tangents, or the ratio of their lengths, is below this value, most
// digits of the normal are rounding errors.
#if defined(FACETLESS_FLOAT_KERNEL)
constexpr double kSingular = 0x1p-6;
#else
constexpr double kSingular = 0x1p-26;
#endif

struct Normal {
  Lane x, y, z;    // unit, along ds × dt, model axes
  unsigned known;  // lanes in which the normal is known
};

// The normalised cross product of the derivatives of the leaf's points with respect to s and t, at the roots
// (s, t). P and Q are the degrees, or −1.
template <int P, int Q>
inline Normal NormalByDegrees(const CertifiedLeaf& leaf, const double* x, const double* y, Lane s, Lane t,
                              const ViewAxes& axes) {
  const int p = P >= 0 ? P : leaf.degree_u, q = Q >= 0 ? Q : leaf.degree_v;
  const int n = (p + 1) * (q + 1);
  const Real* g = CoefficientsOf<Real>(leaf);
  const Jet h1 = Evaluate<P, Q>(g, p, q, s, t), h2 = Evaluate<P, Q>(g + n, p, q, s, t);
  const Real* next = g + 2 * n;
  Jet w{Set(1), Set(0), Set(0)};
  Lane h1s = h1.ds, h1t = h1.dt, h2s = h2.ds, h2t = h2.dt;
  if (leaf.flags & kLeafWeightVaries) {
    w = Evaluate<P, Q>(next, p, q, s, t);
    next += n;
    const Lane b1 = Local(x, leaf.center_x, leaf.c11, y, leaf.center_y, leaf.c12);
    const Lane b2 = Local(x, leaf.center_x, leaf.c21, y, leaf.center_y, leaf.c22);
    h1s = Fnma(b1, w.ds, h1s);
    h1t = Fnma(b1, w.dt, h1t);
    h2s = Fnma(b2, w.ds, h2s);
    h2t = Fnma(b2, w.dt, h2t);
  }
  // Undo C: convert the tangents to pixels and then to mm, and the depth with them. A common factor keeps
  // fourth powers in the range of a float, however small the leaf is.
  const double determinant = leaf.c11 * leaf.c22 - leaf.c12 * leaf.c21;
  const double to_x = axes.pixel_x / determinant, to_y = axes.pixel_y / determinant;
  const double along_x = std::max(std::fabs(to_x * leaf.c22), std::fabs(to_x * leaf.c12)),
               along_y = std::max(std::fabs(to_y * leaf.c21), std::fabs(to_y * leaf.c11));
  const double factor = 1 / std::max(along_x, along_y);
  const Lane a11 = Set(factor * to_x * leaf.c22), a12 = Set(-factor * to_x * leaf.c12),
             a21 = Set(-factor * to_y * leaf.c21), a22 = Set(factor * to_y * leaf.c11);
  Lane xs = Fma(a11, h1s, a12 * h2s), xt = Fma(a11, h1t, a12 * h2t);
  Lane ys = Fma(a21, h1s, a22 * h2s), yt = Fma(a21, h1t, a22 * h2t);
  Lane zs = Set(0), zt = Set(0);
  const bool perspective = (leaf.flags & kLeafPerspective) != 0;
  if (leaf.flags & kLeafDepthVaries) {
    const Jet d = Evaluate<P, Q>(next, p, q, s, t);
    if (perspective) {
      const Lane depth = w.f / d.f;
      zs = Fnma(depth, d.ds, w.ds);
      zt = Fnma(depth, d.dt, w.dt);
    } else {
      const Lane depth = d.f / w.f;
      zs = Fnma(depth, w.ds, d.ds);
      zt = Fnma(depth, w.dt, d.dt);
    }
  } else if (perspective) {
    zs = w.ds;
    zt = w.dt;
  }
  zs = Set(factor) * zs;
  zt = Set(factor) * zt;
  if (perspective) {
    const Lane tan_x = Local(x, 0, axes.pixel_x, y, 0, 0), tan_y = Local(x, 0, 0, y, 0, axes.pixel_y);
    xs = Fma(tan_x, zs, xs);
    xt = Fma(tan_x, zt, xt);
    ys = Fma(tan_y, zs, ys);
    yt = Fma(tan_y, zt, yt);
  }
  const Lane nx = Fma(ys, zt, Set(0) - zs * yt), ny = Fma(zs, xt, Set(0) - xs * zt),
             nz = Fma(xs, yt, Set(0) - ys * xt);
  const Lane square = Fma(nx, nx, Fma(ny, ny, nz * nz)), square_s = Fma(xs, xs, Fma(ys, ys, zs * zs)),
             square_t = Fma(xt, xt, Fma(yt, yt, zt * zt));
  const Lane longest = Select(square_s < square_t, square_t, square_s);
  const Lane inverse = Set(1) / Sqrt(square);
  const auto along = [&](double right, double down, double forward) {
    return inverse * Fma(Set(right), nx, Fma(Set(down), ny, Set(forward) * nz));
  };
  return {along(axes.right.x, axes.down.x, axes.forward.x), along(axes.right.y, axes.down.y, axes.forward.y),
          along(axes.right.z, axes.down.z, axes.forward.z),
          ToBits(Set(kSingular * kSingular) * (longest * longest) < square)};
}

inline Normal NormalAt(const CertifiedLeaf& leaf, const double* x, const double* y, Lane s, Lane t,
                       const ViewAxes& axes) {
  return ByDegrees(leaf.degree_u, leaf.degree_v,
                   [&]<int P, int Q>() { return NormalByDegrees<P, Q>(leaf, x, y, s, t, axes); });
}

}  // namespace
}  // namespace facetless::FACETLESS_KERNEL_NAMESPACE
