#include "render/inspect/thickness.h"

#include <cmath>
#include <map>
#include <utility>

#include "render/base/parallel.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

// The distance up to which a crossing counts as the starting point. Newton's method is accurate to about
// 2^-46 of the coordinates; a crossing 2^18 times as far away belongs to another surface.
constexpr double kLeastShare = 0x1p-28;

// The vector that the linear part of the placement maps to `v`; zero if it is singular.
Vec3 Unplaced(const Placement& placement, Vec3 v) {
  const auto& m = placement.m;
  const Vec3 row[3] = {{m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
  const double determinant = placement.Determinant();
  if (!(determinant != 0)) return {};
  return (1 / determinant) *
         (v.x * Cross(row[1], row[2]) + v.y * Cross(row[2], row[0]) + v.z * Cross(row[0], row[1]));
}

}  // namespace

Thickness::Thickness(const Scene& scene, const std::vector<SurfaceEval>& surfaces,
                     const std::vector<bool>& shown)
    : surfaces_(surfaces), tree_of_face_(surfaces.size(), kNoIndex) {
  // Collect the faces of each solid that has a shown face.
  const Model& model = scene.model();
  std::vector<std::vector<std::uint32_t>> groups;
  for (std::uint32_t part = 0; part < model.parts.size(); ++part) {
    std::map<std::uint32_t, std::vector<std::uint32_t>> solids;
    for (const std::uint32_t face : Indices(model.parts[part].faces))
      solids[model.faces[face].solid].push_back(face);
    for (auto& [solid, members] : solids) {
      bool wanted = false;
      for (std::uint32_t face : members) wanted = wanted || shown[face];
      if (!wanted) continue;
      for (std::uint32_t face : members) tree_of_face_[face] = static_cast<std::uint32_t>(groups.size());
      groups.push_back(std::move(members));
    }
  }
  trees_.resize(groups.size());
  ParallelFor(std::size_t{0}, groups.size(), [&](std::size_t i) {
    trees_[i] = std::make_unique<const SolidTree>(scene, surfaces, groups[i]);
  });
}

std::optional<double> Thickness::At(std::uint32_t face, const Placement& placement, double u, double v,
                                    Vec3 outward) const {
  if (tree_of_face_[face] == kNoIndex) return std::nullopt;
  const SolidTree& tree = *trees_[tree_of_face_[face]];
  // In part coordinates, the direction is not a unit vector, so t is still the distance in placed
  // millimetres.
  const Vec3 inward = Unplaced(placement, -outward);
  const double length = Length(inward);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  const double t_least = kLeastShare * tree.bounds().diagonal() / length;
  const std::optional<SolidHit> hit = tree.Nearest(surfaces_[face].Position(u, v), inward, t_least);
  if (!hit) return std::nullopt;
  return hit->t;
}

std::size_t Thickness::pieces() const {
  std::size_t sum = 0;
  for (const auto& tree : trees_) sum += tree->pieces();
  return sum;
}

}  // namespace facetless
