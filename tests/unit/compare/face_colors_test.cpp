// Colours of faces: which colour a face gets, and whether people can distinguish them.
#include "render/compare/face_colors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/image/film.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::ModelOf;
using testing::Sphere;

using Triple = std::array<double, 3>;

// Linear light as it is seen without one kind of cone (Machado, Oliveira and Fernandes 2009, severity 1), and
// with normal vision.
constexpr double kSights[4][3][3] = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}},
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}},
    {{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}};

// Returns the CIELAB coordinates of a colour for a kind of vision.
Triple Lab(Color color, const double (&sight)[3][3]) {
  const Triple light = {SrgbToLinear(color.r), SrgbToLinear(color.g), SrgbToLinear(color.b)};
  Triple seen;
  for (int i = 0; i < 3; ++i)
    seen[i] = std::clamp(sight[i][0] * light[0] + sight[i][1] * light[1] + sight[i][2] * light[2], 0.0, 1.0);
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f((0.4124 * seen[0] + 0.3576 * seen[1] + 0.1805 * seen[2]) / 0.95047);
  const double y = f(0.2126 * seen[0] + 0.7152 * seen[1] + 0.0722 * seen[2]);
  const double z = f((0.0193 * seen[0] + 0.1192 * seen[1] + 0.9505 * seen[2]) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// Returns the distance for the vision that distinguishes the two colours worst.
double Distance(Color a, Color b) {
  double least = INFINITY;
  for (const auto& sight : kSights) {
    const Triple p = Lab(a, sight), q = Lab(b, sight);
    least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
  }
  return least;
}

// Three instances of two parts.
Model Assembly() {
  ModelBuilder builder;
  builder.AddPart("part");
  builder.AddFace(Sphere({0, 0, 0}, 1));
  builder.AddPart("");
  builder.AddFace(Sphere({5, 0, 0}, 1));
  for (const std::uint32_t part : {0u, 1u, 0u}) {
    Instance instance;
    instance.part = part;
    builder.AddInstance(instance);
  }
  return testing::Finished(std::move(builder));
}

TEST(PartColor, TwelveCanBeToldApartWithAnyKindOfSight) {
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = 0; b < a; ++b)
      EXPECT_GT(Distance(PartColor(a), PartColor(b)), 12) << a << " and " << b;
}

TEST(PartColor, IsCalmAndNeitherBlackNorWhite) {
  for (std::uint32_t part = 0; part < 12; ++part) {
    const Triple lab = Lab(PartColor(part), kSights[0]);
    EXPECT_GT(lab[0], 40) << part;
    EXPECT_LT(lab[0], 86) << part;
    EXPECT_LT(std::hypot(lab[1], lab[2]), 45) << part;
  }
  EXPECT_LT(PartColor(12).r, PartColor(0).r) << "the next round is darker";
}

TEST(FaceColors, AreTheFilesOrThePartsOrOne) {
  Model model = Assembly();
  model.faces[0].has_color = true;
  model.faces[0].color = {1, 0, 0};
  model.instances[1].has_color = true;
  model.instances[1].color = {0, 1, 0};
  const auto file = FaceColors(model);
  ASSERT_EQ(file.size(), 3u);
  EXPECT_EQ(file[0].r, 1);
  EXPECT_EQ(file[1].g, 1);
  EXPECT_EQ(file[2].r, 1);
  const auto parts = FaceColors(model, {ColorSource::kPart, {}});
  EXPECT_EQ(parts[0].r, PartColor(0).r);
  EXPECT_EQ(parts[1].r, PartColor(1).r);
  EXPECT_EQ(parts[2].b, PartColor(0).b) << "wherever it is placed";
  for (const Color& color : FaceColors(model, {ColorSource::kOne, {0.25f, 0.5f, 0.75f}})) {
    EXPECT_EQ(color.r, 0.25f);
    EXPECT_EQ(color.b, 0.75f);
  }
}

}  // namespace
}  // namespace facetless
