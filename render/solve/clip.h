// Bézier clipping: what its variants have in common. The part of a patch that may hold roots of a ray is a net of control
// points (RayNet). Each step bounds the parameters of the roots along u or along v, and cuts the net down to them.
//
//     NetStack nets(MostPoints(scene));  // one for each thread
//     nets.Load(scene, patch, ray);
//     while (!nets.empty()) {
//       RayNet& net = nets.top();
//       const Vec2 side = SideSum(net, ClipAxis::kV);
//       const ClipInterval roots = ZeroInterval(Distances(net, ClipAxis::kU, {-side.y, side.x}), 0);
//       if (roots.empty()) nets.Pop();
//       else Restrict(net, ClipAxis::kU, roots.low, roots.high);  // then the same along v; halve, or report a root
//     }
//
//  1. A net has two numbers for each control point: f = X − x·W and g = Y − y·W of the projected homogeneous point. The
//     ray through pixel coordinates (x, y) meets the surface where both polynomials are zero. Nothing is divided by W, so
//     points behind the eye (W ≤ 0) need no care. Both are multiplied by one power of two, which is exact, so that no
//     square overflows, whatever the weights are.
//  2. The distances of the control points from a line through the ray are the coefficients of a polynomial, which is zero
//     wherever f and g are. Its roots lie where the convex hull of its control points, drawn over the parameter, meets
//     the axis (T. Nishita, T. Sederberg, M. Kakimoto, "Ray tracing trimmed rational surface patches", 1990, section 3).
//  3. Nothing here allocates, except the constructor of NetStack.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/base/vec.h"
#include "render/solve/solver.h"
#include "render/solve/solver_scene.h"

namespace facetless {

enum class ClipAxis : std::uint8_t { kU, kV };
inline ClipAxis Other(ClipAxis axis) {
  return axis == ClipAxis::kU ? ClipAxis::kV : ClipAxis::kU;
}

// Parameters of a net, within [0,1].
struct ClipInterval {
  double low = 1, high = 0;
  bool empty() const { return !(low <= high); }
  double size() const { return high - low; }
};

// The part [u_low, u_high] × [v_low, v_high] of a patch, relative to a ray. The index of v varies fastest.
struct RayNet {
  int degree_u = 1, degree_v = 1;
  double u_low = 0, u_high = 1, v_low = 0, v_high = 1;
  double* f = nullptr;
  double* g = nullptr;
  // A net of bounds for the rounding of f and g; null if the method does not ask for it. Each of its numbers is the sum of
  // the absolute values of the terms from which f or g is computed, whichever is more: those of the projection, X or Y,
  // and x·W or y·W. The rounding error of f and g is at most `roundings`·2^-53 times this net. It is small where weights
  // are small, as f and g are.
  double* terms = nullptr;
  double roundings = 0;
  // If the method keeps them: the lines of the last clips, and the axis of the next one.
  Vec2 normal_u, normal_v;
  ClipAxis next = ClipAxis::kU;
  int points() const { return (degree_u + 1) * (degree_v + 1); }
  int degree(ClipAxis axis) const { return axis == ClipAxis::kU ? degree_u : degree_v; }
  // The size of the part along an axis, in parameters of the patch.
  double size(ClipAxis axis) const { return axis == ClipAxis::kU ? u_high - u_low : v_high - v_low; }
  double middle_u() const { return 0.5 * (u_low + u_high); }
  double middle_v() const { return 0.5 * (v_low + v_high); }
};

// The control points of the largest patch of a scene.
int MostPoints(const SolverScene& scene);

// The parts of a patch that are still to be searched, with the next one on top.
class NetStack {
 public:
  // No part is halved along an axis along which it is smaller than 2^-51.
  static constexpr int kMostNets = 2 * 52 + 1;

  explicit NetStack(int most_points, bool with_terms = false);

  // Makes the whole patch the only net. Returns false, and leaves no net, if the numbers are not finite. Requires a patch
  // with at most `most_points` control points.
  bool Load(const SolverScene& scene, const SolverPatch& patch, const SolverRay& ray);
  bool empty() const { return count_ == 0; }
  RayNet& top() { return nets_[static_cast<std::size_t>(count_ - 1)]; }
  void Pop() { --count_; }
  // Replaces the top by its two halves along an axis; the lower one is on top. Requires that the part is larger than 2^-51
  // along this axis.
  void Halve(ClipAxis axis);
  // The net is the net of the patch in pixels times W, multiplied by this power of two.
  double scale() const { return scale_; }
  std::uint64_t bytes() const { return numbers_.size() * sizeof(double); }

 private:
  std::vector<double> numbers_;  // f and g of each net
  std::array<RayNet, kMostNets> nets_;
  int count_ = 0;
  double scale_ = 1;
};

// The largest absolute value of f and g, and the bound of their rounding errors, which requires the net of terms.
double Largest(const RayNet& net);
double RoundingError(const RayNet& net);

// The sum of the two sides of the net that run along an axis.
Vec2 SideSum(const RayNet& net, ClipAxis axis);

// For each index along an axis, the least and the greatest of the distances Dot(normal, (f, g)) of the control points with
// that index.
struct DistanceBand {
  int degree = 1;
  std::array<double, kMaxDegree + 1> low, high;
};
DistanceBand Distances(const RayNet& net, ClipAxis axis, Vec2 normal);

// The parameters at which the convex hull of the points (i/degree, low[i] − slack) and (i/degree, high[i] + slack) meets
// the axis; empty if it does not. Numbers that are not comparable make it empty.
ClipInterval ZeroInterval(const DistanceBand& band, double slack);

// Cuts the net down to [low, high] of its own parameters along an axis, by de Casteljau's algorithm. Requires 0 ≤ low ≤
// high ≤ 1.
void Restrict(RayNet& net, ClipAxis axis, double low, double high);
// The same for a net of single numbers.
void RestrictNumbers(double* numbers, int degree_u, int degree_v, ClipAxis axis, double low, double high);

}  // namespace facetless
