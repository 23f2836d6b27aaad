// Files of voxels: what is written is read again, and what is no such file is one error.
#include "render/voxel_files/voxel_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/random_voxels.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

using testing::AnyModel;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void Store(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// The path of a model in a format.
std::string PathFor(const TemporaryFolder& folder, const VoxelFormat& format, const std::string& name) {
  return folder.File(name) + std::string(format.suffix);
}

// Whether a model that was read from a .vxl file is what was written: it stands on a layer that is solid down to the bottom,
// and is 256 voxels high.
void CheckVoxlap(const VoxelModel& model, const VoxelModel& other) {
  const VoxelPoint n = model.size();
  const int shift = other.size().z - n.z;
  for (int x = 0; x < n.x; ++x)
    for (int y = 0; y < n.y; ++y) {
      RC_ASSERT(other.Get(x, y, std::max(shift - 1, 0)).filled() && other.Get(x, y, 0).filled());
      for (int z = 0; z < n.z; ++z) {
        const Voxel a = model.Get(x, y, z), b = other.Get(x, y, z + shift);
        RC_ASSERT(a.filled() == b.filled());
        bool visible = false;
        for (const auto& [dx, dy, dz] :
             {std::tuple{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}})
          visible = visible || (!model.Get(x + dx, y + dy, z + dz).filled() && z + dz >= 0);
        if (a.filled() && visible) RC_ASSERT((a.bits & 0xffffffu) == (b.bits & 0xffffffu));
      }
    }
}

// Whether a model that was read is what was written, but for what the format loses.
void CheckRead(const VoxelFormat& format, const VoxelModel& model, const VoxelModel& other) {
  if (format.suffix == ".vxl") return CheckVoxlap(model, other);
  RC_ASSERT((other.size() == model.size()));
  if (format.loses.empty()) RC_ASSERT(SameVoxels(other, model));
  for (int x = 0; x < model.size().x; ++x)
    for (int y = 0; y < model.size().y; ++y)
      for (int z = 0; z < model.size().z; ++z) {
        const Voxel a = model.Get(x, y, z), b = other.Get(x, y, z);
        RC_ASSERT(a.filled() == b.filled());
        if (format.suffix == ".nrrd") RC_ASSERT(a.material() == b.material());
        if (format.name.find("slices") != std::string_view::npos)
          RC_ASSERT((a.bits & 0xffffffu) == (b.bits & 0xffffffu));
      }
}

RC_GTEST_PROP(VoxelFiles, AreReadAsTheyWereWritten, ()) {
  const TemporaryFolder folder;
  const RunModel model = AnyModel(12);
  const VoxelGrid grid{{0.1 * *rc::gen::inRange(-50, 50), 1e6, -3e-5},
                       std::exp2(*rc::gen::inRange(-30, 30)) / 3,
                       model.size()};
  const VoxelFileOptions options{.slice_axis = *rc::gen::inRange(0, 3)};
  for (const VoxelFormat& format : VoxelFormats()) {
    const std::string path = PathFor(folder, format, "a");
    RC_ASSERT(WriteVoxels(path, model, grid, options).ok());
    // The header says across which axis slices lie.
    const Result<VoxelFile> read = ReadVoxels(path, kMemory);
    RC_ASSERT(read.ok());
    CheckRead(format, model, *read.value().model);
    if (format.suffix == ".vxl") continue;
    RC_ASSERT(read.value().grid.has_value());
    RC_ASSERT(read.value().grid->pitch == grid.pitch);
    RC_ASSERT(Length(read.value().grid->origin - grid.origin) <= 1e-9 * (1 + grid.pitch));
  }
}

// Reads a model in one format, and writes what was read in another.
void CheckConversion(const VoxelFormat& from, const VoxelFormat& to, const RunModel& model) {
  const TemporaryFolder folder;
  const std::string source = PathFor(folder, from, "a"), target = PathFor(folder, to, "b");
  RC_ASSERT(WriteVoxels(source, model, {{}, 1, model.size()}).ok());
  const Result<VoxelFile> read = ReadVoxels(source, kMemory);
  RC_ASSERT(read.ok());
  RC_ASSERT(WriteVoxels(target, *read.value().model, {{}, 1, read.value().model->size()}).ok());
  const Result<VoxelFile> again = ReadVoxels(target, kMemory);
  RC_ASSERT(again.ok());
  CheckRead(to, *read.value().model, *again.value().model);
}

RC_GTEST_PROP(VoxelFiles, ConvertBetweenFormats, ()) {
  const int formats = static_cast<int>(VoxelFormats().size());
  const auto any = [&] { return VoxelFormats()[static_cast<std::size_t>(*rc::gen::inRange(0, formats))]; };
  CheckConversion(any(), any(), AnyModel(12));
}

TEST(VoxelFiles, EveryFormatSaysWhatItLoses) {
  for (const VoxelFormat& format : VoxelFormats())
    EXPECT_EQ(format.loses.empty(),
              format.suffix == ".oct" || format.suffix == ".raw" || format.suffix == ".vti")
        << format.name;
  const auto unknown = VoxelFormatOf("part.stl");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr(".oct, .vxl, .raw, .nrrd, .vti, .tif, or a folder"));
  EXPECT_TRUE(VoxelFormatOf("PART.NRRD"));
  EXPECT_EQ(VoxelFormatOf("a.TIFF").value()->name, "TIFF slices");
  EXPECT_EQ(VoxelFormatOf("a.nrrd/").value()->name, "folder of slices");
  EXPECT_FALSE(VoxelFormatOf("voxels"));
}

