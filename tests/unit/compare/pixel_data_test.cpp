// Compares pixel data, decoded as a browser decodes them, with the buffers from which they were made.
#include "render/compare/pixel_data.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <random>

#include "render/image/io.h"

namespace facetless {
namespace {

constexpr int kWidth = 37, kHeight = 23;
constexpr double kNoise = 1e-6;

CameraFrame Frame() {
  Camera camera;
  camera.eye = {0, -100, 0};
  camera.up = {0, 0, 1};
  camera.height = kHeight;
  camera.width_px = kWidth;
  camera.height_px = kHeight;
  return MakeFrame(camera, 1).value();
}

struct Views {
  SampleBuffer direct, baseline;
};

// Returns random depths, normals and faces. Both tracers, one of them or neither hits a pixel.
Views RandomViews(unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Views views;
  views.direct.Resize(kWidth, kHeight);
  views.baseline.Resize(kWidth, kHeight);
  views.direct.certificate.assign(views.direct.size(), Certificate::kCertified);
  for (std::size_t i = 0; i < views.direct.size(); ++i) {
    const int kind = static_cast<int>(number(0, 6));
    if (kind == 0) continue;
    views.direct.certificate[i] = static_cast<Certificate>(i % 3);
    if (kind != 1) {
      const Vec3 n = Normalized(Vec3{number(-1, 1), number(-1, 1), number(-1, 1)});
      views.direct.depth[i] = number(50, 150);
      views.direct.normal[i] = {float(n.x), float(n.y), float(n.z)};
      views.direct.face[i] = static_cast<std::uint32_t>(number(0, 100000));
    }
    if (kind != 2) {
      const double near = views.direct.depth[i] != INFINITY ? views.direct.depth[i] : 100;
      views.baseline.depth[i] = near + std::pow(10, number(-9, 1)) * (i % 2 == 0 ? 1 : -1);
      views.baseline.normal[i] = {0, -1, 0};
      views.baseline.face[i] = views.direct.face[i] == kNoIndex ? 0 : views.direct.face[i];
    }
  }
  return views;
}

std::uint32_t Code(const Image8& plane, std::size_t i) {
  return std::uint32_t(plane.bytes[3 * i]) << 16 | std::uint32_t(plane.bytes[3 * i + 1]) << 8 |
         plane.bytes[3 * i + 2];
}

Vec3 DecodedNormal(std::uint32_t code) {
  double u = (code >> 12) / 4095.0 * 2 - 1, v = (code & 4095) / 4095.0 * 2 - 1;
  const double z = 1 - std::fabs(u) - std::fabs(v);
  if (z < 0) {
    const double folded = std::copysign(1 - std::fabs(v), u);
    v = std::copysign(1 - std::fabs(u), v);
    u = folded;
  }
  return Normalized(Vec3{u, v, z});
}

class PixelDataOfRandomViews : public testing::TestWithParam<unsigned> {
 protected:
  PixelDataOfRandomViews()
      : views_(RandomViews(GetParam())),
        data_(MakePixelData(views_.direct, views_.baseline, Frame(), true, kNoise).value()) {}
  const Image8& plane(PixelPlane which) const { return data_.planes[static_cast<std::size_t>(which)]; }
  bool hit(std::size_t i) const { return views_.direct.depth[i] != INFINITY; }
  bool both(std::size_t i) const { return hit(i) && views_.baseline.depth[i] != INFINITY; }

