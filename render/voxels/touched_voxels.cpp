#include "render/voxels/touched_voxels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "render/base/parallel.h"
#include "render/kernels/dispatch.h"
#include "render/model/walk.h"
#include "render/trace/scene.h"

namespace facetless {
namespace {

// A piece whose box is no larger than this, in voxels, is not halved.
constexpr double kPiece = 1;
// A piece inside its face that is a parallelogram but for this many voxels is not halved, if its box is no larger than
// kFlatPiece.
constexpr double kFlat = 0.5, kFlatPiece = 32;
// Boxes are made larger by this many voxels, far above the rounding of control points.
constexpr double kSlack = 0x1p-30;
// The most halvings of a patch: voxels along an axis, and some more for uneven parameters.
constexpr int kMostHalvings = 80;

struct Mark {
  std::uint16_t x, y, z;
  std::uint32_t placed_face, normal;
};

// The space between two planes across `normal`, which is a unit vector, or zero for all of space.
struct SlabOfSpace {
  Vec3 normal{0, 0, 0};
  double near = 0, far = 0;
};

// Finds the voxels of one face after another. Each thread has one.
class Toucher {
 public:
  Toucher(const Scene::Data& scene, const NetOperations& nets, const VoxelGrid& grid,
          std::atomic<std::uint64_t>* marks, std::uint64_t most_marks, bool details)
      : scene_(scene), nets_(nets), grid_(grid), total_(marks), most_marks_(most_marks), details_(details) {}

  // Returns false if there are too many marks.
  bool Touch(const Placement& placement, std::uint32_t face, std::uint32_t placed_face) {
    const Model& model = *scene_.model;
    const Surface& surface = model.surfaces[model.faces[face].surface];
    face_ = &scene_.faces[face];
    placed_face_ = placed_face;
    outward_ = model.faces[face].reversed != (placement.Determinant() < 0) ? -1 : 1;
    const std::size_t before = marks.size();
    for (std::uint32_t patch = 0; patch < surface.PatchCount(); ++patch) {
      if (face_->patches[patch] == RectClass::kOutside) continue;
      const std::uint32_t i = patch / surface.v_spans.count, j = patch % surface.v_spans.count;
      u_map_ = &scene_.spans[surface.u_spans.first + i];
      v_map_ = &scene_.spans[surface.v_spans.first + j];
      Level(0, 0).SetDegrees(surface.degree_u, surface.degree_v);
      BezierNet& net = Level(0, 0).net;
      const std::span<const Vec4> points = PatchPoints(model, surface, patch);
      for (int k = 0; k < net.points(); ++k) {
        const Vec4& p = points[static_cast<std::size_t>(k)];
        const Vec3 placed =
            (1 / grid_.pitch) * (placement.Point({p.x / p.w, p.y / p.w, p.z / p.w}) - grid_.origin);
        net.at(k, kX) = p.w * placed.x;
        net.at(k, kY) = p.w * placed.y;
        net.at(k, kQ) = p.w * placed.z;
        net.at(k, kW) = p.w;
      }
      Visit({&Level(0, 0), 0, 1, 0, 1, 0}, face_->patches[patch] == RectClass::kInside);
    }
    const std::uint64_t added = marks.size() - before;
    return total_->fetch_add(added, std::memory_order_relaxed) + added <= most_marks_;
  }

  std::vector<Mark> marks;

 private:
  struct Piece {
    OwnedNet* net;
    double u_low, u_high, v_low, v_high;
    int level;
  };

  OwnedNet& Level(int level, int side) {
    const std::size_t index = 2 * static_cast<std::size_t>(level) + static_cast<std::size_t>(side);
    while (levels_.size() <= index) levels_.push_back(std::make_unique<OwnedNet>());
    return *levels_[index];
  }

  static Vec3 Cartesian(const BezierNet& net, int i) {
    const double w = net.at(i, kW);
    return {net.at(i, kX) / w, net.at(i, kY) / w, net.at(i, kQ) / w};
  }