RunModel Sample() {
  RunModel model({7, 6, 5});
  model.Fill({{1, 1, 1}, {6, 5, 4}}, Voxel::Of(10, 200, 30, 4));
  model.Set(3, 3, 3, {});
  model.Set(0, 5, 4, Voxel::Of(1, 2, 3, 9));
  return model;
}

TEST(VoxelFiles, EveryFormatConvertsToEveryOther) {
  for (const VoxelFormat& from : VoxelFormats())
    for (const VoxelFormat& to : VoxelFormats()) {
      SCOPED_TRACE(std::string(from.name) + " to " + std::string(to.name));
      EXPECT_NO_THROW(CheckConversion(from, to, Sample()));
    }
}

// Every prefix of a file, and every file with one changed byte, is read as a model or is an error that names the file.
TEST(VoxelFiles, ThatAreCutOrChangedAreOneError) {
  const TemporaryFolder folder;
  for (const VoxelFormat& format : VoxelFormats()) {
    if (format.suffix == "/") continue;
    const std::string path = PathFor(folder, format, "a");
    ASSERT_TRUE(WriteVoxels(path, Sample(), {{0, 0, 0}, 1, {7, 6, 5}}));
    const std::string whole = Bytes(path);
    const bool vti = format.suffix == ".vti";  // bytes may be missing after its arrays
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 40) {
      Store(path, whole.substr(0, length));
      const Result<VoxelFile> read = ReadVoxels(path, kMemory);
      if (vti && length + 40 > whole.size()) continue;
      ASSERT_FALSE(read) << path << " of " << length << " bytes";
      EXPECT_THAT(read.error().message, StartsWith(path));
    }
    for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 150)
      for (const int mask : {1, 0x80, 0xff}) {
        std::string changed = whole;
        changed[at] = static_cast<char>(changed[at] ^ mask);
        Store(path, changed);
        const Result<VoxelFile> read = ReadVoxels(path, kMemory);
        if (format.suffix == ".oct" && at >= 8) {
          // Nearly all of an octree is covered by its checksum; its size and place are not.
          EXPECT_TRUE(!read || at < 56) << at;
        }
        if (!read) {
          EXPECT_THAT(read.error().message, StartsWith(path));
        }
      }
  }
}

