// Files as other programs write them: types of numbers, byte orders, encodings, compression, and pictures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>

#include "render/image/io.h"
#include "render/voxel_files/natural_names.h"
#include "render/voxel_files/voxel_file.h"
#include "render/voxels/run_model.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::uint64_t kMemory = std::uint64_t{1} << 28;

void Store(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// The bytes of numbers of a type.
template <typename T>
std::string BytesOf(const std::vector<double>& numbers, bool big_endian) {
  std::string bytes;
  for (const double number : numbers) {
    const T value = static_cast<T>(number);
    char text[sizeof(T)];
    std::memcpy(text, &value, sizeof(T));
    if (big_endian) std::reverse(text, text + sizeof(T));
    bytes.append(text, sizeof(T));
  }
  return bytes;
}

std::string Deflated(const std::string& bytes, int window) {
  z_stream stream = {};
  deflateInit2(&stream, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}
std::string Gzipped(const std::string& bytes) {
  return Deflated(bytes, MAX_WBITS + 16);
}
std::string Zlibbed(const std::string& bytes) {
  return Deflated(bytes, MAX_WBITS);
}

std::string Base64(const std::string& bytes) {
  static const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text.push_back(i + k <= bytes.size() ? kLetters[bits >> (18 - 6 * k) & 63] : '=');
  }
  return text;
}

struct Type {
  const char *nrrd, *vtk;
  std::string (*bytes)(const std::vector<double>&, bool);
  bool is_signed, whole;
};
const std::vector<Type>& Types() {
  static const std::vector<Type> types = {{"unsigned char", "UInt8", BytesOf<std::uint8_t>, false, true},
                                          {"int8", "Int8", BytesOf<std::int8_t>, true, true},
                                          {"ushort", "UInt16", BytesOf<std::uint16_t>, false, true},
                                          {"short", "Int16", BytesOf<std::int16_t>, true, true},
                                          {"uint32", "UInt32", BytesOf<std::uint32_t>, false, true},
                                          {"int", "Int32", BytesOf<std::int32_t>, true, true},
                                          {"uint64_t", "UInt64", BytesOf<std::uint64_t>, false, true},
                                          {"long long", "Int64", BytesOf<std::int64_t>, true, true},
                                          {"float", "Float32", BytesOf<float>, true, false},
                                          {"double", "Float64", BytesOf<double>, true, false}};
  return types;
}

// Numbers that every type can hold, with a threshold between them.
struct Numbers {
  VoxelPoint size;
  std::vector<double> all;
  double threshold = 0;
  Type type;

  static Numbers Any() {
    Numbers numbers{{*rc::gen::inRange(1, 7), *rc::gen::inRange(1, 7), *rc::gen::inRange(1, 7)}, {}, 0, {}};
    numbers.type = *rc::gen::elementOf(Types());
    for (int i = 0; i < numbers.size.x * numbers.size.y * numbers.size.z; ++i)
      numbers.all.push_back(*rc::gen::inRange(numbers.type.is_signed ? -100 : 0, 120));
    numbers.threshold = *rc::gen::inRange(-3, 60);
    return numbers;
  }
  std::string Text() const {
    std::string text;
    for (const double number : all) text += " " + std::to_string(static_cast<int>(number)) + "\n";
    return text;
  }
  std::string Sizes() const {
    return std::to_string(size.x) + " " + std::to_string(size.y) + " " + std::to_string(size.z);
  }
  void Check(const Result<VoxelFile>& read) const {
    RC_ASSERT(read.ok());
    const VoxelModel& model = *read.value().model;
    RC_ASSERT((model.size() == size));
    std::size_t at = 0;
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x, ++at) {
          const Voxel voxel = model.Get(x, y, z);
          RC_ASSERT(voxel.filled() == (all[at] > threshold));
          const bool label = type.whole && all[at] >= 1;
          if (voxel.filled()) RC_ASSERT(voxel.material() == (label ? all[at] : 1));
        }
  }
};

