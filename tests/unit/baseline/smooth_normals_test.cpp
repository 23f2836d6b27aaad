#include "render/baseline/smooth_normals.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "tests/unit/baseline/meshes.h"

namespace facetless {
namespace {

double AngleDeg(const std::array<float, 3>& a, Vec3 b) {
  const Vec3 u{a[0], a[1], a[2]};
  return std::atan2(Length(Cross(u, b)), Dot(u, b)) * 180 / 3.14159265358979323846;
}

TEST(SmoothNormals, ASphereWithoutIndicesBecomesSmooth) {
  MeshPart soup = testing::SphereMesh(10, 64, 32);
  soup.normals.clear();
  MakeSmoothNormals(soup, 40);
  ASSERT_EQ(soup.normals.size(), soup.positions.size());
  EXPECT_EQ(soup.positions.size(), 64u * 31 + 2) << "each position once";
  for (std::size_t i = 0; i < soup.positions.size(); ++i) {
    const auto& p = soup.positions[i];
    EXPECT_LT(AngleDeg(soup.normals[i], {p[0], p[1], p[2]}), 0.5) << i;
  }
}

TEST(SmoothNormals, ABoxKeepsItsEdges) {
  MeshPart box = testing::BoxMesh({1, 2, 3});
  const MeshPart before = box;
  MakeSmoothNormals(box, 40);
  EXPECT_EQ(box.positions.size(), 24u) << "three normals per corner";
  for (std::size_t t = 0; t < box.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto& n = before.normals[before.triangles[t][k]];
      EXPECT_LT(AngleDeg(box.normals[box.triangles[t][k]], {n[0], n[1], n[2]}), 1e-3);
    }
  MakeSmoothNormals(box, 100);
  EXPECT_EQ(box.positions.size(), 8u) << "one normal per corner where everything is smooth";
}

TEST(SmoothNormals, WeighsByAngleAndNotByTheNumberOfTriangles) {
  // A corner of a cube whose three sides have one, two and four triangles. The normal must still point along
  // the diagonal.
  MeshPart part;
  const auto fan = [&](Vec3 a, Vec3 b, int pieces) {
    for (int i = 0; i < pieces; ++i) {
      const double t0 = 1.5707963267948966 * i / pieces, t1 = 1.5707963267948966 * (i + 1) / pieces;
      const Vec3 p = std::cos(t0) * a + std::sin(t0) * b, q = std::cos(t1) * a + std::sin(t1) * b;
      const std::uint32_t base = static_cast<std::uint32_t>(part.positions.size());
      for (Vec3 v : {Vec3{}, p, q})
        part.positions.push_back({static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
      part.triangles.push_back({base, base + 1, base + 2});
    }
  };
  fan({1, 0, 0}, {0, 1, 0}, 1);
  fan({0, 1, 0}, {0, 0, 1}, 2);
  fan({0, 0, 1}, {1, 0, 0}, 4);
  part.face_of_triangle.assign(part.triangles.size(), 0);
  MakeSmoothNormals(part, 180);
  EXPECT_LT(AngleDeg(part.normals[part.triangles[0][0]], {1, 1, 1}), 1e-4);
}

TEST(SmoothNormals, ManyTrianglesAroundOnePointTakeNoQuadraticTime) {
  // Half a million triangles around the origin, all with different tilts. Comparing all pairs would take
  // hours.
  MeshPart part;
  for (int i = 0; i < 500000; ++i) {
    const float z = static_cast<float>(i % 1000) * 1e-3f;
    const std::uint32_t base = static_cast<std::uint32_t>(part.positions.size());
    part.positions.push_back({0, 0, 0});
    part.positions.push_back({1, static_cast<float>(i), z});
    part.positions.push_back({static_cast<float>(-i), 1, z});
    part.triangles.push_back({base, base + 1, base + 2});
  }
  part.face_of_triangle.assign(part.triangles.size(), 0);
  const auto start = std::chrono::steady_clock::now();
  MakeSmoothNormals(part, 1);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
  for (const auto& triangle : part.triangles)
    for (std::uint32_t vertex : triangle) ASSERT_LT(vertex, part.positions.size());
}

TEST(SmoothNormals, TrianglesWithoutAreaGiveNoNan) {
  MeshPart part;
  part.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  part.triangles = {{0, 1, 2}, {0, 1, 3}};
  part.face_of_triangle = {0, 0};
  MakeSmoothNormals(part, 40);
  for (const auto& n : part.normals)
    for (float coordinate : n) EXPECT_TRUE(std::isfinite(coordinate));
  EXPECT_LT(AngleDeg(part.normals[part.triangles[0][0]], {0, 0, 1}), 1e-3) << "takes what the neighbour has";
}

}  // namespace
}  // namespace facetless
