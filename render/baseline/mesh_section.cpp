#include "render/baseline/mesh_section.h"

namespace facetless {
namespace {

// Twice the signed area of the triangle of `origin` and the segment in which the plane cuts the triangle; 0
// if there is no such segment.
double Swept(const Vec3 (&corners)[3], double side, const SectionPlane& plane, Vec3 origin) {
  double height[3];
  for (int k = 0; k < 3; ++k) height[k] = Dot(plane.normal, corners[k] - plane.point);
  // Count a corner on the plane as above it, so that all triangles that share the corner agree.
  Vec3 ends[2];
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if ((height[k] < 0) == (height[next] < 0)) continue;
    // Interpolate from the lower end, so that both triangles of an edge compute the same point.
    const int low = height[k] < 0 ? k : next, high = height[k] < 0 ? next : k;
    const double share = height[low] / (height[low] - height[high]);
    // The point on the rising edge comes second. If the triangle is seen from outside, the solid then lies to
    // the left of the segment.
    ends[height[k] < 0 ? 1 : 0] = corners[low] + share * (corners[high] - corners[low]) - origin;
    ++count;
  }
  return count == 2 ? side * Dot(plane.normal, Cross(ends[0], ends[1])) : 0;
}

}  // namespace

double MeshSectionArea(const Mesh& mesh, const SectionPlane& plane) {
  double twice = 0;
  for (const MeshNode& node : mesh.nodes) {
    const MeshPart& part = mesh.parts[node.part];
    const double side = node.placement.Determinant() < 0 ? -1 : 1;
    const Vec3 origin{node.placement.m[0][3], node.placement.m[1][3], node.placement.m[2][3]};
    for (const auto& triangle : part.triangles) {
      Vec3 corners[3];
      for (int k = 0; k < 3; ++k) {
        const auto& p = part.positions[triangle[k]];
        corners[k] = node.placement.Point({p[0], p[1], p[2]});
      }
      twice += Swept(corners, side, plane, origin);
    }
  }
  return 0.5 * twice;
}

}  // namespace facetless