RC_GTEST_PROP(OtherPrograms, NrrdOfAllTypesAndEncodings, ()) {
  const TemporaryFolder folder;
  const Numbers numbers = Numbers::Any();
  const bool big = *rc::gen::arbitrary<bool>();
  const std::string encoding = *rc::gen::elementOf(std::vector<std::string>{"raw", "gzip", "gz", "ascii"});
  const std::string bytes = numbers.type.bytes(numbers.all, big), path = folder.File("a.nrrd");
  Store(path, "NRRD0005\n# by others\ntype: " + std::string(numbers.type.nrrd) + "\ndimension: 3\nsizes: " +
                  numbers.Sizes() + "\nspacings: 0.5 0.5 0.5\nendian: " + (big ? "big" : "little") +
                  "\nencoding: " + encoding + "\nkey:=value\n\n" +
                  (encoding == "raw"     ? bytes
                   : encoding == "ascii" ? numbers.Text()
                                         : Gzipped(bytes)));
  const Result<VoxelFile> read = ReadVoxels(path, {.max_bytes = kMemory, .threshold = numbers.threshold});
  numbers.Check(read);
  RC_ASSERT(read.value().grid.has_value() && read.value().grid->pitch == 0.5);
}

// Every form in which VTK writes an array: as text, as base64 or appended, compressed in blocks or not.
RC_GTEST_PROP(OtherPrograms, VtiOfAllTypesAndForms, ()) {
  const TemporaryFolder folder;
  const Numbers numbers = Numbers::Any();
  const bool big = *rc::gen::arbitrary<bool>(), wide = *rc::gen::arbitrary<bool>(),
             points = *rc::gen::arbitrary<bool>(), compressed = *rc::gen::arbitrary<bool>();
  const auto length = [&](std::size_t n) {
    const std::vector<double> number{static_cast<double>(n)};
    return wide ? BytesOf<std::uint64_t>(number, big) : BytesOf<std::uint32_t>(number, big);
  };
  const std::string bytes = numbers.type.bytes(numbers.all, big);
  std::string header, data = bytes;
  if (compressed) {
    const std::size_t block = *rc::gen::inRange<std::size_t>(8, 300), last = bytes.size() % block;
    const std::size_t blocks = (bytes.size() + block - 1) / block;
    header = length(blocks) + length(block) + length(last);
    data.clear();
    for (std::size_t i = 0; i < blocks; ++i) {
      const std::string part = Zlibbed(bytes.substr(i * block, block));
      header += length(part.size());
      data += part;
    }
  } else {
    header = length(bytes.size());
  }
  const std::string base64 = compressed ? Base64(header) + Base64(data) : Base64(header + data);
  const std::string form = *rc::gen::elementOf(std::vector<std::string>{"ascii", "binary", "raw", "base64"});
  const bool appended = form == "raw" || form == "base64";
  const auto end = [&](int n) { return "0 " + std::to_string(points ? n - 1 : n); };
  const std::string extent = end(numbers.size.x) + " " + end(numbers.size.y) + " " + end(numbers.size.z),
                    where = points ? "PointData" : "CellData", path = folder.File("a.vti");
  Store(path,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"" +
            std::string(big ? "BigEndian" : "LittleEndian") + "\"" + (wide ? " header_type=\"UInt64\"" : "") +
            (compressed ? " compressor=\"vtkZLibDataCompressor\"" : "") + ">\n  <ImageData WholeExtent=\"" +
            extent + "\" Origin=\"1 2 3\" Spacing=\"2 2 2\">\n    <Piece Extent=\"" + extent +
            "\">\n      <" + where + " Scalars=\"s\">\n        <DataArray type=\"" + numbers.type.vtk +
            "\" Name=\"s\" format=\"" + (appended ? "appended" : form) +
            (appended ? "\" offset=\"0\"/>"
                      : "\" RangeMin=\"0\">\n          " + (form == "ascii" ? numbers.Text() : base64) +
                            "\n        </DataArray>") +
            "\n      </" + where + ">\n    </Piece>\n  </ImageData>\n" +
            (appended ? "  <AppendedData encoding=\"" + form + "\">\n   _" +
                            (form == "raw" ? header + data : base64) + "\n  </AppendedData>\n"
                      : "") +
            "</VTKFile>\n");
  const Result<VoxelFile> read = ReadVoxels(path, {.max_bytes = kMemory, .threshold = numbers.threshold});
  numbers.Check(read);
  RC_ASSERT(read.value().grid.has_value());
  RC_ASSERT(read.value().grid->origin.x == (points ? 0 : 1));
}