  void Visit(const Piece& piece, bool inside) {
    const BezierNet& net = piece.net->net;
    Box3 box;
    for (int i = 0; i < net.points(); ++i) box.Add(Cartesian(net, i));
    const VoxelPoint n = grid_.size;
    if (!(box.high.x >= 0 && box.high.y >= 0 && box.high.z >= 0 && box.low.x <= n.x && box.low.y <= n.y &&
          box.low.z <= n.z))
      return;
    if (!inside) {
      const RectClass trim =
          face_->trim.Classify(u_map_->ToNative(piece.u_low), u_map_->ToNative(piece.u_high),
                               v_map_->ToNative(piece.v_low), v_map_->ToNative(piece.v_high), 0);
      if (trim == RectClass::kOutside) return;
      inside = trim == RectClass::kInside;
    }
    const Vec3 side = box.high - box.low;
    const double longest = std::max({side.x, side.y, side.z});
    if (longest <= kPiece || piece.level == kMostHalvings) {
      const SlabOfSpace slab = SlabOf(net, NormalOf(net));
      return MarkMet(box, {&slab, 1});
    }
    std::array<SlabOfSpace, 3> slabs;
    if (inside && longest <= kFlatPiece && IsFlat(net, &slabs) && (!details_ || HasOneNormal(net)))
      return MarkMet(box, slabs);
    const Direction direction = Longer(net);
    OwnedNet &low = Level(piece.level + 1, 0), &high = Level(piece.level + 1, 1);
    low.SetDegrees(net.degree_u, net.degree_v);
    high.SetDegrees(net.degree_u, net.degree_v);
    nets_.halve(net, direction, &low.net, &high.net);
    // The upper half is visited first, and its children take the places of the next level; the lower half keeps its own.
    const bool along_u = direction == Direction::kU;
    const double middle = along_u ? 0.5 * (piece.u_low + piece.u_high) : 0.5 * (piece.v_low + piece.v_high);
    Piece lower = piece, upper = piece;
    (along_u ? lower.u_high : lower.v_high) = middle;
    (along_u ? upper.u_low : upper.v_low) = middle;
    lower.net = &low;
    upper.net = &high;
    lower.level = upper.level = piece.level + 1;
    Visit(upper, inside);
    Visit(lower, inside);
  }

  // The direction in which the control polygon is longer.
  static Direction Longer(const BezierNet& net) {
    const int last_u = net.degree_u * net.stride(), last_v = net.degree_v;
    const auto length = [&](int from, int to, int step) {
      double sum = 0;
      for (int i = from; i < to; i += step) sum += Length(Cartesian(net, i + step) - Cartesian(net, i));
      return sum;
    };
    const double u = std::max(length(0, last_u, net.stride()), length(last_v, last_u + last_v, net.stride())),
                 v = std::max(length(0, last_v, 1), length(last_u, last_u + last_v, 1));
    return u >= v ? Direction::kU : Direction::kV;
  }

  // The control points of the four corners: (u, v) = (0, 0), (1, 0), (0, 1) and (1, 1).
  static std::array<Vec3, 4> CornersOf(const BezierNet& net) {
    const int last_u = net.degree_u * net.stride(), last_v = net.degree_v;
    return {Cartesian(net, 0), Cartesian(net, last_u), Cartesian(net, last_v),
            Cartesian(net, last_u + last_v)};
  }
  // The unit normal of the corners; zero if they have none.
  static Vec3 NormalOf(const BezierNet& net) {
    const auto [p00, p10, p01, p11] = CornersOf(net);
    return UnitOrZero(Cross(p11 - p00, p01 - p10));
  }
  static Vec3 UnitOrZero(Vec3 v) {
    const double length = Length(v);
    return length > 0 ? (1 / length) * v : Vec3{0, 0, 0};
  }
  // The slab across a unit vector that holds all control points.
  static SlabOfSpace SlabOf(const BezierNet& net, Vec3 normal) {
    SlabOfSpace slab{normal, INFINITY, -INFINITY};
    for (int i = 0; i < net.points(); ++i) {
      const double at = Dot(normal, Cartesian(net, i));
      slab.near = std::min(slab.near, at);
      slab.far = std::max(slab.far, at);
    }
    return slab;
  }

  // Whether the three slabs hold little more than the piece: one across its normal, and two across the sides of the
  // parallelogram that its corners make.
  static bool IsFlat(const BezierNet& net, std::array<SlabOfSpace, 3>* slabs) {
    const auto [p00, p10, p01, p11] = CornersOf(net);
    if (!(Length((p11 - p01) - (p10 - p00)) <= kFlat)) return false;
    const Vec3 normal = NormalOf(net);
    (*slabs)[0] = SlabOf(net, normal);
    if (!(Length(normal) > 0 && (*slabs)[0].far - (*slabs)[0].near <= kFlat)) return false;
    std::size_t k = 1;
    for (const auto& [along, across] : {std::pair{p10 - p00, p01 - p00}, std::pair{p01 - p00, p10 - p00}}) {
      const Vec3 side = UnitOrZero(Cross(normal, along));
      SlabOfSpace& slab = (*slabs)[k++] = SlabOf(net, side);
      if (!(Length(side) > 0 && slab.far - slab.near <= std::fabs(Dot(side, across)) + kFlat)) return false;
    }
    return true;
  }

