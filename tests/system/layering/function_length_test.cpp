// Tests that no function of ours is longer than a hundred lines. Tables (lists outside of functions) are not
// counted.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "tests/support/files.h"
#include "tests/system/layering/functions.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kMostLines = 100;

// Returns each function as "head: lines".
std::vector<std::string> Listed(const FunctionList& list) {
  std::vector<std::string> listed;
  for (const FunctionExtent& function : list.functions)
    listed.push_back(function.head + ": " + std::to_string(function.lines()));
  return listed;
}

std::vector<std::string> FunctionsOfCpp(const std::string& text) {
  const FunctionList list = FindFunctions(text, SourceLanguage::kCpp);
  EXPECT_TRUE(list.balanced);
  return Listed(list);
}

TEST(FindFunctions, TheyStandInFilesNamespacesAndClasses) {
  EXPECT_THAT(FunctionsOfCpp(R"(
namespace a::b {
namespace {
class C : public D {
 public:
  explicit C(int x)
      : x_{x},
        y_(2) {
    Start();
  }
  int x() const { return x_; }

 private:
  int x_ = 0;
};
}
template <int N>
struct S {
  static const S* Make(std::vector<int> list = {}) {
    return {};
  }
};
}
TEST(Suite, Name) {
  const auto f = [] {
    if (x) { y(); }
  };
}
)"),
              ElementsAre("explicit C(int x) : x_, y_(2) : 5", "int x() const : 1",
                          "static const S* Make(std::vector<int> list = ) : 3", "TEST(Suite, Name) : 5"));
}

TEST(FindFunctions, TablesAreNoFunctions) {
  EXPECT_THAT(FunctionsOfCpp(R"(
constexpr std::array<Row, 2> kRows{{
    {"a", Size(1)},
    {"b", Size(2)},
}};
const std::function<void()> kNone = {};
enum class E { kA, kB };
)"),
              IsEmpty());
}

TEST(FindFunctions, AVariableMadeWithALambdaIsOne) {
  EXPECT_THAT(FunctionsOfCpp("const Table kTable = [] {\n  return Table();\n}();\n"),
              ElementsAre("const Table kTable = [] : 3"));
}

TEST(FindFunctions, CommentsTextsAndDirectivesAreNoCode) {
  EXPECT_THAT(
      FunctionsOfCpp("// {\n/* } */\n#define BRACE \\\n  {\n"
                     "void F() {\n  Put(\"}\", '{', U'}', '\\'', 1'000'000);\n  Put(R\"x(})\")x\");\n}\n"
                     "void G() { int a = 0x1'f; }\n"),
      ElementsAre("void F() : 4", "void G() : 1"));
}

TEST(FindFunctions, EachBranchFollowsWhatIsBeforeIt) {
  EXPECT_THAT(FunctionsOfCpp(R"(
#if defined(A)
namespace a {
void F() {
#else
namespace b {
void F(int) {
#endif
}
}
)"),
              ElementsAre("void F(int) : 3"));
}

TEST(FindFunctions, FunctionsOfJavaScript) {
  const FunctionList list = FindFunctions(R"(
export const table = {
  key: 'it\'s {',
};
export function shown(x, {a, b} = {}) {
  return `${x} {`;
}
export const doubled = x => {
  return 2 * x;
};
test("a name", async () => {
  await shown();
});
class View {
  get size() {
    return 1;
  }
}
)",
                                          SourceLanguage::kJavaScript);
  EXPECT_TRUE(list.balanced);
  EXPECT_THAT(Listed(list), ElementsAre("export function shown(x, = ) : 3", "export const doubled = x => : 3",
                                        "test(\"\", async () => : 3", "get size() : 3"));
}

TEST(FindFunctions, BracesThatDoNotMatchAreReported) {
  EXPECT_FALSE(FindFunctions("void F() {", SourceLanguage::kCpp).balanced);
  EXPECT_FALSE(FindFunctions("void F() {}}", SourceLanguage::kCpp).balanced);
}

std::string ReadAll(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(FunctionLength, NoFunctionIsLongerThanAHundredLines) {
  const std::set<std::string> cpp{".h", ".cpp"}, javascript{".js", ".mjs"};
  std::vector<std::string> too_long, unreadable;
  std::size_t functions = 0;
  for (const char* folder : {"import", "openvdb", "render", "bench", "server", "samples", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(SourceRoot() / folder)) {
      const std::string extension = entry.path().extension().string();
      if (!cpp.contains(extension) && !javascript.contains(extension)) continue;
      const FunctionList list =
          FindFunctions(ReadAll(entry.path()),
                        cpp.contains(extension) ? SourceLanguage::kCpp : SourceLanguage::kJavaScript);
      const std::string path = fs::relative(entry.path(), SourceRoot()).generic_string();
      if (!list.balanced) unreadable.push_back(path);
      functions += list.functions.size();
      for (const FunctionExtent& function : list.functions) {
        if (function.lines() <= kMostLines) continue;
        too_long.push_back(path + ":" + std::to_string(function.first_line) + ": " + function.head + ": " +
                           std::to_string(function.lines()) + " lines");
      }
    }
  }
  EXPECT_GT(functions, 1000u) << "under " << SourceRoot();
  EXPECT_THAT(unreadable, IsEmpty());
  EXPECT_THAT(too_long, IsEmpty());
}

}  // namespace
}  // namespace facetless