TEST(OtherPrograms, VtiThatIsNotReadIsNamed) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.vti");
  const auto message = [&](const std::string& attributes, const std::string& inside) {
    Store(path, "<VTKFile " + attributes + ">" + inside);
    return ReadVoxels(path, kMemory).error().message;
  };
  EXPECT_THAT(message("type=\"PolyData\"", ""), AllOf(StartsWith(path), HasSubstr("'PolyData'")));
  EXPECT_THAT(message("type=\"ImageData\" compressor=\"vtkLZ4DataCompressor\"",
                      "<Piece Extent=\"0 1 0 1 0 1\"><CellData><DataArray type=\"Int8\" format=\"binary\">1"),
              HasSubstr("'vtkLZ4DataCompressor'"));
  EXPECT_THAT(message("type=\"ImageData\"", "<Piece Extent=\"0 1 0 1 0 1\"><Piece>"), HasSubstr("one piece"));
  EXPECT_THAT(message("type=\"ImageData\"", "<Piece Extent=\"0 1 0 1 0 1\"></Piece>"), HasSubstr("no array"));
  EXPECT_THAT(
      message("type=\"ImageData\"",
              "<Piece Extent=\"0 99999999 0 1 0 1\"><CellData><DataArray type=\"Int8\" format=\"ascii\">1"),
      HasSubstr("voxels along an axis"));
  EXPECT_THAT(
      message(
          "type=\"ImageData\"",
          "<Piece Extent=\"0 65536 0 65536 0 65536\"><CellData><DataArray type=\"Int8\" format=\"ascii\">1"),
      HasSubstr("raise --max-view-memory"));
}

TEST(OtherPrograms, VoxelsThatAreNoCubesAreSaidToBeNone) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.nrrd");
  Store(path,
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nspace directions: (0.5,0,0) (0,0.5,0) "
        "(0,0,2)\nencoding: raw\n\na");
  const Result<VoxelFile> read = ReadVoxels(path, kMemory);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read.value().grid);
  ASSERT_EQ(read.value().warnings.size(), 1u);
  EXPECT_THAT(read.value().warnings[0], HasSubstr("(0,0,2)"));
  Store(path,
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nspace directions: (2,0,0) (0,2,0) (0,0,2)\nspace "
        "units: \"cm\" \"cm\" \"cm\"\nencoding: raw\n\na");
  EXPECT_EQ(ReadVoxels(path, kMemory).value().grid->pitch, 20);
}

TEST(NaturalNames, NumbersCountAsNumbers) {
  std::vector<std::string> names = {"s10.png", "s9.png", "s1a.png", "s02.png", "r99.png", "s1.png"};
  std::sort(names.begin(), names.end(), NaturallyBefore);
  EXPECT_THAT(names, ::testing::ElementsAre("r99.png", "s1.png", "s1a.png", "s02.png", "s9.png", "s10.png"));
  EXPECT_EQ(MissingName(std::vector<std::string>{"s8.png", "s9.png", "s11.png"}), "s10.png");
  EXPECT_EQ(MissingName(std::vector<std::string>{"s08.png", "s09.png", "s11.png"}), "s10.png");
  EXPECT_EQ(MissingName(std::vector<std::string>{"s0.png", "s1.png", "t5.png"}), "");
  EXPECT_EQ(MissingName(std::vector<std::string>{"a.png", "b.png"}), "");
}

Image8 Picture(int width, int height, int channels, std::uint8_t value) {
  return {width, height, channels,
          std::vector<std::uint8_t>(static_cast<std::size_t>(width * height * channels), value)};
}

class Slices : public ::testing::Test {
 protected:
  Slices() { std::filesystem::create_directory(path_); }
  std::string File(const std::string& name) const { return path_ + "/" + name; }
  Result<VoxelFile> Read(VoxelFileOptions options = {.max_bytes = kMemory}) const {
    return ReadVoxels(path_, options);
  }
  std::string Message() const {
    const auto read = Read();
    return read ? "read" : read.error().message;
  }
  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("slices");
};

TEST_F(Slices, OfOtherProgramsAreReadInNaturalOrder) {
  for (int i = 1; i <= 12; ++i)
    ASSERT_TRUE(WritePng(File("cut " + std::to_string(i) + ".png"),
                         Picture(2, 3, 3, static_cast<std::uint8_t>(i - 1))));
  Store(File("notes.txt"), "not a slice");
  const auto read = Read();
  ASSERT_TRUE(read) << read.error().message;
  const VoxelModel& model = *read.value().model;
  EXPECT_EQ(model.size(), (VoxelPoint{2, 3, 12}));
  EXPECT_FALSE(read.value().grid);
  EXPECT_FALSE(model.Get(1, 2, 0).filled()) << "black is empty in pictures without alpha";
  for (int z = 1; z < 12; ++z) EXPECT_EQ(model.Get(0, 0, z).red(), z);
  EXPECT_EQ(Read({.threshold = 5}).value().model->Count(), 6u * 6);
  const auto across_x = Read({.slice_axis = 0});
  EXPECT_EQ(across_x.value().model->size(), (VoxelPoint{12, 2, 3}));
  EXPECT_EQ(across_x.value().model->Get(7, 1, 2).red(), 7);
}

