// The deviation of triangles from surfaces whose distance to a triangle has a closed form.
#include "render/compare/mesh_deviation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include <nlohmann/json.hpp>

#include "render/nurbs/surface_eval.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

constexpr double kPi = 3.14159265358979323846;

// The triangles of a sphere or a torus, n × n, from a map of (u, v) to points.
template <typename Map>
Mesh Tessellated(const Map& map, int n, double u0, double u1, double v0, double v1) {
  Mesh mesh;
  mesh.from_model = true;
  MeshPart part;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const Vec3 p = map(u0 + (u1 - u0) * i / n, v0 + (v1 - v0) * j / n);
      part.positions.push_back({float(p.x), float(p.y), float(p.z)});
    }
  }
  const auto at = [&](int i, int j) { return std::uint32_t(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      part.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      part.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  part.face_of_triangle.assign(part.triangles.size(), 0);
  mesh.parts.push_back(std::move(part));
  mesh.nodes.emplace_back();
  return mesh;
}

// Computes law 1 with an exact distance.
template <typename Distance>
void ExpectDeviations(const Mesh& mesh, const MeshDeviation& deviation, const Distance& distance) {
  const MeshPart& part = mesh.parts[0];
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k) {
      const auto& p = part.positions[part.triangles[i][k]];
      corner[k] = {p[0], p[1], p[2]};
    }
    double largest = 0;
    for (const Vec3 p : {(1.0 / 3) * (corner[0] + corner[1] + corner[2]), 0.5 * (corner[0] + corner[1]),
                         0.5 * (corner[1] + corner[2]), 0.5 * (corner[2] + corner[0])})
      if (std::fabs(distance(p)) > std::fabs(largest)) largest = distance(p);
    // The result is float32, and so are points at radius 10. The sign of smaller values is random.
    EXPECT_NEAR(std::fabs(deviation.parts[0][i]), std::fabs(largest), 1e-6) << i;
    if (std::fabs(largest) > 1e-6) {
      EXPECT_EQ(std::signbit(deviation.parts[0][i]), std::signbit(largest)) << i;
    }
  }
}

TEST(MeshDeviation, OfASphereIsTheDistanceToItsCentre) {
  const Model model = testing::ModelOf({testing::Sphere({1, 2, 3}, 10)});
  const Mesh mesh = Tessellated(
      [](double u, double v) {
        return Vec3{1 + 10 * std::cos(u) * std::cos(v), 2 + 10 * std::sin(u) * std::cos(v),
                    3 + 10 * std::sin(v)};
      },
      24, 0, 2 * kPi, -kPi / 2, kPi / 2);
  const auto deviation = MeasureMeshDeviation(model, mesh, {});
  ASSERT_TRUE(deviation.ok()) << deviation.error().message;
  ExpectDeviations(mesh, deviation.value(), [](Vec3 p) { return Length(p - Vec3{1, 2, 3}) - 10; });
  // The value is the sagitta of a chord at the equator, where the quads are largest.
  EXPECT_NEAR(deviation.value().largest_mm, 10 * (1 - std::cos(kPi / 24)), 0.1);
}

TEST(MeshDeviation, OfATorusIsInsideAndOutside) {
  const Model model = testing::ModelOf({testing::Torus({0, 0, 0}, 10, 3)});
  const Mesh mesh = Tessellated(
      [](double u, double v) {
        const double r = 10 + 3 * std::cos(v);
        return Vec3{r * std::cos(u), r * std::sin(u), 3 * std::sin(v)};
      },
      20, 0, 2 * kPi, 0, 2 * kPi);
  const auto deviation = MeasureMeshDeviation(model, mesh, {});
  ASSERT_TRUE(deviation.ok());
  ExpectDeviations(mesh, deviation.value(),
                   [](Vec3 p) { return std::hypot(std::hypot(p.x, p.y) - 10, p.z) - 3; });
  int outside = 0;
  for (const float value : deviation.value().parts[0]) outside += value > 0;
  EXPECT_GT(outside, 10) << "the inner side of a torus bends the other way";
}