  // Whether the normals at the corners are nearly that of the piece.
  static bool HasOneNormal(const BezierNet& net) {
    const int stride = net.stride(), m = net.degree_u, n = net.degree_v;
    const Vec3 normal = NormalOf(net);
    for (const int i : {0, m})
      for (const int j : {0, n}) {
        const Vec3 corner = Cartesian(net, i * stride + j);
        const Vec3 along_u = Cartesian(net, (i == 0 ? 1 : m - 1) * stride + j) - corner,
                   along_v = Cartesian(net, i * stride + (j == 0 ? 1 : n - 1)) - corner;
        const Vec3 at = UnitOrZero(Cross(along_u, along_v));
        constexpr double kMostSine = 0.02;
        if (!(Length(at) > 0 && Length(Cross(at, normal)) <= kMostSine)) return false;
      }
    return true;
  }

  // Marks the voxels that meet the box and each of the slabs.
  void MarkMet(const Box3& box, std::span<const SlabOfSpace> slabs) {
    double Vec3::*const axes[] = {&Vec3::x, &Vec3::y, &Vec3::z};
    const int sizes[] = {grid_.size.x, grid_.size.y, grid_.size.z};
    int low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::max(static_cast<int>(std::floor(box.low.*axes[k] - kSlack)), 0);
      high[k] = std::min(static_cast<int>(std::floor(box.high.*axes[k] + kSlack)), sizes[k] - 1);
    }
    // Lines of voxels run along the axis that is nearest to the normal.
    const Vec3 normal = slabs[0].normal;
    const Vec3 size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
    const int c = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    const std::uint32_t code = NormalCode(outward_ * normal);
    int at[3];
    for (at[a] = low[a]; at[a] <= high[a]; ++at[a])
      for (at[b] = low[b]; at[b] <= high[b]; ++at[b]) {
        int begin = low[c], end = high[c];
        for (const SlabOfSpace& slab : slabs) {
          const Vec3& n = slab.normal;
          const double half = 0.5 * (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z)) + kSlack;
          const double first = n.*axes[a] * (at[a] + 0.5) + n.*axes[b] * (at[b] + 0.5) + 0.5 * n.*axes[c];
          MeetLine(slab.near - half - first, slab.far + half - first, n.*axes[c], &begin, &end);
        }
        for (at[c] = begin; at[c] <= end; ++at[c]) Add(at, code);
      }
  }

  // Restricts begin … end to the numbers z with low ≤ slope·z ≤ high.
  static void MeetLine(double low, double high, double slope, int* begin, int* end) {
    constexpr double kNoSlope = 1e-15;
    if (std::fabs(slope) < kNoSlope) {
      if (low > 0 || high < 0) *end = *begin - 1;
      return;
    }
    double first = low / slope, last = high / slope;
    if (first > last) std::swap(first, last);
    if (first > *end || last < *begin) {
      *end = *begin - 1;
      return;
    }
    *begin = std::max(*begin, static_cast<int>(std::ceil(std::max(first, -1.0))));
    *end = std::min(*end, static_cast<int>(std::floor(std::min(last, double{kMostVoxelsPerAxis}))));
  }

  void Add(const int (&at)[3], std::uint32_t normal) {
    const Mark mark{static_cast<std::uint16_t>(at[0]), static_cast<std::uint16_t>(at[1]),
                    static_cast<std::uint16_t>(at[2]), placed_face_, normal};
    // Neighbouring pieces mostly touch the same voxels, with nearly the same normal.
    if (!marks.empty() && marks.back().placed_face == placed_face_ &&
        std::tie(marks.back().x, marks.back().y, marks.back().z) == std::tie(mark.x, mark.y, mark.z))
      return;
    marks.push_back(mark);
  }

  const Scene::Data& scene_;
  const NetOperations& nets_;
  const VoxelGrid& grid_;
  std::atomic<std::uint64_t>* total_;
  const std::uint64_t most_marks_;
  const bool details_;
  const FaceData* face_ = nullptr;
  std::uint32_t placed_face_ = 0;
  double outward_ = 1;  // −1: the outward normal is that against Su × Sv
  const SpanParameter *u_map_ = nullptr, *v_map_ = nullptr;
  std::vector<std::unique_ptr<OwnedNet>> levels_;
};

