#include "render/trace/prepare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "render/base/parallel.h"
#include "render/kernels/dispatch.h"
#include "render/model/walk.h"
#include "render/view/projection.h"

namespace facetless {
namespace {

// The patches of a face are distributed over the threads if there are at least this many.
constexpr std::uint32_t kParallelPatches = 16;

// The results of one thread.
struct Worker {
  Worker(const SplitWindow& window, SplitBudget* budget) : splitter(window, budget) {}
  LeafSplitter splitter;
  CoefficientArena arena;
  LeafLists leaves;
  std::vector<std::uint32_t> faces;  // placed faces with leaves in this result, without seam leaves
};

class Preparation {
 public:
  Preparation(const Scene::Data& scene, const Camera& camera, const CameraFrame& frame,
              const DirectOptions& options, const NetOperations& nets)
      : scene_(scene), model_(*scene.model), camera_(camera), frame_(frame), workers_([this] {
          return Worker(window_, &budget_);
        }) {
    window_.half_width = 0.5 * camera.width_px;
    window_.half_height = 0.5 * camera.height_px;
    window_.perspective = frame.projection == Projection::kPerspective;
    window_.near_depth = frame.near_mm;
    window_.nets = &nets;
    window_.arithmetic =
        options.accuracy.precision == Precision::kFast ? kFloatArithmetic : kDoubleArithmetic;
    if (options.accuracy.newton_tolerance > 0)
      window_.arithmetic.tolerance = options.accuracy.newton_tolerance;
    budget_.cancel = options.execution.cancel;
    max_bytes_ = static_cast<std::int64_t>(options.accuracy.max_bytes);
    leave_out_ = options.leave_out;
  }

  Result<PreparedView> Run(int columns, int rows) {
    Split();
    if (budget_.Exhausted()) {
      return Error{ErrorCode::kLimitExceeded,
                   "the view needs more leaves than fit into the memory allowed; use a smaller image, or "
                   "allow more with --max-view-memory"};
    }
    if (budget_.Stopped()) return Error{ErrorCode::kCancelled, "cancelled while preparing the view"};

    PreparedView view;
    view.nets = window_.nets;
    view.arithmetic = window_.arithmetic;
    std::vector<LeafSpans> leaves;
    std::vector<bool> seen(model_.PlacedFaceCount(), false);
    for (const Worker& worker : workers_) {
      leaves.push_back(worker.leaves.spans());
      for (const std::uint32_t face : worker.faces) seen[face] = true;
      view.nodes += worker.splitter.nodes();
    }
    if (TooMany(leaves))
      return Error{ErrorCode::kLimitExceeded, "the view needs more than 2^30 leaves; use a smaller image"};
    view.tiles = std::make_unique<TileLeaves>(leaves, columns, rows);
    for (Worker& worker : workers_) view.arenas.push_back(std::move(worker.arena));
    for (std::uint32_t id = 0; id < seen.size(); ++id) {
      if (!seen[id]) view.unseen_faces.push_back(id);
    }
    return view;
  }

 private:
  // More than have a name.
  static bool TooMany(const std::vector<LeafSpans>& parts) {
    std::size_t certified = 0, hard = 0, seams = 0;
    for (const LeafSpans& part : parts) {
      certified += part.certified.size();
      hard += part.hard.size();
      seams += part.seams.size();
    }
    return certified > kMostLeaves || hard > kMostLeaves || seams > kMostLeaves;
  }

  void Split() {
    budget_.bytes_left = max_bytes_;
    ParallelFor(std::size_t{0}, model_.instances.size(),
                [this](std::size_t i) { VisitInstance(model_.instances[i]); });
    VisitSeams();
  }

  void VisitInstance(const Instance& instance) {
    const ViewProjection projection(frame_, instance.placement);
    const Range faces = FacesOf(model_, instance);
    ParallelFor(faces.first, faces.end(), [&](std::uint32_t face) {
      if (!budget_.Stopped()) VisitFace(face, PlacedFaceId(model_, instance, face), projection);
    });
  }