TEST_F(Slices, MayBeTiffFilesOfOnePage) {
  RunModel layer({3, 2, 1});
  for (const int z : {1, 2, 3}) {
    layer.Set(z - 1, 1, 0, Voxel::Of(static_cast<std::uint8_t>(z), 0, 0));
    ASSERT_TRUE(WriteVoxels(File("s" + std::to_string(z) + ".tiff"), layer, {{}, 1, layer.size()}));
  }
  const auto read = Read();
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read.value().model->size(), (VoxelPoint{3, 2, 3}));
  EXPECT_EQ(read.value().model->Count(), 6u);
  EXPECT_EQ(read.value().model->Get(1, 1, 2).red(), 2);
  ASSERT_TRUE(WriteVoxels(File("s2.tiff"), RunModel({3, 2, 2}), {{}, 1, {3, 2, 2}}));
  EXPECT_THAT(Message(), AllOf(StartsWith(File("s2.tiff")), HasSubstr("2 pages")));
}

TEST_F(Slices, WhatIsWrongIsOneErrorThatNamesTheFile) {
  EXPECT_THAT(Message(), HasSubstr("has no slices"));
  ASSERT_TRUE(WritePng(File("s1.png"), Picture(2, 2, 4, 9)));
  ASSERT_TRUE(WritePng(File("s3.png"), Picture(2, 2, 4, 9)));
  EXPECT_THAT(Message(), AllOf(StartsWith(File("s2.png")), HasSubstr("missing")));
  ASSERT_TRUE(WritePng(File("s2.png"), Picture(3, 2, 4, 9)));
  EXPECT_THAT(Message(), AllOf(StartsWith(File("s2.png")), HasSubstr("same size")));
  Store(File("s2.png"), "text");
  EXPECT_THAT(Message(), AllOf(StartsWith(File("s2.png")), HasSubstr("not a PNG")));
  std::filesystem::resize_file(File("s3.png"), std::filesystem::file_size(File("s3.png")) / 2);
  std::filesystem::copy_file(File("s3.png"), File("s2.png"),
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(Message(), StartsWith(File("s2.png")));
  Store(File("s4.jpg"), "");
  EXPECT_THAT(Message(), AllOf(StartsWith(File("s4.jpg")), HasSubstr("PNG and TIFF")));
  std::filesystem::remove(File("s4.jpg"));
  Store(File("s4.tif"), "");
  EXPECT_THAT(Message(), HasSubstr("of one kind"));
}

TEST_F(Slices, ThatAreMissingFromAWrittenFolderAreNoticed) {
  RunModel model({3, 4, 5});
  model.Fill(model.box(), Voxel::Of(5, 6, 7));
  std::filesystem::remove(path_);
  ASSERT_TRUE(WriteVoxels(path_ + "/", model, {{1, 2, 3}, 0.5, model.size()}));
  EXPECT_TRUE(Read());
  std::filesystem::remove(File("slice_0005.png"));
  EXPECT_THAT(Message(),
              AllOf(StartsWith(File("slices.json")), HasSubstr("3 × 4 × 5"), HasSubstr("3 × 4 × 4")));
  // A folder that holds anything is not written to.
  const auto written = WriteVoxels(path_, model, {{}, 1, model.size()});
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("not empty"));
  const std::atomic<bool> stop = true;
  const std::string other = folder_.File("other/");
  EXPECT_EQ(WriteVoxels(other, model, {{}, 1, model.size()}, {.cancel = &stop}).error().code,
            ErrorCode::kCancelled);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.File("")), {}), 1)
      << "nothing is left of it";
}

TEST_F(Slices, HostileSizesAreNotAllocated) {
  ASSERT_TRUE(WritePng(File("s1.png"), Picture(2000, 2000, 3, 0)));
  const auto read = Read({.max_bytes = 1 << 20});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kLimitExceeded);
  EXPECT_THAT(read.error().message, HasSubstr("--max-view-memory"));
}

}  // namespace
}  // namespace facetless
