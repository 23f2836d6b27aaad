#include "bench/patch_tracers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "bench/bernstein.h"
#include "bench/statistics.h"
#include "render/view/projection.h"

namespace facetless {
namespace {

constexpr double kInfinity = INFINITY;
// A determinant that is so small relative to the product of its columns has no correct digits.
constexpr double kSingular = 0x1p-48;

struct Step {
  double du = 0, dv = 0, residual = 0;
  bool singular = false;
};

// Implements the stopping rules and the walk through the tree. Method has
//   void SetRay(int x, int y);
//   double Enter(const Box3&) const;           depth at which the ray enters, infinite for a miss
//   Step StepAt(std::uint32_t patch, double u, double v) const;
//   double DepthAt(std::uint32_t patch, double u, double v) const;
//   double tolerance() const;
template <typename Method>
class Walk {
 public:
  Walk(const PatchTree& tree, Method& method) : tree_(tree), method_(method) {}

  void Trace(int width, int height, PatchImage& image) {
    image.depth.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kInfinity);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        method_.SetRay(x, y);
        const double depth = Nearest(image);
        image.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)] = depth;
        image.hits += depth < kInfinity;
      }
  }

 private:
  struct Waiting {
    double enter;
    std::uint32_t node;
  };

  double Nearest(PatchImage& image) {
    double best = kInfinity;
    stack_.clear();
    ++image.box_tests;
    if (const double enter = method_.Enter(tree_.nodes[0].box); enter < kInfinity)
      stack_.push_back({enter, 0});
    while (!stack_.empty()) {
      const Waiting next = stack_.back();
      stack_.pop_back();
      if (next.enter > best) continue;
      const PatchTreeNode& node = tree_.nodes[next.node];
      if (node.leaf) {
        best = std::min(best, Solve(tree_.pieces[node.first], image));
        continue;
      }
      // Put the nearer child on top of the stack.
      image.box_tests += 2;
      Waiting near{method_.Enter(tree_.nodes[node.first].box), node.first},
          far{method_.Enter(tree_.nodes[node.first + 1].box), node.first + 1};
      if (far.enter < near.enter) std::swap(near, far);
      if (far.enter < best) stack_.push_back(far);
      if (near.enter < best) stack_.push_back(near);
    }
    return best;
  }

  double Solve(const PatchPiece& piece, PatchImage& image) {
    const double u0 = 0.5 * (piece.u_low + piece.u_high), v0 = 0.5 * (piece.v_low + piece.v_high);
    double u = u0, v = v0, before = kInfinity;
    ++image.solves;
    for (int step = 0; step <= kMostSteps; ++step) {
      const Step next = method_.StepAt(piece.patch, u, v);
      if (next.residual < method_.tolerance()) {
        if (!Within(u, kBorder) || !Within(v, kBorder)) return kInfinity;
        ++image.roots;
        return method_.DepthAt(piece.patch, u, v);
      }
      if (!(next.residual <= before)) return kInfinity;
      before = next.residual;
      ++image.iterations;
      if (next.singular) {
        u += 0.1 * Random() * (u0 - u);
        v += 0.1 * Random() * (v0 - v);
        before = kInfinity;
        continue;
      }
      u += next.du;
      v += next.dv;
      if (!Within(u, kRoam) || !Within(v, kRoam)) return kInfinity;
    }
    return kInfinity;
  }

  // An iterate may leave the patch by this many times the patch's length, which is the range of its
  // neighbours. In the paper it may move over the whole surface.
  static constexpr double kRoam = 1;
  // The tolerance of the residual lets a root on the border lie outside by this much, in parameters of a
  // patch that covers many pixels.
  static constexpr double kBorder = 1e-8;
  static bool Within(double t, double beyond) { return t >= -beyond && t <= 1 + beyond; }

  double Random() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  const PatchTree& tree_;
  Method& method_;
  std::vector<Waiting> stack_;
  std::mt19937_64 engine_{1};
};

class MartinMethod {
 public:
  MartinMethod(const std::vector<ScenePatch>& patches, const CameraFrame& frame)
      : patches_(patches),
        frame_(frame),
        tolerance_(kSceneTolerancePx * std::max(frame.pixel_x, frame.pixel_y)) {}

