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
  LeafLists leaves, between;         // see LeafSplitter::Split
  std::vector<std::uint32_t> faces;  // placed faces with leaves in this result, without seam leaves
};

// Returns whether there are more leaves of a kind than have a name.
bool TooMany(const std::vector<LeafSpans>& parts) {
  std::size_t certified = 0, hard = 0, seams = 0;
  for (const LeafSpans& part : parts) {
    certified += part.certified.size();
    hard += part.hard.size();
    seams += part.seams.size();
  }
  return certified > kMostLeaves || hard > kMostLeaves || seams > kMostLeaves;
}

// Returns the error of a preparation that ran out of memory or was cancelled.
Result<void> CheckBudget(const SplitBudget& budget) {
  if (budget.Exhausted())
    return Error{ErrorCode::kLimitExceeded,
                 "the view needs more leaves than fit into the memory allowed; use a smaller image, or "
                 "allow more with --max-view-memory"};
  if (budget.Stopped()) return Error{ErrorCode::kCancelled, "cancelled while preparing the view"};
  return {};
}

// Adds a leaf with a single sample for every seam sample, so that it is processed front to back with the others.
// `leave_out`: as in DirectOptions.
void AddSeamLeaves(const Scene::Data& scene, const CameraFrame& frame, const std::vector<SeamSample>& samples,
                   const std::vector<bool>* leave_out, SplitBudget* budget, LeafLists* leaves,
                   CoefficientArena* arena) {
  const Model& model = *scene.model;
  const bool perspective = frame.projection == Projection::kPerspective;
  const SeamSample* before = nullptr;
  const double* patch_net = nullptr;
  for (const SeamSample& sample : samples) {
    const Instance& instance = model.instances[sample.instance];
    const std::uint32_t placed_face = PlacedFaceId(model, instance, sample.face);
    if (leave_out && (*leave_out)[placed_face]) continue;
    const Surface& surface = model.surfaces[model.faces[sample.face].surface];
    SeamLeaf leaf;
    leaf.degree_u = surface.degree_u;
    leaf.degree_v = surface.degree_v;
    // Consecutive samples of one patch share its net.
    if (!before || before->instance != sample.instance || before->face != sample.face ||
        before->patch != sample.patch) {
      const ViewProjection projection(frame, instance.placement);
      const Vec4* points = PatchPoints(model, surface, sample.patch).data();
      const std::size_t n = surface.PointsPerPatch();
      double* net = arena->Allocate(kNetComponents * n);
      for (std::size_t k = 0; k < n; ++k) {
        const auto p = projection(points[k]);
        const double components[kNetComponents] = {p.x, p.y, p.w, p.q};
        std::copy_n(components, int{kNetComponents}, net + kNetComponents * k);
      }
      patch_net = net;
      before = &sample;
      budget->bytes_left.fetch_sub(static_cast<std::int64_t>(kNetComponents * n * sizeof(double)));
    }
    leaf.net = patch_net;
    leaf.flags = FlagsOf({perspective, /*weight_varies=*/true, /*depth_varies=*/true});
    leaf.odd = sample.odd;
    leaf.s = 2 * sample.u - 1;
    leaf.t = 2 * sample.v - 1;
    leaf.near_depth = sample.depth;
    leaf.box = SampleBox::HalfOpen(sample.column, sample.column + 1, sample.row, sample.row + 1);
    leaf.placed_face = placed_face;
    leaf.patch = sample.patch;
    leaves->seams.push_back(leaf);
  }
}

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
    if (options.refine != nullptr) {
      window_.grid_x = options.refine->grid.x;
      window_.grid_y = options.refine->grid.y;
    }
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
    if (Result<void> enough = CheckBudget(budget_); !enough.ok()) return enough.error();

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
    for (Worker& worker : workers_) {
      view.arenas.push_back(std::move(worker.arena));
      if (window_.grid_x * window_.grid_y > 1) view.between.push_back(std::move(worker.between));
    }
    for (std::uint32_t id = 0; id < seen.size(); ++id) {
      if (!seen[id]) view.unseen_faces.push_back(id);
    }
    return view;
  }

 private:
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
    // Nothing is visible between the samples: between the pixel centres, or those of the grid.
    const auto empty = [](double low, double high, double half) {
      return std::ceil(low + half - 0.5 - 0.125) > std::floor(high + half - 0.5 + 0.125);
    };
    const auto misses = [&](int grid_x, int grid_y) {
      return empty(grid_x * x_low, grid_x * x_high, grid_x * window_.half_width) ||
             empty(grid_y * y_low, grid_y * y_high, grid_y * window_.half_height);
    };
    return !misses(1, 1) || !misses(window_.grid_x, window_.grid_y);
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
    worker.splitter.Split(split, &worker.leaves, &worker.between, &worker.arena);
    if (worker.leaves.spans().size() == before) return;
    if (worker.faces.empty() || worker.faces.back() != placed_face) worker.faces.push_back(placed_face);
  }

  void VisitSeams() {
    if (budget_.Stopped()) return;
    const std::vector<SeamSample> samples = FindSeamSamples(model_, scene_.seams, camera_, frame_, &budget_);
    Worker& worker = workers_.local();
    AddSeamLeaves(scene_, frame_, samples, leave_out_, &budget_, &worker.leaves, &worker.arena);
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

// Gathers the leaves of a view that may hold samples of refined pixels, in units of samples.
class LeafReuse {
 public:
  LeafReuse(SampleGrid grid, const PixelSet& pixels, SplitBudget* budget)
      : grid_(grid),
        pixels_(pixels),
        budget_(budget),
        columns_(grid.x * pixels.width()),
        rows_(grid.y * pixels.height()) {}

  struct Part {
    LeafLists leaves;
    CoefficientArena arena;
  };

  // These append those of the certified, or of the hard, leaves [first, last) to `part` that may hold refined samples.
  // `between`: the boxes of the leaves count samples already.
  void AddCertified(const LeafSpans& leaves, std::size_t first, std::size_t last, bool between, Part* part) {
    for (std::size_t i = first; i < last; ++i) {
      CertifiedLeaf leaf = leaves.certified[i];
      leaf.box = between ? leaf.box : Tightened(leaf, SamplesOf(leaf.box));
      if (!IsWanted(leaf.box)) continue;
      // C maps the distance from the centre, now in samples, to the same coordinates of the leaf as before.
      leaf.center_x *= grid_.x;
      leaf.center_y *= grid_.y;
      leaf.c11 /= grid_.x;
      leaf.c21 /= grid_.x;
      leaf.c12 /= grid_.y;
      leaf.c22 /= grid_.y;
      part->leaves.certified.push_back(leaf);
      part->leaves.places.push_back(leaves.places[i]);
      Spend(sizeof(CertifiedLeaf) + sizeof(LeafPlace));
    }
  }

  void AddHard(const LeafSpans& leaves, std::size_t first, std::size_t last, bool between, Part* part) {
    for (std::size_t i = first; i < last; ++i) {
      HardLeaf leaf = leaves.hard[i];
      if (!between) leaf.box = SamplesOf(leaf.box);
      if (!IsWanted(leaf.box)) continue;
      const std::size_t count = static_cast<std::size_t>(kNetComponents) * leaf.points();
      double* net = part->arena.Allocate(count);
      std::copy_n(leaf.net, count, net);
      for (std::size_t k = 0; k < count; k += kNetComponents) {
        net[k + kX] *= grid_.x;
        net[k + kY] *= grid_.y;
      }
      leaf.net = net;
      leaf.error[kX] *= grid_.x;
      leaf.error[kY] *= grid_.y;
      part->leaves.hard.push_back(leaf);
      Spend(sizeof(HardLeaf) + count * sizeof(double));
    }
  }

 private:
  // The samples that a leaf may serve, of which only the pixel centres that it may serve are known.
  SampleBox SamplesOf(const SampleBox& centres) const {
    const auto first = [](int centre, int grid) {
      return centre == 0 ? 0 : static_cast<int>(std::ceil((centre - 0.5) * grid - 0.5));
    };
    const auto end = [](int centre_end, int grid, int count) {
      const double samples = std::floor((centre_end + 0.5) * grid - 0.5) + 1;
      return std::min(count, static_cast<int>(samples));
    };
    return SampleBox::HalfOpen(first(centres.col_begin(), grid_.x), end(centres.col_end(), grid_.x, columns_),
                               first(centres.row_begin(), grid_.y), end(centres.row_end(), grid_.y, rows_));
  }

  // Cuts off the samples of `box` whose |b| exceeds the leaf's b_limit (leaf.h, law 2).
  SampleBox Tightened(const CertifiedLeaf& leaf, SampleBox box) const {
    const double determinant = leaf.c11 * leaf.c22 - leaf.c12 * leaf.c21;
    const double reach = 1.001 * leaf.b_limit / std::fabs(determinant);
    const double half_x = grid_.x * reach * (std::fabs(leaf.c22) + std::fabs(leaf.c12)),
                 half_y = grid_.y * reach * (std::fabs(leaf.c21) + std::fabs(leaf.c11));
    if (!(half_x < columns_ && half_y < rows_)) return box;
    const double x = grid_.x * leaf.center_x + 0.5 * columns_, y = grid_.y * leaf.center_y + 0.5 * rows_;
    const double c0 = std::max<double>(box.col_begin(), std::ceil(x - half_x - 0.5)),
                 c1 = std::min<double>(box.col_end(), std::floor(x + half_x - 0.5) + 1),
                 r0 = std::max<double>(box.row_begin(), std::ceil(y - half_y - 0.5)),
                 r1 = std::min<double>(box.row_end(), std::floor(y + half_y - 0.5) + 1);
    if (!(c0 < c1 && r0 < r1)) return box;
    return SampleBox::HalfOpen(static_cast<int>(c0), static_cast<int>(c1), static_cast<int>(r0),
                               static_cast<int>(r1));
  }

  bool IsWanted(const SampleBox& box) const {
    return pixels_.HasAnyIn(box.first_col / grid_.x, box.last_col / grid_.x + 1, box.first_row / grid_.y,
                            box.last_row / grid_.y + 1);
  }

  void Spend(std::size_t bytes) {
    budget_->bytes_left.fetch_sub(static_cast<std::int64_t>(bytes), std::memory_order_relaxed);
  }

  const SampleGrid grid_;
  const PixelSet& pixels_;
  SplitBudget* const budget_;
  const int columns_, rows_;  // of samples
};

}  // namespace