  void VisitFace(std::uint32_t face, std::uint32_t placed_face, const ViewProjection& projection) {
    if (leave_out_ && (*leave_out_)[placed_face]) return;
    if (!BoxCanBeSeen(scene_.faces[face].bounds, projection)) return;
    const std::uint32_t patches = model_.surfaces[model_.faces[face].surface].PatchCount();
    const auto visit = [&](std::uint32_t patch) { VisitPatch(face, placed_face, patch, projection); };
    if (patches < kParallelPatches) {
      for (std::uint32_t patch = 0; patch < patches; ++patch) visit(patch);
    } else {
      ParallelFor(std::uint32_t{0}, patches, visit);
    }
  }

  // Returns whether the box may be visible. Returns false only if its image is proven to lie outside the
  // window.
  bool BoxCanBeSeen(const Box3& box, const ViewProjection& projection) const {
    bool left = true, right = true, above = true, below = true, behind = window_.perspective;
    double x_low = INFINITY, x_high = -INFINITY, y_low = INFINITY, y_high = -INFINITY;
    bool in_front = true;
    for (int corner = 0; corner < 8; ++corner) {
      const auto p = projection({corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                 corner & 4 ? box.high.z : box.low.z, 1});
      // Allow one sample of slack on every side; rounding is far smaller.
      const double limit_x = (window_.half_width + 1) * p.w, limit_y = (window_.half_height + 1) * p.w;
      left = left && p.x < -limit_x;
      right = right && p.x > limit_x;
      above = above && p.y < -limit_y;
      below = below && p.y > limit_y;
      behind = behind && p.w <= window_.near_depth * p.q;
      in_front = in_front && p.w > 0;
      x_low = std::min(x_low, p.x / p.w);
      x_high = std::max(x_high, p.x / p.w);
      y_low = std::min(y_low, p.y / p.w);
      y_high = std::max(y_high, p.y / p.w);
    }
    if (left || right || above || below || behind) return false;
    if (!in_front) return true;
    const auto empty = [](double low, double high, double half) {
      return std::ceil(low + half - 0.5 - 0.125) > std::floor(high + half - 0.5 + 0.125);
    };
    return !(empty(x_low, x_high, window_.half_width) || empty(y_low, y_high, window_.half_height));
  }

  void VisitPatch(std::uint32_t face, std::uint32_t placed_face, std::uint32_t patch,
                  const ViewProjection& projection) {
    const Surface& surface = model_.surfaces[model_.faces[face].surface];
    const FaceData& data = scene_.faces[face];
    const std::uint32_t i = patch / surface.v_spans.count, j = patch % surface.v_spans.count;
    // Skip patches outside the loops before projecting anything.
    if (data.patches[patch] == RectClass::kOutside) return;
    SplitPatch split;
    split.trim_class = data.patches[patch];
    split.u_map = scene_.spans[surface.u_spans.first + i];
    split.v_map = scene_.spans[surface.v_spans.first + j];
    split.trim = &data.trim;
    split.placed_face = placed_face;
    split.patch = patch;

    Worker& worker = workers_.local();
    BezierNet& net = worker.splitter.Begin(surface.degree_u, surface.degree_v);
    const Vec4* points = PatchPoints(model_, surface, patch).data();
    bool weight_varies = false, depth_varies = false;
    std::fill_n(net.error, int{kNetComponents}, 0.0);
    for (int k = 0; k < net.points(); ++k) {
      const auto p = projection(points[k]);
      net.at(k, kX) = p.x;
      net.at(k, kY) = p.y;
      net.at(k, kW) = p.w;
      net.at(k, kQ) = p.q;
      const auto error = projection.Error(points[k]);
      net.error[kX] = std::max(net.error[kX], error.x);
      net.error[kY] = std::max(net.error[kY], error.y);
      net.error[kW] = std::max(net.error[kW], error.w);
      net.error[kQ] = std::max(net.error[kQ], error.q);
      weight_varies = weight_varies || p.w != net.at(0, kW);
      depth_varies = depth_varies || p.q != net.at(0, kQ);
    }
    // The polynomial kernels require W = 1. A constant weight other than 1 is treated as a varying weight,
    // which is exact.
    if (!weight_varies && net.at(0, kW) != 1 && net.at(0, kW) > 0) weight_varies = true;
    // In orthographic views the depth is Q/W, so it varies if W does.
    if (!window_.perspective && weight_varies && net.at(0, kQ) != 0) depth_varies = true;
    split.rule = {window_.perspective, weight_varies, depth_varies};
    split.bounds = SetBoxBounds(data, surface, i, j);
    ContinuePastBorder(split, net);
    const std::size_t before = worker.leaves.spans().size();
    worker.splitter.Split(split, &worker.leaves, &worker.arena);
    if (worker.leaves.spans().size() == before) return;
    if (worker.faces.empty() || worker.faces.back() != placed_face) worker.faces.push_back(placed_face);
  }

