// Image files: an image that is read back is equal to the one that was written, and files are written
// completely or not at all.
#include "render/image/io.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "render/image/atomic_file.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;

class ImageFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("facetless-io-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t FileCount() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  static std::string Read(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }
  fs::path folder_;
};

Image8 Pattern(int width, int height, int channels) {
  Image8 image{width, height, channels, {}};
  for (int i = 0; i < width * height * channels; ++i)
    image.bytes.push_back(static_cast<std::uint8_t>(37 * i + i / 7));
  return image;
}

TEST_F(ImageFiles, PngComesBackByteForByte) {
  for (int channels : {3, 4}) {
    const Image8 image = Pattern(31, 17, channels);
    ASSERT_TRUE(WritePng(Path("a.png"), image).ok());
    const Result<Image8> back = ReadPng(Path("a.png"));
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back.value().width, 31);
    EXPECT_EQ(back.value().height, 17);
    EXPECT_EQ(back.value().channels, channels);
    EXPECT_EQ(back.value().bytes, image.bytes) << "alpha is not multiplied in";
  }
  EXPECT_EQ(FileCount(), 1u) << "no temporary file stays";
}

TEST_F(ImageFiles, DataComeBackByteForByteAndNameNoColours) {
  const Image8 data = Pattern(31, 17, 3);
  ASSERT_TRUE(WriteDataPng(Path("d.png"), data).ok());
  EXPECT_EQ(ReadPng(Path("d.png")).value().bytes, data.bytes);
  EXPECT_EQ(Read(Path("d.png")).find("sRGB"), std::string::npos);
  const Result<std::string> packed = EncodeDataPng(data);
  ASSERT_TRUE(packed.ok()) << packed.error().message;
  std::ofstream(Path("p.png"), std::ios::binary) << packed.value();
  EXPECT_EQ(ReadPng(Path("p.png")).value().bytes, data.bytes);
  EXPECT_EQ(WriteDataPng(Path("alpha.png"), Pattern(4, 4, 4)).error().code, ErrorCode::kBadUsage);
}

TEST_F(ImageFiles, DepthComesBackBitForBit) {
  std::vector<double> depth = {1.0 / 3, -1e-300, 1e300, INFINITY, 0.1, 7};
  ASSERT_TRUE(WriteDepth(Path("d.tif"), 3, 2, depth).ok());
  const Result<DepthImage> back = ReadDepth(Path("d.tif"));
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back.value().width, 3);
  EXPECT_TRUE(std::ranges::equal(back.value().depth, depth));
  depth[2] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(WriteDepth(Path("d.tif"), 3, 2, depth).ok());
  EXPECT_TRUE(std::isnan(ReadDepth(Path("d.tif")).value().depth[2])) << "a NaN is not hidden";
}

TEST_F(ImageFiles, TheSamePictureGivesTheSameBytes) {
  SampleBuffer samples;
  samples.Resize(20, 10);
  ASSERT_TRUE(WritePng(Path("1.png"), Pattern(20, 10, 3)).ok());
  ASSERT_TRUE(WriteDepth(Path("1.tif"), 20, 10, samples.depth).ok());
  ASSERT_TRUE(WriteAovs(Path("1.exr"), samples, {}).ok());
  ::sleep(1);  // if the file contained a date, it would have changed
  ASSERT_TRUE(WritePng(Path("2.png"), Pattern(20, 10, 3)).ok());
  ASSERT_TRUE(WriteDepth(Path("2.tif"), 20, 10, samples.depth).ok());
  ASSERT_TRUE(WriteAovs(Path("2.exr"), samples, {}).ok());
  for (const char* extension : {".png", ".tif", ".exr"})
    EXPECT_EQ(Read(Path(std::string("1") + extension)), Read(Path(std::string("2") + extension)))
        << extension;
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  for (const char* name : {"1.png", "1.tif", "1.exr"})
    EXPECT_EQ(Read(Path(name)).find(host), std::string::npos) << name << " names this machine";
}

TEST_F(ImageFiles, AovsNameTheirChannels) {
  SampleBuffer samples;
  samples.Resize(4, 3);
  samples.uv.resize(12);
  samples.certificate.resize(12);
  samples.doubt.resize(12);
  samples.depth_error.resize(12);
  AovSelection all;
  all.uv = all.certificate = true;
  const std::vector<float> curvature(12, 0.5f);
  all.curvature = &curvature;
  ASSERT_TRUE(WriteAovs(Path("a.exr"), samples, all).ok());
  const std::string bytes = Read(Path("a.exr"));
  for (const char* channel : {"depth.Z", "normal.X", "normal.Y", "normal.Z", "face.id", "uv.U", "uv.V",
                              "certificate.C", "certificate.doubt", "certificate.error", "curvature.H"})
    EXPECT_NE(bytes.find(channel), std::string::npos) << channel;
  samples.uv.clear();
  EXPECT_EQ(WriteAovs(Path("b.exr"), samples, all).error().code, ErrorCode::kBadUsage);
  EXPECT_FALSE(fs::exists(Path("b.exr")));
}

