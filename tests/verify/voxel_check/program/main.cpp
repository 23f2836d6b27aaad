// facetless_voxel_check FILE... [--resolution N] [--far N] [--near N] [--seed N] prints the table of docs/voxels.md for any
// CAD files with closed solids.
//
// It writes one Markdown row per file to standard output. Exit status: 0 no wrong voxel, 2 some, 4 a file that cannot be
// checked, 64 bad usage.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/verify/voxel_check/voxel_check.h"

namespace facetless {
namespace {

using Number = unsigned long long;

void PrintRow(const std::string& file, const VoxelCheck& check) {
  std::printf(
      "| %s | %llu | %u | %llu | %llu | %llu | %llu | %llu | %llu | %llu | %llu | %llu | %.0f | %.2f |\n",
      std::filesystem::path(file).filename().c_str(), Number(check.solids), check.open_faces,
      Number(check.filled), Number(check.far.centres), Number(check.far.inside), Number(check.far.undecided),
      Number(check.far.reference_wrong), Number(check.far.wrong), Number(check.near.centres),
      Number(check.near.undecided), Number(check.near.wrong), check.voxelize_ms,
      check.far_ms / double(check.far.centres > 0 ? check.far.centres : 1));
  std::fflush(stdout);
}

int Main(int argc, char** argv) {
  CLI::App app{"Checks voxels against OpenCASCADE's classifier and against an oracle in extended precision."};
  std::vector<std::string> files;
  VoxelCheckOptions options;
  options.far = 20000;
  options.near = 200;
  app.add_option("files", files, "STEP and IGES files")->required();
  app.add_option("--resolution", options.resolution, "voxels along the longest side");
  app.add_option("--far", options.far, "centres for the classifier");
  app.add_option("--near", options.near, "centres for the oracle");
  app.add_option("--seed", options.seed, "seed of the random centres");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  std::printf(
      "| file | closed solids | open faces | filled | far centres | inside | undecided | classifier wrong | "
      "wrong | near "
      "centres | undecided | wrong | voxelize, ms | classifier, ms per centre "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  int status = 0;
  for (const std::string& file : files) {
    const Result<VoxelCheck> check = CheckVoxels(file, options);
    if (!check.ok()) {
      std::fprintf(stderr, "%s\n", check.error().message.c_str());
      status = std::max(status, 4);
      continue;
    }
    PrintRow(file, check.value());
    if (check.value().first_wrong.empty()) continue;
    std::fprintf(stderr, "%s: %s\n", file.c_str(), check.value().first_wrong.c_str());
    status = std::max(status, 2);
  }
  return status;
}

}  // namespace
}  // namespace facetless

int main(int argc, char** argv) {
  return facetless::Main(argc, argv);
}