TEST(MeshDeviation, OfAPlacedPartIsThatOfThePrototype) {
  // The instance is turned, mirrored and moved; the mesh has a centre of its own.
  Model model = testing::ModelOf({testing::Sphere({1, 2, 3}, 10)});
  Placement placed;
  const double turned[3][4] = {{0, -1, 0, 70}, {-1, 0, 0, -20}, {0, 0, 1, 500}};
  std::copy(&turned[0][0], &turned[0][0] + 12, &placed.m[0][0]);
  testing::Place(&model, placed);
  Mesh mesh = Tessellated(
      [](double u, double v) {
        return Vec3{10 * std::cos(u) * std::cos(v), 10 * std::sin(u) * std::cos(v), 10 * std::sin(v)};
      },
      12, 0, 2 * kPi, -kPi / 2, kPi / 2);
  mesh.nodes[0].placement = placed;
  const Vec3 centre = placed.Point({1, 2, 3});
  mesh.nodes[0].placement.m[0][3] = centre.x;
  mesh.nodes[0].placement.m[1][3] = centre.y;
  mesh.nodes[0].placement.m[2][3] = centre.z;
  const auto deviation = MeasureMeshDeviation(model, mesh, {});
  ASSERT_TRUE(deviation.ok()) << deviation.error().message;
  ExpectDeviations(mesh, deviation.value(), [](Vec3 p) { return Length(p) - 10; });
}

// Returns the distance of a point to a surface. It tries n × n points, and then a finer grid around the
// nearest.
double ByForce(const SurfaceEval& surface, Vec3 point, int n) {
  double u0 = surface.u_begin(), u1 = surface.u_end(), v0 = surface.v_begin(), v1 = surface.v_end();
  double best = INFINITY;
  for (int round = 0; round < 12; ++round) {
    double bu = 0, bv = 0, nearest = INFINITY;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        const double u = u0 + (u1 - u0) * i / n, v = v0 + (v1 - v0) * j / n;
        const double distance = Length(surface.Position(u, v) - point);
        if (distance < nearest) nearest = distance, bu = u, bv = v;
      }
    }
    best = std::min(best, nearest);
    const double du = 4 * (u1 - u0) / n, dv = 4 * (v1 - v0) / n;
    u0 = std::max(surface.u_begin(), bu - du);
    u1 = std::min(surface.u_end(), bu + du);
    v0 = std::max(surface.v_begin(), bv - dv);
    v1 = std::min(surface.v_end(), bv + dv);
  }
  return best;
}

// Checks that every triangle has the distance that a search by force finds, and that the largest one is
// proven.
void ExpectNearest(const Model& model, const Mesh& mesh, int n, const std::string& what) {
  const auto measured = MeasureMeshDeviation(model, mesh, {});
  ASSERT_TRUE(measured.ok()) << measured.error().message;
  const MeshDeviation& deviation = measured.value();
  const SurfaceEval surface(model, 0);
  const MeshPart& part = mesh.parts[0];
  double largest_of_all = 0;
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k) {
      const auto& p = part.positions[part.triangles[i][k]];
      corner[k] = {p[0], p[1], p[2]};
    }
    double largest = 0;
    for (const Vec3 p : {(1.0 / 3) * (corner[0] + corner[1] + corner[2]), 0.5 * (corner[0] + corner[1]),
                         0.5 * (corner[1] + corner[2]), 0.5 * (corner[2] + corner[0])})
      largest = std::max(largest, ByForce(surface, p, n));
    EXPECT_NEAR(std::fabs(deviation.parts[0][i]), largest, 2e-3 * largest + 1e-6) << what << " " << i;
    largest_of_all = std::max(largest_of_all, largest);
  }
  EXPECT_NEAR(deviation.largest_mm, largest_of_all, 2e-3 * largest_of_all + 1e-6) << what;
  EXPECT_LE(deviation.largest_at_least_mm, largest_of_all * (1 + 1e-6) + 1e-6) << what;
  EXPECT_GE(deviation.largest_at_least_mm, 0.995 * largest_of_all - 1e-6) << what;
}

TEST(MeshDeviation, AtAConesApexAndASpheresPoles) {
  // A few long triangles end at the collapsed border.
  const Model cone = testing::ModelOf({testing::Frustum({0, 0, 0}, 5, 0, 8)});
  ExpectNearest(cone,
                Tessellated(
                    [](double u, double v) {
                      const double r = 5 * (1 - v / 8);
                      return Vec3{r * std::cos(u), r * std::sin(u), v};
                    },
                    5, 0, 2 * kPi, 0, 8),
                48, "cone");
  const Model sphere = testing::ModelOf({testing::Sphere({0, 0, 0}, 10)});
  ExpectNearest(
      sphere,
      Tessellated(
          [](double u, double v) {
            return Vec3{10 * std::cos(u) * std::cos(v), 10 * std::sin(u) * std::cos(v), 10 * std::sin(v)};
          },
          4, 0, 2 * kPi, -kPi / 2, kPi / 2),
      48, "sphere");
}

