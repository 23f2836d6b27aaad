// Tests that the exact pictures of every sample have the same bytes with every instruction set of this
// machine, and with any number of threads.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "render/kernels/dispatch.h"
#include "tests/support/files.h"
#include "tests/system/samples/program.h"
#include "tests/system/samples/samples.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;

// Returns the contents of a folder's pictures. Reports are excluded, because they contain times.
std::map<std::string, std::string> Pictures(const fs::path& folder) {
  std::map<std::string, std::string> pictures;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".png" && extension != ".tif" && extension != ".exr") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    pictures[entry.path().filename().string()] =
        std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return pictures;
}

class SameBytes : public testing::TestWithParam<std::string> {
 protected:
  ~SameBytes() override { unsetenv("FACETLESS_ISA"); }

  // Renders the sample in certified precision with all AOVs; both projections.
  std::map<std::string, std::string> Render(const std::string& isa, int threads) {
    const fs::path folder = fs::path(testing::TempDir()) / ("same_bytes_" + TestName(GetParam()));
    fs::remove_all(folder);
    setenv("FACETLESS_ISA", isa.c_str(), 1);
    std::map<std::string, std::string> all;
    for (const std::string projection : {"orthographic", "perspective"}) {
      const ProgramResult rendered = RunProgram(
          "facetless render '" + Sample(GetParam()) + "' --out '" + folder.string() +
          "' --size 203x151 --precision certified --projection " + projection +
          " --aov depth,normal,face,uv,certificate --threads " + std::to_string(threads) + " 2> /dev/null");
      EXPECT_EQ(rendered.exit_code, 0);
      for (auto& [name, bytes] : Pictures(folder)) all[projection + " " + name] = std::move(bytes);
    }
    fs::remove_all(folder);
    return all;
  }
};

TEST_P(SameBytes, OnEveryInstructionSetAndNumberOfThreads) {
  const std::vector<Kernels> kernels = AvailableKernels();
  const std::map<std::string, std::string> expected = Render(kernels.front().isa, 1);
  ASSERT_GE(expected.size(), 6u);  // colour, depth, AOVs
  int threads = 1;
  for (const Kernels& other : kernels) {
    threads = threads == 1 ? 2 : 7;
    const std::map<std::string, std::string> pictures = Render(other.isa, threads);
    ASSERT_EQ(pictures.size(), expected.size());
    for (const auto& [name, bytes] : expected)
      EXPECT_TRUE(pictures.at(name) == bytes)
          << name << " with " << other.isa << " on " << threads << " threads";
  }
}

// Returns the samples that can be rendered.
std::vector<std::string> SoundSamples() {
  std::vector<std::string> names;
  for (const std::string& name : SampleNames())
    if (name.find('/') == std::string::npos) names.push_back(name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, SameBytes, testing::ValuesIn(SoundSamples()),
                         [](const auto& info) { return TestName(info.param); });

}  // namespace
}  // namespace facetless
