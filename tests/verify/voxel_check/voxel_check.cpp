#include "tests/verify/voxel_check/voxel_check.h"

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "render/base/stopwatch.h"
#include "render/view/section.h"
#include "render/voxels/near_faces.h"
#include "render/voxels/voxelize.h"
#include "tests/verify/differential/differential.h"
#include "tests/verify/oracle/oracle.h"

namespace facetless {
namespace {

// Whether a point is inside a closed solid, by the crossings above it; nothing if one of them is in doubt.
class ParityOracle {
 public:
  explicit ParityOracle(const Model& model)
      : oracle_(model), solids_(model), slack_mm_(1e-9 * model.Diagonal()) {}

  std::optional<bool> IsInside(Vec3 point) const {
    oracle::ViewRay ray;
    ray.origin = ray.eye = {point.x, point.y, point.z};
    ray.direction = ray.forward = {0, 0, 1};
    ray.across = {1, 0, 0};
    ray.down = {0, 1, 0};
    std::map<std::uint32_t, int> crossings;
    for (const oracle::Crossing& crossing : oracle_.Crossings(ray, -slack_mm_)) {
      const std::uint32_t solid = solids_.ClosedSolidOfFace(crossing.placed_face);
      if (solid == kNoIndex || crossing.standing == oracle::Standing::kOutside) continue;
      if (!crossing.proven || crossing.standing == oracle::Standing::kUnsure || crossing.depth < slack_mm_)
        return std::nullopt;
      ++crossings[solid];
    }
    return std::any_of(crossings.begin(), crossings.end(),
                       [](const auto& entry) { return entry.second % 2 == 1; });
  }

 private:
  const oracle::Oracle oracle_;
  const SectionSolids solids_;
  const double slack_mm_;
};

class Checker {
 public:
  Checker(ComparedFile& file, const Voxels& voxels, const NearFaces& touched,
          const VoxelCheckOptions& options, VoxelCheck* check)
      : file_(file),
        voxels_(voxels),
        touched_(touched),
        options_(options),
        check_(*check),
        parity_(file.model),
        random_(options.seed) {}

  void CheckFar() {
    const Stopwatch stopwatch;
    for (int i = 0; i < options_.far; ++i) {
      const std::optional<VoxelPoint> at =
          Draw([&](VoxelPoint p) { return touched_.At(p).empty() && (i % 2 == 0 || IsBesideTouched(p)); });
      if (!at) break;
      const bool ours = Count(*at, &check_.far);
      const std::optional<bool> theirs = file_.reference.IsInside(Centre(*at), 1e-7);
      if (!theirs) ++check_.far.undecided;
      if (!theirs || *theirs == ours) continue;
      const std::optional<bool> truth = parity_.IsInside(Centre(*at));
      if (!truth) {
        ++check_.far.undecided;
      } else if (*truth == ours) {
        ++check_.far.reference_wrong;
      } else {
        Wrong(*at, ours, &check_.far);
      }
    }
    check_.far_ms = stopwatch.Milliseconds();
  }

  void CheckNear() {
    const Stopwatch stopwatch;
    for (int i = 0; i < options_.near; ++i) {
      const std::optional<VoxelPoint> at = Draw([&](VoxelPoint p) { return !touched_.At(p).empty(); });
      if (!at) break;
      const bool ours = Count(*at, &check_.near);
      const std::optional<bool> truth = parity_.IsInside(Centre(*at));
      if (!truth) {
        ++check_.near.undecided;
      } else if (*truth != ours) {
        Wrong(*at, ours, &check_.near);
      }
    }
    check_.near_ms = stopwatch.Milliseconds();
  }

 private:
  Vec3 Centre(VoxelPoint at) const { return voxels_.grid.Center(at); }

  // A random voxel that is as wanted; nothing if there seems to be none.
  template <typename Wanted>
  std::optional<VoxelPoint> Draw(const Wanted& wanted) {
    const VoxelPoint n = voxels_.grid.size;
    const auto index = [&](int size) { return std::uniform_int_distribution<int>(0, size - 1)(random_); };
    constexpr int kMostTries = 100000;
    for (int i = 0; i < kMostTries; ++i) {
      const VoxelPoint p{index(n.x), index(n.y), index(n.z)};
      if (wanted(p)) return p;
    }
    return std::nullopt;
  }

  bool IsBesideTouched(VoxelPoint p) const {
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          if (!touched_.At({p.x + dx, p.y + dy, p.z + dz}).empty()) return true;
    return false;
  }

  // Counts a centre. Returns whether the voxels say that it is inside.
  bool Count(VoxelPoint at, VoxelCheckCount* count) const {
    const bool inside = voxels_.model.Get(at.x, at.y, at.z).filled();
    ++count->centres;
    count->inside += inside;
    return inside;
  }

  void Wrong(VoxelPoint at, bool ours, VoxelCheckCount* count) {
    ++count->wrong;
    const auto text = [](int a, int b, int c) {
      return std::to_string(a) + ", " + std::to_string(b) + ", " + std::to_string(c);
    };
    if (check_.first_wrong.empty())
      check_.first_wrong = "the centre of voxel (" + text(at.x, at.y, at.z) + ") is " +
                           (ours ? "outside, but filled" : "inside, but empty");
  }

  ComparedFile& file_;
  const Voxels& voxels_;
  const NearFaces& touched_;
  const VoxelCheckOptions& options_;
  VoxelCheck& check_;
  const ParityOracle parity_;
  std::mt19937 random_;
};

}  // namespace

Result<VoxelCheck> CheckVoxels(const std::string& path, const VoxelCheckOptions& options) {
  Result<ComparedFile> file = LoadBoth(path, false);
  if (!file.ok()) return file.error();
  const Scene scene(file.value().model);
  const Result<VoxelGrid> grid = GridOfResolution(file.value().model.bounds, options.resolution);
  if (!grid.ok()) return grid.error();
  const Stopwatch stopwatch;
  const Result<Voxels> voxels = Voxelize(scene, grid.value(), {}, {});
  if (!voxels.ok()) return voxels.error();
  VoxelCheck check;
  check.voxelize_ms = stopwatch.Milliseconds();
  check.solids = voxels.value().stats.solids;
  check.open_faces = voxels.value().stats.open_faces;
  check.filled = voxels.value().model.Count();
  if (check.solids == 0 || file.value().reference.solid_count() == 0)
    return Error{ErrorCode::kNothingUsable, path + ": no closed solid, so that no voxel centre is inside"};
  Result<std::vector<TouchedSlab>> touched =
      FindTouchedVoxels(scene, grid.value(), {.max_bytes = std::uint64_t{4} << 30, .details = true}, {});
  if (!touched.ok()) return touched.error();
  const NearFaces faces(std::move(touched).value(), grid.value().size.y);
  Checker checker(file.value(), voxels.value(), faces, options, &check);
  checker.CheckFar();
  checker.CheckNear();
  return check;
}

}  // namespace facetless
