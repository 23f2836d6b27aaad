#include "render/baseline/mesh_section.h"

namespace facetless {
namespace {

// Twice the signed area that the segment in which the plane meets the triangle spans with `origin`; 0 if they
// do not meet.
double Swept(const Vec3 (&corners)[3], double side, const SectionPlane& plane, Vec3 origin) {
  double height[3];
  for (int k = 0; k < 3; ++k) height[k] = Dot(plane.normal, corners[k] - plane.point);
  // On the plane is above it: a corner that neighbours share counts for all alike.
  Vec3 ends[2];
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if ((height[k] < 0) == (height[next] < 0)) continue;
    // From the lower end on, so that both triangles of an edge find the same point.
    const int low = height[k] < 0 ? k : next, high = height[k] < 0 ? next : k;
    const double share = height[low] / (height[low] - height[high]);
    // The edge that rises comes last: with the triangle seen from outside, the solid then lies on the
    // segment's left.
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