Result<PreparedView> PrepareRefinement(const Scene::Data& scene, const PreparedView& centres,
                                       const Camera& camera, const CameraFrame& frame, SampleGrid grid,
                                       const PixelSet& pixels, const DirectOptions& options) {
  SplitBudget budget;
  budget.cancel = options.execution.cancel;
  budget.bytes_left =
      static_cast<std::int64_t>(options.accuracy.max_bytes) - static_cast<std::int64_t>(centres.bytes());
  LeafReuse reuse(grid, pixels, &budget);
  PerThread<LeafReuse::Part> parts;
  const auto add = [&](const LeafSpans& leaves, bool between) {
    constexpr std::size_t kBlock = 1024;
    ParallelForBlocks(0, leaves.certified.size(), kBlock, [&](std::size_t first, std::size_t last) {
      if (!budget.Stopped()) reuse.AddCertified(leaves, first, last, between, &parts.local());
    });
    ParallelForBlocks(0, leaves.hard.size(), kBlock, [&](std::size_t first, std::size_t last) {
      if (!budget.Stopped()) reuse.AddHard(leaves, first, last, between, &parts.local());
    });
  };
  add(centres.tiles->leaves(), false);
  for (const LeafLists& lists : centres.between) add(lists.spans(), true);

  LeafReuse::Part& own = parts.local();
  const std::vector<SeamSample> seams =
      FindSeamSamples(*scene.model, scene.seams, camera, frame, &budget, {&pixels, grid});
  AddSeamLeaves(scene, frame, seams, options.leave_out, &budget, &own.leaves, &own.arena);
  if (Result<void> enough = CheckBudget(budget); !enough.ok()) return enough.error();

  PreparedView view;
  view.arithmetic = centres.arithmetic;
  view.nets = centres.nets;
  std::vector<LeafSpans> leaves;
  for (const LeafReuse::Part& part : parts) leaves.push_back(part.leaves.spans());
  if (TooMany(leaves))
    return Error{ErrorCode::kLimitExceeded, "the view needs more than 2^30 leaves; use a smaller image"};
  view.tiles = std::make_unique<TileLeaves>(leaves, camera.width_px, camera.height_px);
  for (LeafReuse::Part& part : parts) view.arenas.push_back(std::move(part.arena));
  return view;
}

std::size_t PreparedView::bytes() const {
  std::size_t sum = tiles->bytes() + unseen_faces.capacity() * sizeof(std::uint32_t);
  for (const LeafLists& lists : between)
    sum += lists.certified.capacity() * (sizeof(CertifiedLeaf) + sizeof(LeafPlace)) +
           lists.hard.capacity() * sizeof(HardLeaf);
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
