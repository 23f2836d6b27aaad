// The point at which a ray meets a triangle that Embree found, computed in double. Private to render/baseline. The
// functions are inline, because they are called for each ray.
//
//     const TriangleCorners corners = LoadCorners(data, node, triangle);
//     const TrianglePoint point = MeetTriangle(corners, origin, direction);
//
//  1. The weights of the corners are computed from signed volumes. If the ray misses the triangle, by an error of
//     float32, the weights are those of a point on its border. If the ray sees the triangle exactly edge-on, they are
//     those of its middle.
//  2. The normal is interpolated from the corners. If it points to the other side of the ray than its triangle, it is
//     rotated until it is perpendicular to the ray (tracer.h, law 3).
#pragma once

#include <algorithm>
#include <cstdint>

#include "render/baseline/scene_data.h"

namespace facetless {

// A placed triangle.
struct TriangleCorners {
  Vec3 position[3];  // mm, model axes
  Vec3 normal[3];    // normals of the corners; not unit vectors
  double side;       // PlacedNode::side
  // A vector that is perpendicular to the triangle and points outward by its orientation; not a unit vector.
  Vec3 Facing() const { return side * Cross(position[1] - position[0], position[2] - position[0]); }
};

inline TriangleCorners LoadCorners(const BaselineScene::Data& data, std::uint32_t node_index,
                                   std::uint32_t triangle) {
  const MeshPart& part = data.mesh->parts[data.mesh->nodes[node_index].part];
  const PlacedNode& placed = data.nodes[node_index];
  TriangleCorners corners;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t vertex = part.triangles[triangle][k];
    const auto& p = part.positions[vertex];
    const auto& n = part.normals[vertex];
    corners.position[k] = placed.placement.Point({p[0], p[1], p[2]});
    const Vec3 normal{n[0], n[1], n[2]};
    corners.normal[k] = {Dot(placed.normal_rows[0], normal), Dot(placed.normal_rows[1], normal),
                         Dot(placed.normal_rows[2], normal)};
  }
  corners.side = placed.side;
  return corners;
}

inline std::uint32_t PlacedFaceOf(const BaselineScene::Data& data, std::uint32_t node_index,
                                  std::uint32_t triangle) {
  const MeshNode& node = data.mesh->nodes[node_index];
  return node.first_placed_face + data.mesh->parts[node.part].face_of_triangle[triangle];
}

struct TrianglePoint {
  double weight[3];  // weights of the corners, 0 … 1; their sum is 1
  Vec3 normal;       // unit vector
};

// Returns the point of the ray in the triangle (laws 1 and 2). `origin` is a point of the ray near the mesh, mm, model
// axes; `direction` may have any length above 0.
inline TrianglePoint MeetTriangle(const TriangleCorners& corners, Vec3 origin, Vec3 direction) {
  const Vec3 q[3] = {corners.position[0] - origin, corners.position[1] - origin,
                     corners.position[2] - origin};
  TrianglePoint point;
  double sum = 0;
  for (int k = 0; k < 3; ++k) point.weight[k] = Dot(direction, Cross(q[(k + 1) % 3], q[(k + 2) % 3]));
  for (const double share : point.weight) sum += share;
  const double sign = sum < 0 ? -1 : 1;
  sum = 0;
  for (double& share : point.weight) sum += share = std::max(sign * share, 0.0);

  // A triangle that is seen exactly edge-on has no volume; its middle is used.
  for (int k = 0; k < 3; ++k) {
    point.weight[k] = sum > 0 ? point.weight[k] / sum : 1.0 / 3;
    point.normal = point.normal + point.weight[k] * corners.normal[k];
  }
  Vec3 facing = corners.Facing();
  point.normal = Normalized(point.normal);
  if (!(Dot(point.normal, point.normal) > 0)) point.normal = Normalized(facing);
  if (Dot(facing, point.normal) < 0) facing = -facing;
  const double along = Dot(point.normal, direction);
  if (along * Dot(facing, direction) < 0)
    point.normal = Normalized(point.normal - (along / Dot(direction, direction)) * direction);
  return point;
}

}  // namespace facetless