  void SetRay(int x, int y) {
    ray_ = PixelRay(frame_, x + 0.5, y + 0.5);
    const Vec3 d = Normalized(ray_.direction);
    inverse_ = {1 / ray_.direction.x, 1 / ray_.direction.y, 1 / ray_.direction.z};
    // Choose two planes through the ray. The first normal contains the direction's largest component, so that
    // it does not vanish.
    const bool x_largest = std::fabs(d.x) > std::fabs(d.y) && std::fabs(d.x) > std::fabs(d.z);
    normal1_ = Normalized(x_largest ? Vec3{d.y, -d.x, 0} : Vec3{0, d.z, -d.y});
    normal2_ = Cross(normal1_, d);
    offset1_ = -Dot(normal1_, ray_.origin);
    offset2_ = -Dot(normal2_, ray_.origin);
  }

  double Enter(const Box3& box) const {
    double enter = -kInfinity, leave = kInfinity;
    Cut(box.low.x, box.high.x, ray_.origin.x, inverse_.x, enter, leave);
    Cut(box.low.y, box.high.y, ray_.origin.y, inverse_.y, enter, leave);
    Cut(box.low.z, box.high.z, ray_.origin.z, inverse_.z, enter, leave);
    return enter <= leave ? enter : kInfinity;
  }

  Step StepAt(std::uint32_t index, double u, double v) const {
    const ScenePatch& patch = patches_[index];
    const PatchJet<4> jet = EvaluatePatch<4>(patch.points.data(), patch.degree_u, patch.degree_v, u, v);
    // Apply the quotient rule.
    const double inverse = 1 / jet.value[3];
    const Vec3 s = inverse * Vec3{jet.value[0], jet.value[1], jet.value[2]};
    const Vec3 su = inverse * (Vec3{jet.du[0], jet.du[1], jet.du[2]} - jet.du[3] * s),
               sv = inverse * (Vec3{jet.dv[0], jet.dv[1], jet.dv[2]} - jet.dv[3] * s);
    const double f1 = Dot(normal1_, s) + offset1_, f2 = Dot(normal2_, s) + offset2_;
    const double a = Dot(normal1_, su), b = Dot(normal1_, sv), c = Dot(normal2_, su), d = Dot(normal2_, sv);
    const double determinant = a * d - b * c;
    Step step;
    step.residual = std::max(std::fabs(f1), std::fabs(f2));
    step.singular = !(std::fabs(determinant) > kSingular * (std::fabs(a * d) + std::fabs(b * c)));
    step.du = -(d * f1 - b * f2) / determinant;
    step.dv = -(a * f2 - c * f1) / determinant;
    return step;
  }

  double DepthAt(std::uint32_t index, double u, double v) const {
    const ScenePatch& patch = patches_[index];
    const PatchJet<4> jet = EvaluatePatch<4>(patch.points.data(), patch.degree_u, patch.degree_v, u, v);
    const Vec3 s = (1 / jet.value[3]) * Vec3{jet.value[0], jet.value[1], jet.value[2]};
    return Dot(s - frame_.eye, frame_.forward);
  }

  double tolerance() const { return tolerance_; }

 private:
  static void Cut(double low, double high, double origin, double inverse, double& enter, double& leave) {
    const double a = (low - origin) * inverse, b = (high - origin) * inverse;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }

  const std::vector<ScenePatch>& patches_;
  const CameraFrame& frame_;
  const double tolerance_;
  Ray ray_;
  Vec3 inverse_, normal1_, normal2_;
  double offset1_ = 0, offset2_ = 0;
};

class NewtonCramerMethod {
 public:
  NewtonCramerMethod(const std::vector<ScenePatch>& projected, const CameraFrame& frame)
      : center_x_(frame.center_x), center_y_(frame.center_y) {
    // The components that the iteration reads are stored together, and the depths separately.
    for (const ScenePatch& patch : projected) {
      Projected out{patch.degree_u, patch.degree_v, planar_.size(), depth_.size()};
      for (const std::array<double, 4>& p : patch.points) {
        planar_.push_back({p[0], p[1], p[3]});
        depth_.push_back({p[2]});
      }
      patches_.push_back(out);
    }
  }

  void SetRay(int x, int y) {
    x_ = x + 0.5 - center_x_;
    y_ = y + 0.5 - center_y_;
  }

  double Enter(const Box3& box) const {
    return box.low.x <= x_ && x_ <= box.high.x && box.low.y <= y_ && y_ <= box.high.y ? box.low.z : kInfinity;
  }

