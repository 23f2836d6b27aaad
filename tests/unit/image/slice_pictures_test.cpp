// Slices of voxels as pictures. OpenImageIO writes what is read, and reads what is written.
#include "render/image/slice_pictures.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

using ::testing::StartsWith;

constexpr std::uint64_t kMemory = std::uint64_t{1} << 26;

// A picture of numbers that a type of OpenImageIO holds, with empty pixels.
struct Numbers {
  int width = 0, height = 0, channels = 0;
  OIIO::TypeDesc type;
  std::vector<std::vector<std::uint16_t>> pages;

  static Numbers Any(const std::vector<OIIO::TypeDesc>& types, int pages) {
    Numbers numbers{*rc::gen::inRange(1, 40),
                    *rc::gen::inRange(1, 40),
                    *rc::gen::inRange(1, 5),
                    *rc::gen::elementOf(types),
                    {}};
    const int most = numbers.type == OIIO::TypeDesc::UINT8 ? 256 : 65536;
    for (int page = 0; page < pages; ++page) {
      numbers.pages.emplace_back();
      for (int i = 0; i < numbers.width * numbers.height * numbers.channels; ++i)
        numbers.pages.back().push_back(
            static_cast<std::uint16_t>(*rc::gen::inRange(0, 3) == 0 ? 0 : *rc::gen::inRange(0, most)));
    }
    return numbers;
  }

  void Write(const std::string& path, bool tiled) const {
    OIIO::ImageSpec spec(width, height, channels, type);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (channels == 2) spec.alpha_channel = 1;
    if (tiled) {
      spec.tile_width = 16;
      spec.tile_height = 32;
    }
    const auto file = OIIO::ImageOutput::create(path);
    const std::vector<OIIO::ImageSpec> specs(pages.size(), spec);
    bool done = pages.size() == 1 ? file->open(path, spec)
                                  : file->open(path, static_cast<int>(specs.size()), specs.data());
    for (std::size_t page = 0; done && page < pages.size(); ++page) {
      if (page > 0) done = file->open(path, spec, OIIO::ImageOutput::AppendSubimage);
      // OpenImageIO converts numbers between types by their ranges, so each is written in its own.
      std::vector<std::uint8_t> bytes(pages[page].begin(), pages[page].end());
      std::vector<float> floats(pages[page].begin(), pages[page].end());
      const void* data = type == OIIO::TypeDesc::UINT8   ? static_cast<const void*>(bytes.data())
                         : type == OIIO::TypeDesc::FLOAT ? static_cast<const void*>(floats.data())
                                                         : static_cast<const void*>(pages[page].data());
      done = done && file->write_image(type, data);
    }
    RC_ASSERT(done && file->close());
  }

  void Check(const Image8& image, std::size_t page, double threshold) const {
    RC_ASSERT(image.width == width && image.height == height && image.channels == 4);
    const bool alpha = channels == 2 || channels == 4;
    const int colors = alpha ? channels - 1 : channels;
    for (int pixel = 0; pixel < width * height; ++pixel) {
      const std::uint16_t* number = &pages[page][static_cast<std::size_t>(pixel * channels)];
      bool filled = alpha && number[colors] > 0;
      for (int c = 0; c < colors && !alpha; ++c) filled = filled || number[c] > threshold;
      const std::uint8_t* found = &image.bytes[static_cast<std::size_t>(4 * pixel)];
      RC_ASSERT(found[3] == (filled ? 255 : 0));
      for (int c = 0; c < 3; ++c) {
        const int value = number[std::min(c, colors - 1)];
        RC_ASSERT(found[c] == (type == OIIO::TypeDesc::UINT8    ? value
                               : type == OIIO::TypeDesc::UINT16 ? value / 256
                                                                : 178));
      }
    }
  }
};

RC_GTEST_PROP(SlicePictures, ArePng, ()) {
  const TemporaryFolder folder;
  const Numbers numbers = Numbers::Any({OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16}, 1);
  const double threshold = *rc::gen::inRange(0, 300);
  numbers.Write(folder.File("a.png"), false);
  const Result<Image8> read = ReadPngSlice(folder.File("a.png"), threshold, kMemory);
  RC_ASSERT(read.ok());
  numbers.Check(read.value(), 0, threshold);
}

RC_GTEST_PROP(SlicePictures, AreThePagesOfATiffFile, ()) {
  const TemporaryFolder folder;
  const int count = *rc::gen::inRange(1, 5);
  const Numbers numbers =
      Numbers::Any({OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16, OIIO::TypeDesc::FLOAT}, count);
  const double threshold = *rc::gen::inRange(0, 300);
  numbers.Write(folder.File("a.tif"), *rc::gen::arbitrary<bool>());
  Result<TiffPages> pages = TiffPages::Open(folder.File("a.tif"), kMemory);
  RC_ASSERT(pages.ok());
  RC_ASSERT(pages.value().count() == count);
  for (int page = 0; page < count; ++page) {
    const Result<Image8> read = pages.value().Next(threshold, kMemory);
    if (!read.ok()) RC_FAIL(read.error().message);
    numbers.Check(read.value(), static_cast<std::size_t>(page), threshold);
  }
  RC_ASSERT(pages.value().Next(threshold, kMemory).error().code == ErrorCode::kFormatBroken);
}

RC_GTEST_PROP(SlicePictures, PagesAreReadByOthers, ()) {
  const TemporaryFolder folder;
  const int width = *rc::gen::inRange(1, 30), height = *rc::gen::inRange(1, 30),
            count = *rc::gen::inRange(1, 6);
  std::vector<Image8> images;
  Result<TiffPageWriter> writer = TiffPageWriter::Open(folder.File("a.tif"), width * height * count);
  RC_ASSERT(writer.ok());
  for (int page = 0; page < count; ++page) {
    images.push_back({width, height, 4, {}});
    for (int i = 0; i < 4 * width * height; ++i)
      images.back().bytes.push_back(*rc::gen::arbitrary<std::uint8_t>());
    RC_ASSERT(writer.value().Add(images.back()).ok());
  }
  RC_ASSERT(writer.value().Finish().ok());
  OIIO::ImageSpec keep;
  keep.attribute("oiio:UnassociatedAlpha", 1);
  const auto file = OIIO::ImageInput::open(folder.File("a.tif"), &keep);
  RC_ASSERT(file != nullptr);
  for (int page = 0; page < count; ++page) {
    std::vector<std::uint8_t> bytes(images[0].bytes.size());
    RC_ASSERT(file->seek_subimage(page, 0) && file->spec().nchannels == 4 && file->spec().alpha_channel == 3);
    RC_ASSERT(file->read_image(page, 0, 0, 4, OIIO::TypeDesc::UINT8, bytes.data()));
    RC_ASSERT(std::equal(bytes.begin(), bytes.end(), images[static_cast<std::size_t>(page)].bytes.begin()));
  }
  RC_ASSERT(!file->seek_subimage(count, 0));
}

TEST(SlicePictures, AnUnfinishedFileIsRemoved) {
  const TemporaryFolder folder;
  {
    Result<TiffPageWriter> writer = TiffPageWriter::Open(folder.File("a.tif"), 4);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer.value().Add({2, 2, 4, std::vector<std::uint8_t>(16, 9)}));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  const auto nowhere = TiffPageWriter::Open("/nowhere/a.tif", 4);
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kWriteFailed);
  EXPECT_THAT(nowhere.error().message, StartsWith("/nowhere/a.tif"));
}

}  // namespace
}  // namespace facetless