// The content of one of our files as another library reads it: floats, channel by channel in the file's
// order.
struct Foreign {
  OIIO::ImageSpec spec;
  std::vector<float> values;
};
Foreign ReadWithOpenImageIO(const std::string& path) {
  OIIO::ImageSpec unassociated;
  unassociated.attribute("oiio:UnassociatedAlpha", 1);
  const auto input = OIIO::ImageInput::open(path, &unassociated);
  EXPECT_NE(input, nullptr) << OIIO::geterror();
  if (input == nullptr) return {};
  Foreign foreign{input->spec(), std::vector<float>(input->spec().image_pixels() * input->spec().nchannels)};
  EXPECT_TRUE(
      input->read_image(0, 0, 0, foreign.spec.nchannels, OIIO::TypeDesc::FLOAT, foreign.values.data()));
  return foreign;
}
// Writes a file with the other library. `tile` is 0 for strips.
template <typename T>
void WriteWithOpenImageIO(const std::string& path, int width, int height, int channels, OIIO::TypeDesc type,
                          const std::vector<T>& values, int tile = 0) {
  OIIO::ImageSpec spec(width, height, channels, type);
  spec.tile_width = spec.tile_height = tile;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  const auto output = OIIO::ImageOutput::create(path);
  ASSERT_NE(output, nullptr);
  ASSERT_TRUE(output->open(path, spec) && output->write_image(type, values.data()) && output->close())
      << output->geterror();
}

TEST_F(ImageFiles, OthersReadWhatIsWritten) {
  const Image8 picture = Pattern(31, 17, 4);
  ASSERT_TRUE(WritePng(Path("a.png"), picture).ok());
  const Foreign png = ReadWithOpenImageIO(Path("a.png"));
  EXPECT_EQ(png.spec.get_string_attribute("oiio:ColorSpace"), "sRGB");
  ASSERT_EQ(png.values.size(), picture.bytes.size());
  for (std::size_t i = 0; i < png.values.size(); ++i)
    ASSERT_EQ(std::lround(png.values[i] * 255), picture.bytes[i]) << i;

  SampleBuffer samples;
  samples.Resize(70, 150);  // larger than two strips
  samples.uv.resize(samples.size());
  samples.certificate.resize(samples.size());
  samples.doubt.resize(samples.size());
  samples.depth_error.resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples.depth[i] = i % 5 == 0 ? INFINITY : 0.25 * static_cast<double>(i);
    samples.normal[i] = {0.5f, static_cast<float>(i % 7), -1};
    samples.face[i] = static_cast<std::uint32_t>(i % 11);
    samples.uv[i] = {static_cast<double>(i % 3), 0.125};
    samples.certificate[i] = static_cast<Certificate>(i % 3);
    samples.doubt[i] = static_cast<std::uint8_t>(i % 13);
    samples.depth_error[i] = 1e-6f;
  }
  ASSERT_TRUE(WriteDepth(Path("a.tif"), 70, 150, samples.depth).ok());
  const Foreign depth = ReadWithOpenImageIO(Path("a.tif"));
  ASSERT_EQ(depth.values.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    ASSERT_EQ(depth.values[i], static_cast<float>(samples.depth[i])) << i;

  AovSelection all;
  all.uv = all.certificate = true;
  ASSERT_TRUE(WriteAovs(Path("a.exr"), samples, all).ok());
  const Foreign aovs = ReadWithOpenImageIO(Path("a.exr"));
  const auto channel = [&](const char* name, std::size_t i) {
    const int index = aovs.spec.channelindex(name);
    return index < 0 ? NAN
                     : aovs.values[i * static_cast<std::size_t>(aovs.spec.nchannels) +
                                   static_cast<std::size_t>(index)];
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(channel("depth.Z", i), static_cast<float>(samples.depth[i])) << i;
    ASSERT_EQ(channel("normal.Y", i), samples.normal[i][1]) << i;
    ASSERT_EQ(channel("uv.U", i), static_cast<float>(samples.uv[i][0])) << i;
    ASSERT_EQ(channel("certificate.error", i), samples.depth_error[i]) << i;
  }
}

