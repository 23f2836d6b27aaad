// facetless-openvdb reads or writes one .vdb file; then the process ends. Voxels come and go as .oct files.
//
//     facetless-openvdb INPUT.vdb --read OUT.oct [--threshold T] [--max-bytes N]
//     facetless-openvdb INPUT.oct --write OUT.vdb [--max-bytes N]
//     facetless-openvdb INPUT.oct --measure MESH RAYS OUT    (measure.h)
//
// Standard output is one JSON object. Exit status: 0 done, 4 nothing usable, 64 bad usage. The caller sets the limits of
// memory and time; whatever the library throws is one error.
#include <openvdb/openvdb.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "openvdb/grid_file.h"
#include "openvdb/measure.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr int kExitDone = 0, kExitNothingUsable = 4, kExitUsage = 64;

int Answer(const Json& json, int status) {
  std::cout << json.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
  return status;
}
int Fail(const Error& error) {
  return Answer({{"ok", false}, {"error", {{"code", ErrorCodeName(error.code)}, {"message", error.message}}}},
                error.code == ErrorCode::kBadUsage ? kExitUsage : kExitNothingUsable);
}

struct Arguments {
  std::string input, command;
  std::vector<std::string> files;
  double threshold = 0;
  std::uint64_t max_bytes = std::uint64_t{4} << 30;
};

bool Parse(int argc, char** argv, Arguments& arguments) {
  if (argc < 4) return false;
  arguments.input = argv[1];
  arguments.command = argv[2];
  for (int i = 3; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--threshold" && i + 1 < argc) {
      arguments.threshold = std::strtod(argv[++i], nullptr);
    } else if (word == "--max-bytes" && i + 1 < argc) {
      arguments.max_bytes = std::strtoull(argv[++i], nullptr, 10);
    } else {
      arguments.files.push_back(word);
    }
  }
  const std::size_t files = arguments.command == "--measure" ? 3 : 1;
  return arguments.files.size() == files &&
         (arguments.command == "--read" || arguments.command == "--write" || files == 3);
}

int Read(const Arguments& arguments) {
  const Result<VoxelFile> read = ReadGrids(arguments.input, arguments.threshold, arguments.max_bytes);
  if (!read.ok()) return Fail(read.error());
  // A pitch of 0 says that there is no grid.
  const VoxelGrid grid = read.value().grid.value_or(VoxelGrid{{}, 0, read.value().model->size()});
  if (auto written = WriteVoxels(arguments.files[0], *read.value().model, grid); !written.ok())
    return Fail(written.error());
  return Answer({{"ok", true}, {"warnings", read.value().warnings}}, kExitDone);
}

int Write(const Arguments& arguments) {
  const Result<VoxelFile> read = ReadVoxels(arguments.input, arguments.max_bytes);
  if (!read.ok()) return Fail(read.error());
  const VoxelGrid grid = read.value().grid.value_or(VoxelGrid{{}, 1, read.value().model->size()});
  if (auto written = WriteGrids(arguments.files[0], *read.value().model, grid); !written.ok())
    return Fail(written.error());
  return Answer({{"ok", true}}, kExitDone);
}

int Run(const Arguments& arguments) {
  try {
    openvdb::initialize();
    if (arguments.command == "--read") return Read(arguments);
    if (arguments.command == "--write") return Write(arguments);
    const Result<Json> measured = Measure(arguments.input, arguments.files[0], arguments.files[1],
                                          arguments.files[2], arguments.max_bytes);
    return measured.ok() ? Answer(measured.value(), kExitDone) : Fail(measured.error());
  } catch (const std::bad_alloc&) {
    return Fail({ErrorCode::kLimitExceeded, arguments.input +
                                                ": OpenVDB needs more memory than it may use; raise "
                                                "--max-view-memory"});
  } catch (const openvdb::Exception& failure) {
    return Fail({ErrorCode::kFormatBroken, arguments.input + ": OpenVDB says: " + failure.what()});
  } catch (const std::exception& failure) {
    return Fail({ErrorCode::kFormatBroken, arguments.input + ": OpenVDB failed: " + failure.what()});
  }
}

}  // namespace
}  // namespace facetless

int main(int argc, char** argv) {
  facetless::Arguments arguments;
  if (!facetless::Parse(argc, argv, arguments))
    return facetless::Fail(
        {facetless::ErrorCode::kBadUsage,
         "usage: facetless-openvdb INPUT --read OUT.oct | --write OUT.vdb | --measure MESH RAYS OUT"});
  return facetless::Run(arguments);
}
