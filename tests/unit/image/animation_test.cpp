// Animated WebP: checks the file's chunks with a separate reader.
#include "render/image/animation.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace facetless {
namespace {

namespace fs = std::filesystem;

class AnimationFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::temp_directory_path() / ("facetless-animation-" + std::to_string(::getpid()) + ".webp");
  }
  void TearDown() override { fs::remove(path_); }
  std::string Bytes() const {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }
  // Writes three frames of 40, 60 and 100 ms, with a square that moves over a transparent background.
  void WriteThree(int channels) {
    auto animation = Animation::Begin(64, 48);
    ASSERT_TRUE(animation.ok());
    const int begins[] = {0, 40, 100};
    for (int frame = 0; frame < 3; ++frame) {
      Image8 image{64, 48, channels, std::vector<std::uint8_t>(64ul * 48 * channels, 0)};
      for (int y = 10; y < 30; ++y)
        for (int x = 10 * frame; x < 10 * frame + 20; ++x) {
          image.at(x, y)[0] = 200;
          if (channels == 4) image.at(x, y)[3] = 255;
        }
      ASSERT_TRUE(animation.value().Add(image, begins[frame]).ok());
    }
    const Result<void> written = animation.value().Write(path_, 200);
    ASSERT_TRUE(written.ok()) << written.error().message;
  }
  fs::path path_;
};

unsigned Little(const std::string& bytes, std::size_t at, int count) {
  unsigned value = 0;
  for (int i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

TEST_F(AnimationFile, HasEveryFrameAsLongAsItLastsAndBeginsAgain) {
  for (const int channels : {3, 4}) {
    WriteThree(channels);
    const std::string bytes = Bytes();
    ASSERT_GT(bytes.size(), 100u);
    EXPECT_EQ(bytes.substr(0, 4), "RIFF");
    EXPECT_EQ(bytes.substr(8, 8), "WEBPVP8X");
    EXPECT_EQ((bytes[20] & 0x10) != 0, channels == 4) << "alpha";
    EXPECT_EQ(Little(bytes, 24, 3) + 1, 64u);
    EXPECT_EQ(Little(bytes, 27, 3) + 1, 48u);
    // The chunks: a header of the animation, then the frames.
    std::vector<unsigned> durations;
    for (std::size_t at = 12; at + 8 <= bytes.size(); at += 8 + (Little(bytes, at + 4, 4) + 1) / 2 * 2) {
      const std::string kind = bytes.substr(at, 4);
      if (kind == "ANIM") {
        EXPECT_EQ(Little(bytes, at + 12, 2), 0u) << "for ever";
      }
      if (kind == "ANMF") durations.push_back(Little(bytes, at + 20, 3));
    }
    EXPECT_EQ(durations, (std::vector<unsigned>{40, 60, 100}));
  }
}

TEST_F(AnimationFile, HasTheSameBytesAgain) {
  WriteThree(4);
  const std::string first = Bytes();
  WriteThree(4);
  EXPECT_EQ(Bytes(), first);
}

TEST_F(AnimationFile, RefusesWhatItCannotHold) {
  EXPECT_EQ(Animation::Begin(16384, 10).error().code, ErrorCode::kLimitExceeded);
  auto animation = Animation::Begin(8, 8);
  ASSERT_TRUE(animation.ok());
  const Image8 other{9, 8, 3, std::vector<std::uint8_t>(9ul * 8 * 3, 0)};
  EXPECT_EQ(animation.value().Add(other, 0).error().code, ErrorCode::kSizeMismatch);
  const Image8 frame{8, 8, 3, std::vector<std::uint8_t>(8ul * 8 * 3, 7)};
  ASSERT_TRUE(animation.value().Add(frame, 0).ok());
  EXPECT_EQ(animation.value().Write("/nowhere/at/all.webp", 10).error().code, ErrorCode::kWriteFailed);
}

}  // namespace
}  // namespace facetless