TEST(MeshDeviation, OfRandomPatchesWithACollapsedSideIsTheNearest) {
  std::mt19937 random(20261122);
  std::uniform_real_distribution<double> even(-1, 1);
  for (int round = 0; round < 12; ++round) {
    // Make a bicubic wavy patch with one side collapsed to a point.
    testing::PatchGrid grid;
    grid.degree_u = grid.degree_v = 3;
    grid.u_spans = grid.v_spans = {Span{}};
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l)
        grid.points.push_back({10.0 * k / 3, (k == 0 ? 0 : 6.0 * l / 3) + (k == 0 ? 0 : even(random)),
                               k == 0 ? 0 : 3 * even(random), 1});
    const Model model = testing::ModelOf({grid});
    const SurfaceEval surface(model, 0);
    ExpectNearest(model,
                  Tessellated([&](double u, double v) { return surface.Position(u, v); }, 3, 0, 1, 0, 1), 32,
                  "patch " + std::to_string(round));
  }
}

TEST(MeshDeviation, NamesTheFacesThatHaveNoTriangle) {
  const Model model = testing::ModelOf({testing::Sphere({0, 0, 0}, 10)});
  Mesh mesh = testing::BallMesh(10, 12);
  mesh.faces_unmeshed = {"cone #12"};
  const auto deviation = MeasureMeshDeviation(model, mesh, {});
  ASSERT_TRUE(deviation.ok());
  EXPECT_EQ(deviation.value().faces_missing, mesh.faces_unmeshed);
}

TEST(MeshDeviation, OfAPlaneIsNothing) {
  const Model model = testing::ModelOf({testing::Rectangle({0, 0, 5}, {10, 0, 0}, {0, 20, 0})});
  const Mesh mesh = Tessellated([](double u, double v) { return Vec3{u, v, 5}; }, 4, 0, 10, 0, 20);
  const auto deviation = MeasureMeshDeviation(model, mesh, {});
  ASSERT_TRUE(deviation.ok());
  EXPECT_LT(deviation.value().largest_mm, 1e-12);
}

TEST(MeshDeviation, RefusesAForeignMesh) {
  const Model model = testing::ModelOf({testing::Sphere({0, 0, 0}, 1)});
  Mesh mesh;
  EXPECT_EQ(MeasureMeshDeviation(model, mesh, {}).error().code, ErrorCode::kBadUsage);
}

TEST(MeshDeviation, CanBeStopped) {
  const Model model = testing::ModelOf({testing::Rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})});
  const Mesh mesh = Tessellated([](double u, double v) { return Vec3{u, v, 0}; }, 2, 0, 1, 0, 1);
  const std::atomic<bool> stop = true;
  EXPECT_EQ(MeasureMeshDeviation(model, mesh, {.cancel = &stop}).error().code, ErrorCode::kCancelled);
}

TEST(MeshDeviation, IsReadBackAsItIsWritten) {
  const Model model = testing::ModelOf({testing::Sphere({0, 0, 0}, 10)});
  const Mesh mesh = Tessellated(
      [](double u, double v) {
        return Vec3{10 * std::cos(u) * std::cos(v), 10 * std::sin(u) * std::cos(v), 10 * std::sin(v)};
      },
      6, 0, 2 * kPi, -kPi / 2, kPi / 2);
  const MeshDeviation deviation = MeasureMeshDeviation(model, mesh, {}).value();
  const std::string bytes = EncodeMeshDeviation(mesh, deviation);
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  EXPECT_EQ(length % 4, 0u);
  const auto header = nlohmann::json::parse(bytes.substr(4, length));
  const auto& part = header.at("parts").at(0);
  EXPECT_EQ(part.at("triangles"), 72);
  EXPECT_EQ(header.at("nodes").at(0).at("matrix").size(), 12u);
  const auto number = [&](const char* array, std::size_t i) {
    float value = 0;
    std::memcpy(&value, bytes.data() + 4 + length + part.at(array).get<std::size_t>() + i * sizeof value,
                sizeof value);
    return value;
  };
  for (std::size_t i = 0; i < 72; ++i) {
    EXPECT_EQ(number("deviations", i), deviation.parts[0][i]);
    EXPECT_EQ(number("positions", 9 * i + 5), mesh.parts[0].positions[mesh.parts[0].triangles[i][1]][2]);
  }
}

}  // namespace
}  // namespace facetless