TEST_F(ImageFiles, PicturesOfOthersAreRead) {
  WriteWithOpenImageIO<std::uint8_t>(Path("grey.png"), 2, 2, 1, OIIO::TypeDesc::UINT8, {0, 50, 100, 255});
  const Result<Image8> grey = ReadPng(Path("grey.png"));
  ASSERT_TRUE(grey.ok()) << grey.error().message;
  EXPECT_EQ(grey.value().channels, 3);
  EXPECT_EQ(grey.value().bytes,
            (std::vector<std::uint8_t>{0, 0, 0, 50, 50, 50, 100, 100, 100, 255, 255, 255}));
  WriteWithOpenImageIO<std::uint16_t>(Path("deep.png"), 2, 1, 4, OIIO::TypeDesc::UINT16,
                                      {0, 257, 514, 65535, 25700, 51400, 65535, 32896});
  const Result<Image8> deep = ReadPng(Path("deep.png"));
  ASSERT_TRUE(deep.ok()) << deep.error().message;
  EXPECT_EQ(deep.value().bytes, (std::vector<std::uint8_t>{0, 1, 2, 255, 100, 200, 255, 128}));
}

TEST_F(ImageFiles, DepthsOfOthersAreRead) {
  std::vector<float> depth(70 * 50);
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = 0.1f * static_cast<float>(i);
  for (int tile : {0, 16}) {
    WriteWithOpenImageIO(Path("a.tif"), 70, 50, 1, OIIO::TypeDesc::FLOAT, depth, tile);
    const Result<DepthImage> back = ReadDepth(Path("a.tif"));
    ASSERT_TRUE(back.ok()) << back.error().message;
    ASSERT_EQ(back.value().width, 70);
    EXPECT_TRUE(std::ranges::equal(back.value().depth, depth)) << "tile " << tile;
  }
  WriteWithOpenImageIO(Path("two.tif"), 35, 50, 2, OIIO::TypeDesc::FLOAT, depth);
  EXPECT_EQ(ReadDepth(Path("two.tif")).error().code, ErrorCode::kFormatBroken);
  // A file that is cut anywhere must give an error and no picture.
  const std::string whole = Read(Path("a.tif"));
  for (std::size_t length = 0; length < whole.size(); length += 97) {
    std::ofstream(Path("cut.tif"), std::ios::binary) << whole.substr(0, length);
    EXPECT_FALSE(ReadDepth(Path("cut.tif")).ok()) << length;
  }
}

TEST_F(ImageFiles, AFailedWriteLeavesNothingAndHarmsNothing) {
  EXPECT_EQ(WritePng("/nowhere/at/all.png", Pattern(2, 2, 3)).error().code, ErrorCode::kWriteFailed);
  EXPECT_NE(WritePng("/nowhere/at/all.png", Pattern(2, 2, 3)).error().message.find("/nowhere/at/all.png"),
            std::string::npos);
  // A folder with the same name makes the rename fail. The temporary file must be removed.
  fs::create_directories(Path("taken.png") + "/inside");
  EXPECT_EQ(WritePng(Path("taken.png"), Pattern(2, 2, 3)).error().code, ErrorCode::kWriteFailed);
  EXPECT_EQ(FileCount(), 1u);
  Image8 wrong = Pattern(2, 2, 3);
  wrong.bytes.pop_back();
  EXPECT_EQ(WritePng(Path("x.png"), wrong).error().code, ErrorCode::kSizeMismatch);
  EXPECT_EQ(WriteDepth(Path("x.tif"), 2, 2, std::vector<double>(3)).error().code, ErrorCode::kSizeMismatch);
}

TEST_F(ImageFiles, AFullDiskIsAnError) {
  // A limit on the file size simulates a full disk: the write is incomplete and sets errno.
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100, 100};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const Result<void> written = WriteAtomically(Path("full.bin"), std::vector<unsigned char>(1000));
    ::_exit(!written.ok() && written.error().code == ErrorCode::kWriteFailed ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(FileCount(), 0u);
}

TEST_F(ImageFiles, ReadingRefusesWhatIsNoImage) {
  EXPECT_EQ(ReadPng(Path("absent.png")).error().code, ErrorCode::kFileUnreadable);
  EXPECT_EQ(ReadPng(folder_.string()).error().code, ErrorCode::kFileUnreadable);
  std::ofstream(Path("text.png")) << "this is no picture";
  EXPECT_EQ(ReadPng(Path("text.png")).error().code, ErrorCode::kFormatUnknown);
  ASSERT_TRUE(WritePng(Path("whole.png"), Pattern(64, 64, 3)).ok());
  const std::string whole = Read(Path("whole.png"));
  std::ofstream(Path("cut.png"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_EQ(ReadPng(Path("cut.png")).error().code, ErrorCode::kFormatBroken);
  ASSERT_TRUE(WritePng(Path("picture.png"), Pattern(8, 8, 3)).ok());
  EXPECT_EQ(ReadDepth(Path("picture.png")).error().code, ErrorCode::kFormatUnknown);
}

}  // namespace
}  // namespace facetless