Result<std::vector<TouchedSlab>> Find(const Scene& scene, const VoxelGrid& grid, const TouchOptions& options,
                                      const Execution& execution) {
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels.ok()) return kernels.error();
  const Model& model = scene.model();
  struct Task {
    std::uint32_t instance, face, placed_face;
  };
  std::vector<Task> tasks;
  for (std::uint32_t instance = 0; instance < model.instances.size(); ++instance)
    for (const PlacedFace face : WalkPlacedFaces(model, model.instances[instance]))
      tasks.push_back({instance, face.face, face.id});
  // A mark is kept twice while the slabs are made.
  const std::uint64_t most_marks = options.max_bytes / (sizeof(Mark) + sizeof(TouchedVoxel));
  std::atomic<std::uint64_t> marks{0};
  std::atomic<bool> full{false};
  PerThread<Toucher> touchers([&] {
    return Toucher(scene.data(), *kernels.value().nets, grid, &marks, most_marks, options.details);
  });
  ParallelFor(std::size_t{0}, tasks.size(), [&](std::size_t i) {
    if (execution.cancelled() || full) return;
    const Task& task = tasks[i];
    if (!touchers.local().Touch(model.instances[task.instance].placement, task.face, task.placed_face))
      full = true;
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while marking voxels"};
  if (full)
    return Error{ErrorCode::kLimitExceeded, "the voxels that the surfaces touch need more than " +
                                                std::to_string(options.max_bytes >> 20) +
                                                " MB; use fewer voxels, or raise --max-view-memory"};
  std::vector<TouchedSlab> slabs(static_cast<std::size_t>(grid.size.x));
  for (Toucher& toucher : touchers) {
    for (const Mark& mark : toucher.marks)
      slabs[mark.x].push_back({mark.y, mark.z, mark.placed_face, mark.normal});
    std::vector<Mark>().swap(toucher.marks);
  }
  ParallelFor(std::size_t{0}, slabs.size(), [&](std::size_t x) { SortTouched(&slabs[x], options.details); });
  return slabs;
}

}  // namespace

std::uint32_t NormalCode(Vec3 normal) {
  const double sum = std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z);
  if (!(sum > 0)) return 0;
  double u = normal.x / sum, v = normal.y / sum;
  if (normal.z < 0) {
    const double folded = std::copysign(1 - std::fabs(v), u);
    v = std::copysign(1 - std::fabs(u), v);
    u = folded;
  }
  // −1 … 1 onto 1 … 65535, so that no code is 0.
  const auto code = [](double t) { return static_cast<std::uint32_t>(std::lround((t + 1) * 32767) + 1); };
  return code(u) << 16 | code(v);
}

Vec3 NormalOfCode(std::uint32_t code) {
  if (code == 0) return {0, 0, 0};
  const auto value = [](std::uint32_t bits) { return (double(bits) - 1) / 32767 - 1; };
  double u = value(code >> 16), v = value(code & 0xffff);
  const double z = 1 - std::fabs(u) - std::fabs(v);
  if (z < 0) {
    const double folded = std::copysign(1 - std::fabs(v), u);
    v = std::copysign(1 - std::fabs(u), v);
    u = folded;
  }
  return Normalized({u, v, z});
}

void SortTouched(TouchedSlab* slab, bool details) {
  std::sort(slab->begin(), slab->end(), [](const TouchedVoxel& a, const TouchedVoxel& b) {
    return std::tie(a.y, a.z, a.placed_face, a.normal) < std::tie(b.y, b.z, b.placed_face, b.normal);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < slab->size();) {
    // The entries of a voxel's lowest face come first.
    const TouchedVoxel first = (*slab)[i];
    Vec3 sum = NormalOfCode(first.normal);
    std::size_t k = i + 1;
    for (; k < slab->size(); ++k) {
      const TouchedVoxel &other = (*slab)[k], &before = (*slab)[k - 1];
      if (other.y != first.y || other.z != first.z) break;
      if (other.placed_face != first.placed_face) {
        if (details) break;
        continue;
      }
      if (details && other.normal != before.normal) sum = sum + NormalOfCode(other.normal);
    }
    (*slab)[kept] = first;
    if (details) (*slab)[kept].normal = NormalCode(sum);
    ++kept;
    i = k;
  }
  slab->resize(kept);
  slab->shrink_to_fit();
}

Result<std::vector<TouchedSlab>> FindTouchedVoxels(const Scene& scene, const VoxelGrid& grid,
                                                   const TouchOptions& options, const Execution& execution) {
  std::optional<Result<std::vector<TouchedSlab>>> result;
  RunWithThreads(execution.threads, [&] { result = Find(scene, grid, options, execution); });
  return *std::move(result);
}

}  // namespace facetless