TEST(VoxelFiles, HostileSizesAreNotAllocated) {
  const TemporaryFolder folder;
  const std::string nrrd = folder.File("a.nrrd");
  Store(nrrd, "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 65536 65536 65536\nencoding: gzip\n\nabc");
  EXPECT_EQ(ReadVoxels(nrrd, kMemory).error().code, ErrorCode::kLimitExceeded);
  Store(nrrd, "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 65536 65536 65536\nencoding: raw\n\nabc");
  EXPECT_EQ(ReadVoxels(nrrd, kMemory).error().code, ErrorCode::kFormatBroken);
  Store(nrrd, "NRRD0004\ntype: uint8\ndimension: 3\nsizes: -1 2 3\nencoding: raw\n\nabc");
  EXPECT_EQ(ReadVoxels(nrrd, kMemory).error().code, ErrorCode::kFormatBroken);
  Store(nrrd, "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n\nabc");
  EXPECT_THAT(ReadVoxels(nrrd, kMemory).error().message, HasSubstr("end too early, or are damaged"));
  Store(nrrd, "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: bzip2\n\nabc");
  EXPECT_THAT(ReadVoxels(nrrd, kMemory).error().message,
              HasSubstr("'bzip2' are not read; raw, gzip and ascii are"));
  Store(nrrd, "NRRD0004\ntype: block\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\nabc");
  EXPECT_THAT(ReadVoxels(nrrd, kMemory).error().message, HasSubstr("type 'block'"));
  const std::string raw = folder.File("a.raw");
  Store(raw, "12345678");
  EXPECT_THAT(ReadVoxels(raw, kMemory).error().message, HasSubstr("needs the header beside it"));
  Store(raw + ".json", R"({"format":"facetless-raw-voxels","version":1,"size":[1,1,1e9]})");
  EXPECT_EQ(ReadVoxels(raw, kMemory).error().code, ErrorCode::kFormatBroken);
  Store(raw + ".json", R"({"format":"facetless-raw-voxels","version":1,"size":[1,1,3]})");
  EXPECT_THAT(ReadVoxels(raw, kMemory).error().message, HasSubstr("needs 12 bytes"));
  Store(raw + ".json", R"({"format":"facetless-raw-voxels","version":1,"size":[1,1,2]})");
  EXPECT_TRUE(ReadVoxels(raw, kMemory));
  EXPECT_EQ(ReadVoxels(raw, 4).error().code, ErrorCode::kLimitExceeded);
  EXPECT_EQ(ReadVoxels(folder.File("none.oct"), kMemory).error().code, ErrorCode::kFileUnreadable);
}

TEST(VoxelFiles, AVoxlapFileOfOthers) {
  // One column: a floor of two voxels at 3 and 4, hidden down to 9, a ceiling of one voxel at 9, air to 200, then the ground.
  const TemporaryFolder folder;
  std::string bytes;
  const auto number = [&]<typename T>(T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  number(std::uint32_t{0x09072000});
  number(std::uint32_t{1});
  number(std::uint32_t{1});
  for (int i = 0; i < 12; ++i) number(0.0);
  bytes += std::string("\x04\x03\x04\x00", 4);
  for (const std::uint32_t color : {0x80112233u, 0x80445566u, 0x80778899u}) number(color);
  bytes += std::string("\x00\xc8\xc8\x0a", 4);
  number(0x80aabbccu);
  const std::string path = folder.File("a.vxl");
  Store(path, bytes);
  const Result<VoxelFile> read = ReadVoxels(path, kMemory);
  ASSERT_TRUE(read) << read.error().message;
  const VoxelModel& model = *read.value().model;
  const auto at = [&](int z_down) { return model.Get(0, 0, 255 - z_down); };
  EXPECT_FALSE(at(2).filled());
  EXPECT_EQ(at(3), Voxel::Of(0x11, 0x22, 0x33));
  EXPECT_EQ(at(4), Voxel::Of(0x44, 0x55, 0x66));
  EXPECT_TRUE(at(8).filled());
  EXPECT_EQ(at(9), Voxel::Of(0x77, 0x88, 0x99));
  EXPECT_FALSE(at(10).filled());
  EXPECT_FALSE(at(199).filled());
  EXPECT_EQ(at(200), Voxel::Of(0xaa, 0xbb, 0xcc));
  EXPECT_TRUE(at(255).filled());
}

TEST(VoxelFiles, TooHighForVoxlap) {
  const TemporaryFolder folder;
  RunModel model({2, 2, 256});
  EXPECT_EQ(WriteVoxels(folder.File("a.vxl"), RunModel({2, 2, 255}), {}).error().code, ErrorCode::kBadUsage);
  EXPECT_EQ(WriteVoxels(folder.File("a.vxl"), model, {}).error().code, ErrorCode::kBadUsage);
  // One that stands on a solid layer needs no other.
  model.Fill({{0, 0, 0}, {2, 2, 1}}, Voxel::Of(1, 2, 3));
  model.Fill({{0, 0, 1}, {1, 1, 256}}, Voxel::Of(9, 8, 7));
  ASSERT_TRUE(WriteVoxels(folder.File("b.vxl"), model, {}));
  EXPECT_TRUE(SameVoxels(*ReadVoxels(folder.File("b.vxl"), kMemory).value().model, RunModel(model)) ||
              ReadVoxels(folder.File("b.vxl"), kMemory).value().model->Count() == model.Count());
  EXPECT_EQ(WriteVoxels("/nowhere/a.oct", Sample(), {}).error().code, ErrorCode::kWriteFailed);
}

}  // namespace
}  // namespace facetless
