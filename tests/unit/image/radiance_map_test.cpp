// Radiance maps: what is read from EXR and RGBE files, and how lookups interpolate.
#include "render/image/radiance_map.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

RadianceMap AnyMap(int width, int height, unsigned seed) {
  RadianceMap map{width, height, {}};
  unsigned state = seed * 2654435761u + 1;
  for (int i = 0; i < width * height; ++i) {
    std::array<float, 3> pixel;
    for (float& value : pixel) {
      state = state * 1664525u + 1013904223u;
      value = static_cast<float>(state >> 8) / 16777216.0f * (i % 3 == 0 ? 100.0f : 1.0f);
    }
    map.pixels.push_back(pixel);
  }
  return map;
}

// Written by another library.
void Write(const std::string& path, const RadianceMap& map) {
  const auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out);
  ASSERT_TRUE(out->open(path, OIIO::ImageSpec(map.width, map.height, 3, OIIO::TypeDesc::FLOAT)));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, map.pixels.data()));
  out->close();
}

TEST(RadianceMap, ReadsWhatAnotherLibraryWrites) {
  const TemporaryFolder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {8, 4}, {64, 32}, {200, 5}}) {
    const RadianceMap map = AnyMap(width, height, 17);
    for (const char* name : {"map.exr", "map.hdr"}) {
      const std::string path = folder.path() + "/" + name;
      Write(path, map);
      const Result<RadianceMap> read = ReadRadianceMap(path);
      ASSERT_TRUE(read.ok()) << read.error().message;
      ASSERT_EQ(read.value().width, width);
      ASSERT_EQ(read.value().height, height);
      // RGBE has eight bits for the largest component, and the same step for the others. EXR may be half precision.
      for (std::size_t i = 0; i < map.pixels.size(); ++i) {
        const float largest = *std::max_element(map.pixels[i].begin(), map.pixels[i].end());
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(read.value().pixels[i][c], map.pixels[i][c], largest / 120) << name << " pixel " << i;
      }
    }
  }
}

TEST(RadianceMap, BrokenFilesAreErrors) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/map";
  const auto error = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    return ReadRadianceMap(path).error().code;
  };
  EXPECT_EQ(ReadRadianceMap(folder.path() + "/none").error().code, ErrorCode::kFileUnreadable);
  EXPECT_EQ(error("P6 1 1 255 abc"), ErrorCode::kFormatUnknown);
  EXPECT_EQ(error(""), ErrorCode::kFormatUnknown);
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  EXPECT_EQ(error(head), ErrorCode::kFormatBroken);
  EXPECT_EQ(error(head + "+Y 1 +X 1\nabcd"), ErrorCode::kFormatBroken);
  EXPECT_EQ(error(head + "-Y 0 +X 1\nabcd"), ErrorCode::kFormatBroken);
  EXPECT_EQ(error(head + "-Y 1 +X 2\nabcd"), ErrorCode::kFormatBroken);
  EXPECT_EQ(error(head + "-Y 100000 +X 100000\nabcd"), ErrorCode::kLimitExceeded);
  EXPECT_EQ(error("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd"), ErrorCode::kFormatBroken);
  EXPECT_EQ(error("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\nabcd"), ErrorCode::kFormatBroken);
  EXPECT_EQ(error(std::string("\x76\x2f\x31\x01", 4)), ErrorCode::kFormatBroken);
}

TEST(RadianceMap, PixelsThatRepeatTheOneBeforeAreRead) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/map.hdr", head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  const auto write = [&](int width, const std::string& pixels) {
    std::ofstream(path, std::ios::binary) << head << "-Y 1 +X " << width << "\n" << pixels;
  };
  const std::string bright = "\x80\x40\x20\x81", dark = "\x08\x08\x08\x81";
  EXPECT_TRUE(rc::check("any number of repetitions", [&] {
    const int count = *rc::gen::inRange(0, 70000);
    std::string repeat;
    for (int rest = count; rest > 0 || repeat.empty(); rest /= 256)
      repeat += std::string("\x01\x01\x01", 3) + static_cast<char>(rest % 256);
    write(count + 2, bright + repeat + dark);
    const Result<RadianceMap> map = ReadRadianceMap(path);
    RC_ASSERT(map.ok());
    for (int x = 0; x <= count; ++x)
      RC_ASSERT(map.value().pixels[static_cast<std::size_t>(x)] == (std::array<float, 3>{1, 0.5f, 0.25f}));
    RC_ASSERT(map.value().pixels.back() == (std::array<float, 3>{0.0625f, 0.0625f, 0.0625f}));
  }));
  write(3, bright + "\x01\x01\x01\x03");
  EXPECT_EQ(ReadRadianceMap(path).error().code, ErrorCode::kFormatBroken) << "more pixels than the row has";
  write(3, "\x01\x01\x01\x03");
  EXPECT_EQ(ReadRadianceMap(path).error().code, ErrorCode::kFormatBroken) << "there is nothing to repeat";
}

TEST(RadianceMap, MutantsAreReadOrRefused) {
  const TemporaryFolder folder;
  for (const char* name : {"map.exr", "map.hdr"}) {
    const std::string path = folder.path() + "/" + name;
    Write(path, AnyMap(16, 8, 3));
    std::ifstream stream(path, std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_TRUE(rc::check("a few bytes changed, or the end cut off", [&] {
      std::string bytes = whole;
      for (int i = *rc::gen::inRange(0, 4); i > 0; --i)
        bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = static_cast<char>(*rc::gen::inRange(0, 256));
      bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size() + 1));
      const std::string mutant = folder.path() + "/mutant";
      std::ofstream(mutant, std::ios::binary) << bytes;
      const Result<RadianceMap> read = ReadRadianceMap(mutant);
      if (read.ok())
        RC_ASSERT(read.value().pixels.size() == static_cast<std::size_t>(read.value().width) *
                                                    static_cast<std::size_t>(read.value().height));
    }));
  }
}

TEST(RadianceMap, LookupsInterpolateAndGoAround) {
  EXPECT_TRUE(rc::check("any map, any place", [] {
    const int width = *rc::gen::inRange(1, 9), height = *rc::gen::inRange(1, 9);
    const RadianceMap map = AnyMap(width, height, *rc::gen::inRange(1u, 1000u));
    const int column = *rc::gen::inRange(0, width), row = *rc::gen::inRange(0, height);
    const auto& pixel = map.pixels[static_cast<std::size_t>(row) * width + column];
    for (const int turn : {-1, 0, 1}) {
      const Vec3 light = map.At((column + 0.5) / width + turn, (row + 0.5) / height);
      RC_ASSERT(std::fabs(light.x - pixel[0]) <= 1e-4 * (1 + pixel[0]));
    }
    // Between two pixels lies their mean.
    const auto& next = map.pixels[static_cast<std::size_t>(row) * width + (column + 1) % width];
    const Vec3 between = map.At((column + 1.0) / width, (row + 0.5) / height);
    RC_ASSERT(std::fabs(between.y - 0.5 * (pixel[1] + next[1])) <= 1e-4 * (1 + pixel[1] + next[1]));
    const double x = *rc::gen::inRange(-3000, 3000) / 1000.0, y = *rc::gen::inRange(-3000, 3000) / 1000.0;
    RC_ASSERT(std::isfinite(map.At(x, y).z));
  }));
}

}  // namespace
}  // namespace facetless
