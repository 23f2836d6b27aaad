#include "render/baseline/smooth_normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <span>

#include "render/base/vec.h"

namespace facetless {
namespace {

constexpr std::size_t kPairwiseLimit = 64;  // law 3

Vec3 ToDouble(const std::array<float, 3>& p) {
  return {p[0], p[1], p[2]};
}

struct Corners {
  std::vector<std::array<float, 3>> positions;  // of corner 3·t + k, with −0 made +0
  std::vector<Vec3> normals;                    // unit, per triangle; zero without area
  std::vector<double> angles;                   // per corner, radians
};

Corners Gather(const MeshPart& part) {
  Corners corners;
  const std::size_t count = part.triangles.size();
  corners.positions.reserve(3 * count);
  corners.normals.reserve(count);
  corners.angles.reserve(3 * count);
  for (const auto& triangle : part.triangles) {
    Vec3 p[3];
    for (int k = 0; k < 3; ++k) {
      std::array<float, 3> position = part.positions[triangle[k]];
      for (float& coordinate : position) coordinate += 0.0f;
      corners.positions.push_back(position);
      p[k] = ToDouble(position);
    }
    corners.normals.push_back(Normalized(Cross(p[1] - p[0], p[2] - p[0])));
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
      corners.angles.push_back(std::atan2(Length(Cross(a, b)), Dot(a, b)));
    }
  }
  return corners;
}

class GroupNormals {
 public:
  GroupNormals(const Corners& corners, double cos_crease, std::vector<Vec3>& out)
      : corners_(corners), cos_crease_(cos_crease), out_(out) {}

  // Computes the normals of the corners at one position.
  void Solve(std::span<const std::uint32_t> group) {
    if (group.size() <= kPairwiseLimit) {
      for (std::uint32_t own : group) out_[own] = Normalized(SumAround(group, TriangleNormal(own)));
      return;
    }
    // Assign each corner to the first group leader within the crease angle.
    leaders_.clear();
    sums_.clear();
    assigned_.clear();
    for (std::uint32_t corner : group) {
      const Vec3 normal = TriangleNormal(corner);
      std::size_t leader = 0;
      while (leader < leaders_.size() && !(Dot(leaders_[leader], normal) >= cos_crease_)) ++leader;
      if (leader == leaders_.size() && leader < kPairwiseLimit) {
        leaders_.push_back(normal);
        sums_.push_back({});
      }
      assigned_.push_back(leader);
      if (leader < sums_.size()) sums_[leader] = sums_[leader] + corners_.angles[corner] * normal;
    }
    for (std::size_t i = 0; i < group.size(); ++i)
      out_[group[i]] =
          assigned_[i] < sums_.size() ? Normalized(sums_[assigned_[i]]) : TriangleNormal(group[i]);
  }

 private:
  Vec3 TriangleNormal(std::uint32_t corner) const { return corners_.normals[corner / 3]; }

  Vec3 SumAround(std::span<const std::uint32_t> group, Vec3 own) const {
    const bool flat = Dot(own, own) > 0;
    Vec3 sum;
    for (std::uint32_t other : group) {
      const Vec3 normal = TriangleNormal(other);
      if (!flat || Dot(own, normal) >= cos_crease_) sum = sum + corners_.angles[other] * normal;
    }
    return sum;
  }

  const Corners& corners_;
  const double cos_crease_;
  std::vector<Vec3>& out_;
  std::vector<Vec3> leaders_, sums_;
  std::vector<std::size_t> assigned_;
};

}  // namespace

void MakeSmoothNormals(MeshPart& part, double crease_deg) {
  const Corners corners = Gather(part);
  std::vector<std::uint32_t> order(corners.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return corners.positions[a] != corners.positions[b] ? corners.positions[a] < corners.positions[b] : a < b;
  });

  // Process each run of equal positions, and make a vertex for each distinct normal.
  std::vector<Vec3> normals(order.size());
  GroupNormals solver(corners, std::cos(crease_deg * (std::numbers::pi / 180)), normals);
  part.positions.clear();
  part.normals.clear();
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && corners.positions[order[end]] == corners.positions[order[begin]]) ++end;
    solver.Solve(std::span(order).subspan(begin, end - begin));
    const std::size_t first_vertex = part.positions.size();
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 n = normals[order[i]];
      const std::array<float, 3> normal = {static_cast<float>(n.x), static_cast<float>(n.y),
                                           static_cast<float>(n.z)};
      // Positions mostly have few vertices, so search only the latest kPairwiseLimit of them.
      const std::size_t look_from =
          std::max(first_vertex, part.normals.size() - std::min(part.normals.size(), kPairwiseLimit));
      const auto found = std::find(part.normals.begin() + look_from, part.normals.end(), normal);
      const std::size_t vertex = found - part.normals.begin();
      if (found == part.normals.end()) {
        part.positions.push_back(corners.positions[order[begin]]);
        part.normals.push_back(normal);
      }
      part.triangles[order[i] / 3][order[i] % 3] = static_cast<std::uint32_t>(vertex);
    }
  }
}

}  // namespace facetless