  // Adds a leaf with a single sample for every seam sample, so that it is processed front to back with the
  // others.
  void VisitSeams() {
    if (budget_.Stopped()) return;
    const std::vector<SeamSample> samples = FindSeamSamples(model_, scene_.seams, camera_, frame_, &budget_);
    Worker& worker = workers_.local();
    const SeamSample* before = nullptr;
    const double* patch_net = nullptr;
    for (const SeamSample& sample : samples) {
      const Instance& instance = model_.instances[sample.instance];
      const std::uint32_t placed_face = PlacedFaceId(model_, instance, sample.face);
      if (leave_out_ && (*leave_out_)[placed_face]) continue;
      const Surface& surface = model_.surfaces[model_.faces[sample.face].surface];
      SeamLeaf leaf;
      leaf.degree_u = surface.degree_u;
      leaf.degree_v = surface.degree_v;
      // Consecutive samples of one patch share its net.
      if (!before || before->instance != sample.instance || before->face != sample.face ||
          before->patch != sample.patch) {
        const ViewProjection projection(frame_, instance.placement);
        const Vec4* points = PatchPoints(model_, surface, sample.patch).data();
        const std::size_t n = surface.PointsPerPatch();
        double* net = worker.arena.Allocate(kNetComponents * n);
        for (std::size_t k = 0; k < n; ++k) {
          const auto p = projection(points[k]);
          const double components[kNetComponents] = {p.x, p.y, p.w, p.q};
          std::copy_n(components, int{kNetComponents}, net + kNetComponents * k);
        }
        patch_net = net;
        before = &sample;
        budget_.bytes_left.fetch_sub(static_cast<std::int64_t>(kNetComponents * n * sizeof(double)));
      }
      leaf.net = patch_net;
      leaf.flags = FlagsOf({window_.perspective, /*weight_varies=*/true, /*depth_varies=*/true});
      leaf.odd = sample.odd;
      leaf.s = 2 * sample.u - 1;
      leaf.t = 2 * sample.v - 1;
      leaf.near_depth = sample.depth;
      leaf.box = SampleBox::HalfOpen(sample.column, sample.column + 1, sample.row, sample.row + 1);
      leaf.placed_face = placed_face;
      leaf.patch = sample.patch;
      worker.leaves.seams.push_back(leaf);
    }
  }

  // Continues the projected net beyond the grid where the face ends with its grid. The edge of the neighbour
  // may lie there, and the rays between the two belong to this face.
  static void ContinuePastBorder(const SplitPatch& split, BezierNet& net) {
    const PatchBounds& bounds = split.bounds;
    // Constant components must stay exactly constant.
    for (const NetComponent c : {kX, kY, kW, kQ}) {
      if ((c == kW && !split.rule.weight_varies) || (c == kQ && !split.rule.depth_varies)) continue;
      if (bounds.u_low < 0 || bounds.u_high > 1)
        Extend(&net, c, Direction::kU, -bounds.u_low, bounds.u_high - 1);
      if (bounds.v_low < 0 || bounds.v_high > 1)
        Extend(&net, c, Direction::kV, -bounds.v_low, bounds.v_high - 1);
    }
  }

  const Scene::Data& scene_;
  const Model& model_;
  const Camera& camera_;
  const CameraFrame& frame_;
  SplitWindow window_;
  SplitBudget budget_;
  const std::vector<bool>* leave_out_ = nullptr;
  std::int64_t max_bytes_ = 0;  // memory limit of all leaves
  PerThread<Worker> workers_;
};

}  // namespace

std::size_t PreparedView::bytes() const {
  std::size_t sum = tiles->bytes() + unseen_faces.capacity() * sizeof(std::uint32_t);
  for (const CoefficientArena& arena : arenas) sum += arena.bytes();
  return sum;
}

Result<PreparedView> PrepareView(const Scene::Data& scene, const Camera& camera, const CameraFrame& frame,
                                 const DirectOptions& options) {
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels.ok()) return kernels.error();
  return Preparation(scene, camera, frame, options, *kernels.value().nets)
      .Run(camera.width_px, camera.height_px);
}

}  // namespace facetless
