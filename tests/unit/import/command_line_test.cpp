#include "import/command_line.h"

#include <gtest/gtest.h>

namespace facetless {
namespace {

Result<CommandLine> Parse(std::vector<const char*> words) {
  words.insert(words.begin(), "facetless-import");
  return ParseCommandLine(static_cast<int>(words.size()), words.data());
}

TEST(CommandLine, MeshOptionsBelongToTheMeshBeforeThem) {
  const Result<CommandLine> line =
      Parse({"in.step", "--model", "out.flm", "--mesh", "a.glb", "--deflection", "1e-4", "--mesh", "b.glb",
             "--deflection-mm", "0.5", "--angular", "5", "--deadline-s", "2.5"});
  ASSERT_TRUE(line.ok()) << line.error().message;
  EXPECT_EQ(line.value().input, "in.step");
  EXPECT_EQ(line.value().model, "out.flm");
  ASSERT_EQ(line.value().meshes.size(), 2u);
  EXPECT_EQ(line.value().meshes[0].deflection, 1e-4);
  EXPECT_EQ(line.value().meshes[0].angular_deg, 20);
  EXPECT_EQ(line.value().meshes[1].deflection_mm, 0.5);
  EXPECT_EQ(line.value().meshes[1].angular_deg, 5);
  EXPECT_EQ(line.value().deadline_s, 3u);
}

TEST(CommandLine, RaysForTheExactIntersector) {
  const Result<CommandLine> line = Parse({"in.step", "--model", "out.flm", "--rays", "r", "--depths", "d",
                                          "--rays-seconds", "3", "--rays-near", "0.5"});
  ASSERT_TRUE(line.ok()) << line.error().message;
  EXPECT_EQ(line.value().rays, "r");
  EXPECT_EQ(line.value().depths, "d");
  EXPECT_EQ(line.value().rays_seconds, 3);
  EXPECT_EQ(line.value().rays_near, 0.5);
}

TEST(CommandLine, SaysWhichOptionIsWrong) {
  struct Case {
    std::vector<const char*> words;
    const char* sentence;
  };
  const Case cases[] = {{{}, "input"},
                        {{"a", "b", "--model", "m"}, "two input"},
                        {{"a"}, "--model"},
                        {{"a", "--model"}, "needs a value"},
                        {{"a", "--model", "m", "--deflection", "1"}, "must follow"},
                        {{"a", "--model", "m", "--mesh", "x", "--deflection", "0"}, "above 0"},
                        {{"a", "--model", "m", "--mesh", "x", "--angular", "nan"}, "above 0"},
                        {{"a", "--model", "m", "--rays", "r"}, "go together"},
                        {{"a", "--modle", "m"}, "--modle"}};
  for (const Case& c : cases) {
    const Result<CommandLine> line = Parse(c.words);
    ASSERT_FALSE(line.ok());
    EXPECT_EQ(line.error().code, ErrorCode::kBadUsage);
    EXPECT_NE(line.error().message.find(c.sentence), std::string::npos) << line.error().message;
  }
}

}  // namespace
}  // namespace facetless