  Views views_;
  PixelData data_;
};

TEST_P(PixelDataOfRandomViews, FacesAndCertificatesAreExact) {
  for (std::size_t i = 0; i < views_.direct.size(); ++i) {
    EXPECT_EQ(Code(plane(PixelPlane::kFaces), i), hit(i) ? views_.direct.face[i] + 1 : 0);
    EXPECT_EQ(plane(PixelPlane::kStatus).bytes[3 * i + 1], static_cast<int>(views_.direct.certificate[i]));
  }
}

TEST_P(PixelDataOfRandomViews, DepthsAreWithinHalfAStepOfTheirRange) {
  const double step = (data_.far_mm - data_.near_mm) / 0xfffffe;
  for (std::size_t i = 0; i < views_.direct.size(); ++i) {
    const std::uint32_t code = Code(plane(PixelPlane::kDepths), i);
    ASSERT_EQ(code > 0, hit(i));
    // The tolerance is half a quantisation step, and the rounding of the sums in double.
    if (!hit(i)) continue;
    EXPECT_NEAR(data_.near_mm + (code - 1) * step, views_.direct.depth[i], 0.5001 * step);
  }
}

TEST_P(PixelDataOfRandomViews, NormalsAreWithinATenthOfADegree) {
  for (std::size_t i = 0; i < views_.direct.size(); ++i) {
    if (!hit(i)) continue;
    const auto& n = views_.direct.normal[i];
    const Vec3 decoded = DecodedNormal(Code(plane(PixelPlane::kNormals), i));
    const double degrees =
        std::atan2(Length(Cross(decoded, {n[0], n[1], n[2]})), Dot(decoded, Vec3{n[0], n[1], n[2]})) * 180 /
        M_PI;
    EXPECT_LT(degrees, 0.1);
  }
}

TEST_P(PixelDataOfRandomViews, DeviationsKeepThirteenBitsAboveTheNoise) {
  for (std::size_t i = 0; i < views_.direct.size(); ++i) {
    const auto decoded = std::bit_cast<float>(Code(plane(PixelPlane::kDeviation), i) << 8);
    if (!both(i)) {
      EXPECT_EQ(decoded, 0);
      continue;
    }
    const double exact = SignedDeviation(views_.direct, views_.baseline, Frame(), i);
    EXPECT_NEAR(decoded, exact, kNoise / 16 * 1.0001 + std::fabs(exact) * std::ldexp(1.0, -13));
  }
}

TEST_P(PixelDataOfRandomViews, EveryPixelHasItsClass) {
  const auto border = BorderPixels(views_.direct, views_.baseline, Frame(), true);
  for (std::size_t i = 0; i < views_.direct.size(); ++i) {
    const bool mesh = views_.baseline.depth[i] != INFINITY;
    const PixelClass expected = both(i)  ? (border[i] ? PixelClass::kBorder : PixelClass::kMeasured)
                                : hit(i) ? PixelClass::kOnlySurface
                                : mesh   ? PixelClass::kOnlyMesh
                                         : PixelClass::kNothing;
    EXPECT_EQ(static_cast<PixelClass>(plane(PixelPlane::kStatus).bytes[3 * i]), expected) << i;
  }
}

TEST_P(PixelDataOfRandomViews, FilesKeepEveryByte) {
  const std::string path = testing::TempDir() + "/pixel_data_" + std::to_string(GetParam()) + ".png";
  for (const Image8& image : data_.planes) {
    ASSERT_TRUE(WriteDataPng(path, image).ok());
    EXPECT_EQ(ReadPng(path).value().bytes, image.bytes);
  }
  std::filesystem::remove(path);
}

TEST_P(PixelDataOfRandomViews, ReducedPlanesDecodeToEveryThirdPixel) {
  const Image8 faces = ReducedPlane(PixelPlane::kFaces, plane(PixelPlane::kFaces), 3);
  const Image8 deviation = ReducedPlane(PixelPlane::kDeviation, plane(PixelPlane::kDeviation), 3);
  const Image8 depths = ReducedPlane(PixelPlane::kDepths, plane(PixelPlane::kDepths), 3);
  ASSERT_EQ(faces.width, 13);
  ASSERT_EQ(faces.height, 8);
  for (int y = 0; y < faces.height; ++y) {
    for (int x = 0; x < faces.width; ++x) {
      const std::size_t from =
          std::size_t(std::min(3 * y + 1, kHeight - 1)) * kWidth + std::min(3 * x + 1, kWidth - 1);
      const std::size_t to = std::size_t(y) * faces.width + x;
      EXPECT_EQ(Code(faces, to), Code(plane(PixelPlane::kFaces), from));
      EXPECT_EQ(Code(depths, to) > 0, hit(from)) << "a reduced depth is still a hit";
      const float full = std::bit_cast<float>(Code(plane(PixelPlane::kDeviation), from) << 8);
      EXPECT_NEAR(std::bit_cast<float>(Code(deviation, to) << 8), full, std::fabs(full) / 256);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, PixelDataOfRandomViews, testing::Values(1u, 20261122u, 77u));

TEST(PixelData, OfAnEmptyViewIsEmpty) {
  Views views;
  views.direct.Resize(kWidth, kHeight);
  views.baseline.Resize(kWidth, kHeight);
  views.direct.certificate.assign(views.direct.size(), Certificate::kCertified);
  const auto data = MakePixelData(views.direct, views.baseline, Frame(), true, kNoise);
  ASSERT_TRUE(data.ok());
  EXPECT_EQ(data.value().near_mm, data.value().far_mm);
  for (const Image8& plane : data.value().planes)
    EXPECT_EQ(plane.bytes, std::vector<std::uint8_t>(plane.bytes.size(), 0));
}

TEST(PixelData, RefusesViewsOfDifferentSizesAndWhatIsNoNumber) {
  Views views = RandomViews(1);
  Views other = RandomViews(1);
  other.baseline.Resize(kWidth - 1, kHeight);
  EXPECT_EQ(MakePixelData(views.direct, other.baseline, Frame(), true, kNoise).error().code,
            ErrorCode::kSizeMismatch);
  views.direct.depth[5] = NAN;
  EXPECT_EQ(MakePixelData(views.direct, views.baseline, Frame(), true, kNoise).error().code,
            ErrorCode::kNotFinite);
}

}  // namespace
}  // namespace facetless