  Step StepAt(std::uint32_t index, double u, double v) const {
    const Projected& patch = patches_[index];
    const PatchJet<3> jet =
        EvaluatePatch<3>(planar_.data() + patch.planar, patch.degree_u, patch.degree_v, u, v);
    // Equations 12 and 13 need three determinants. They share the minors of S and Sv, and of S and Su.
    const auto& [sx, sy, sw] = jet.value;
    const auto& [ux, uy, uw] = jet.du;
    const auto& [vx, vy, vw] = jet.dv;
    const double v_yw = sy * vw - sw * vy, v_xw = sx * vw - sw * vx, v_xy = sx * vy - sy * vx;
    const double u_yw = sy * uw - sw * uy, u_xw = sx * uw - sw * ux, u_xy = sx * uy - sy * ux;
    const double m = -(ux * v_yw - uy * v_xw + uw * v_xy);
    const double m_u = -(x_ * v_yw - y_ * v_xw + v_xy);
    const double m_v = x_ * u_yw - y_ * u_xw + u_xy;
    Step step;
    step.residual = std::max(std::fabs(sx / sw - x_), std::fabs(sy / sw - y_));
    step.singular =
        !(std::fabs(m) > kSingular * (std::fabs(ux * v_yw) + std::fabs(uy * v_xw) + std::fabs(uw * v_xy)));
    step.du = sw / m * m_u;
    step.dv = sw / m * m_v;
    return step;
  }

  double DepthAt(std::uint32_t index, double u, double v) const {
    const Projected& patch = patches_[index];
    const double weight =
        EvaluatePatch<3>(planar_.data() + patch.planar, patch.degree_u, patch.degree_v, u, v).value[2];
    return EvaluatePatch<1>(depth_.data() + patch.depth, patch.degree_u, patch.degree_v, u, v).value[0] /
           weight;
  }

  double tolerance() const { return kSceneTolerancePx; }
  std::size_t bytes() const {
    return patches_.size() * sizeof(Projected) + planar_.size() * sizeof(planar_[0]) +
           depth_.size() * sizeof(depth_[0]);
  }

 private:
  struct Projected {
    int degree_u, degree_v;
    std::size_t planar, depth;  // index of the first element of each
  };
  const double center_x_, center_y_;
  std::vector<Projected> patches_;
  std::vector<std::array<double, 3>> planar_;
  std::vector<std::array<double, 1>> depth_;
  double x_ = 0, y_ = 0;
};

// Projects the patches to a view's (X, Y, Q, W): columns, rows and depths times the weight.
std::vector<ScenePatch> Project(const std::vector<ScenePatch>& patches, const CameraFrame& frame) {
  const ViewProjection projection(frame, Placement{});
  std::vector<ScenePatch> projected = patches;
  for (ScenePatch& patch : projected)
    for (std::array<double, 4>& p : patch.points) {
      const ViewProjection::Point q = projection({p[0], p[1], p[2], p[3]});
      p = {q.x, q.y, q.q, q.w};
    }
  return projected;
}

}  // namespace

PatchImage TraceMartin(const std::vector<ScenePatch>& patches, const CameraFrame& frame, int width,
                       int height) {
  PatchImage image;
  PatchTree tree;
  image.prepare_ms = MeasureMilliseconds([&] { tree = BuildPatchTree(patches, kFlattening); });
  image.bytes = tree.bytes();
  for (const ScenePatch& patch : patches)
    image.bytes += sizeof patch + patch.points.size() * sizeof patch.points[0];
  MartinMethod method(patches, frame);
  image.trace_ms = MeasureMilliseconds([&] { Walk(tree, method).Trace(width, height, image); });
  return image;
}

PatchImage TraceNewtonCramer(const std::vector<ScenePatch>& patches, const CameraFrame& frame, int width,
                             int height) {
  PatchImage image;
  PatchTree tree;
  std::vector<ScenePatch> projected;
  image.prepare_ms = MeasureMilliseconds([&] {
    tree = BuildPatchTree(patches, kFlattening);
    projected = Project(patches, frame);
    ReplaceBoxes(tree, projected);
  });
  NewtonCramerMethod method(projected, frame);
  image.bytes = tree.bytes() + method.bytes();
  image.trace_ms = MeasureMilliseconds([&] { Walk(tree, method).Trace(width, height, image); });
  return image;
}

DepthDifferences CompareDepths(std::span<const double> first, std::span<const double> second,
                               double tolerance_mm) {
  DepthDifferences differences;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const bool hit_first = first[i] < kInfinity, hit_second = second[i] < kInfinity;
    differences.only_first += hit_first && !hit_second;
    differences.only_second += hit_second && !hit_first;
    if (!hit_first || !hit_second) continue;
    ++differences.both_hit;
    const double difference = std::fabs(first[i] - second[i]);
    if (difference <= tolerance_mm)
      differences.largest_mm = std::max(differences.largest_mm, difference);
    else
      ++differences.apart;
  }
  return differences;
}

}  // namespace facetless
