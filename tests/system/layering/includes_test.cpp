// Tests who may include whom. The rules are those of ARCHITECTURE.md, "Who may include whom", and must be
// changed in both places.
//
//  1. Of our own folders: server → bench, render, sandbox; bench → render; import → render/base, render/model,
//     sandbox; openvdb → render; render → render; sandbox → sandbox. Nothing includes tests/ or samples/.
//  2. The folders of render/ form a chain, and so do those of server/: each includes itself and those before
//     it.
//  3. Each third-party library has one home.
//  4. The libraries of render/ and bench/ never print and never end the process.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/files.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;

struct SourceFile {
  std::string path;                   // relative to the source root
  std::vector<std::string> includes;  // as written, without the quotes or brackets
  std::vector<std::string> lines;     // without // comments
};

SourceFile ReadSource(const fs::path& root, const fs::path& file) {
  static const std::regex include_line(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  SourceFile source{fs::relative(file, root).generic_string(), {}, {}};
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_match(line, match, include_line)) source.includes.push_back(match[1]);
    source.lines.push_back(line.substr(0, line.find("//")));
  }
  return source;
}

const std::vector<SourceFile>& Sources() {
  static const std::vector<SourceFile> sources = [] {
    std::vector<SourceFile> found;
    for (const char* folder :
         {"import", "openvdb", "render", "sandbox", "bench", "server", "samples", "tests"}) {
      for (const auto& entry : fs::recursive_directory_iterator(SourceRoot() / folder)) {
        const std::string extension = entry.path().extension().string();
        if (extension == ".h" || extension == ".cpp") found.push_back(ReadSource(SourceRoot(), entry.path()));
      }
    }
    return found;
  }();
  return sources;
}

bool StartsWith(const std::string& text, const std::string& prefix) {
  return text.rfind(prefix, 0) == 0;
}

bool StartsWithAny(const std::string& text, const std::vector<std::string>& prefixes) {
  for (const std::string& prefix : prefixes) {
    if (StartsWith(text, prefix)) return true;
  }
  return false;
}

// Every include of our own headers in a file below `folder` must begin with one of `allowed`.
std::vector<std::string> ForbiddenIncludes(const std::string& folder,
                                           const std::vector<std::string>& allowed) {
  std::vector<std::string> forbidden;
  for (const SourceFile& source : Sources()) {
    if (!StartsWith(source.path, folder)) continue;
    for (const std::string& include : source.includes) {
      if (!StartsWithAny(include,
                         {"import/", "render/", "sandbox/", "bench/", "server/", "samples/", "tests/"}))
        continue;
      if (!StartsWithAny(include, allowed)) forbidden.push_back(source.path + " includes " + include);
    }
  }
  return forbidden;
}

// Returns the files that include a header that matches `header`.
std::vector<std::string> IncludersOf(const std::string& header) {
  const std::regex pattern(header);
  std::vector<std::string> includers;
  for (const SourceFile& source : Sources()) {
    for (const std::string& include : source.includes) {
      if (!std::regex_match(include, pattern)) continue;
      includers.push_back(source.path);
      break;
    }
  }
  return includers;
}

std::vector<std::string> IncludersOutside(const std::string& header, const std::vector<std::string>& homes) {
  std::vector<std::string> outside;
  for (const std::string& file : IncludersOf(header)) {
    if (!StartsWithAny(file, homes)) outside.push_back(file);
  }
  return outside;
}

using testing::IsEmpty;
using testing::SizeIs;

TEST(Layering, TheSourceTreeIsRead) {
  EXPECT_GT(Sources().size(), 10u) << "under " << SourceRoot();
}

TEST(Layering, RenderKnowsNothingOfOursOutside) {
  EXPECT_THAT(ForbiddenIncludes("render/", {"render/"}), IsEmpty());
}

TEST(Layering, ImportSeesOnlyTheModel) {
  EXPECT_THAT(ForbiddenIncludes("import/", {"import/", "render/base/", "render/model/", "sandbox/"}),
              IsEmpty());
}

TEST(Layering, OpenVdbSeesOnlyFilesOfVoxels) {
  std::vector<std::string> forbidden;
  for (const SourceFile& source : Sources()) {
    if (!StartsWith(source.path, "openvdb/")) continue;
    for (const std::string& include : source.includes)
      if (StartsWithAny(include, {"import/", "sandbox/", "bench/", "server/"})) forbidden.push_back(include);
  }
  EXPECT_THAT(forbidden, IsEmpty());
  EXPECT_THAT(IncludersOutside("openvdb/.*", {"openvdb/", "tests/unit/openvdb/"}), IsEmpty());
}

TEST(Layering, ServerDoesNotSeeImport) {
  EXPECT_THAT(ForbiddenIncludes("server/", {"server/", "render/", "sandbox/", "bench/"}), IsEmpty());
}

TEST(Layering, SandboxStandsAlone) {
  EXPECT_THAT(ForbiddenIncludes("sandbox/", {"sandbox/"}), IsEmpty());
}

TEST(Layering, BenchSeesOnlyRender) {
  EXPECT_THAT(ForbiddenIncludes("bench/", {"bench/", "render/"}), IsEmpty());
}

TEST(Layering, SampleGeneratorStandsAlone) {
  EXPECT_THAT(ForbiddenIncludes("samples/", {"samples/"}), IsEmpty());
}

// Returns the includes in the folders of `root` that go up the chain, or to a folder that the chain does not
// name.
std::vector<std::string> IncludesUp(const std::string& root, const std::vector<std::string>& chain) {
  const auto place_of = [&](const std::string& path) {
    const std::string folder = fs::path(path).parent_path().generic_string();
    for (std::size_t i = 0; i < chain.size(); ++i)
      if (folder == root + "/" + chain[i]) return static_cast<int>(i);
    return -1;
  };
  std::vector<std::string> up;
  for (const SourceFile& source : Sources()) {
    if (!StartsWith(source.path, root + "/")) continue;
    const int place = place_of(source.path);
    if (place < 0) up.push_back(source.path + " is in no folder of the chain");
    for (const std::string& include : source.includes) {
      if (!StartsWith(include, root + "/")) continue;
      const int included = place_of(include);
      if (included < 0 || included > place) up.push_back(source.path + " includes " + include);
    }
  }
  return up;
}

TEST(Layering, FoldersOfRenderFormAChain) {
  EXPECT_THAT(IncludesUp("render", {"base", "model", "nurbs", "view", "accel", "kernels", "trace", "solve",
                                    "rays", "voxels", "baseline", "image", "shade", "voxel_files",
                                    "voxel_walks", "lines", "inspect", "compare", "trade"}),
              IsEmpty());
}

TEST(Layering, FoldersOfTheServerFormAChain) {
  EXPECT_THAT(IncludesUp("server", {"base", "importer", "options", "run", "service/store", "service/protocol",
                                    "service/jobs", "service/access", "service/http", "service", "command"}),
              IsEmpty());
}

TEST(Layering, EachLibraryHasOneHome) {
  EXPECT_THAT(IncludersOutside(R"(\w+\.[hlgp]xx)", {"import/", "samples/generator/", "tests/unit/import/",
                                                    "tests/verify/differential/", "tests/verify/blends/"}),
              IsEmpty())
      << "OpenCASCADE belongs in import/";
  EXPECT_THAT(IncludersOutside("embree.*", {"render/baseline/", "render/accel/embree_boxes.cpp"}), IsEmpty());
  EXPECT_THAT(IncludersOf("(png|tiffio|ImfOutputFile)\\.h"),
              testing::UnorderedElementsAre("render/image/png_file.cpp", "render/image/tiff_handle.h",
                                            "render/image/exr_file.cpp"));
  EXPECT_THAT(IncludersOf("render/image/tiff_handle\\.h"),
              testing::UnorderedElementsAre("render/image/depth_file.cpp", "render/image/tiff_pages.cpp"));
  EXPECT_THAT(IncludersOf("zlib\\.h"),
              testing::UnorderedElementsAre("render/voxel_files/byte_source.cpp",
                                            "tests/unit/voxel_files/other_programs_test.cpp"));
  EXPECT_THAT(IncludersOf("webp/.*"), testing::UnorderedElementsAre("render/image/webp_file.cpp"));
  EXPECT_THAT(IncludersOutside("OpenImageIO/.*", {"tests/unit/image/"}), IsEmpty())
      << "it loads two hundred libraries when a program starts";
  EXPECT_THAT(IncludersOutside("(.*/)?tiny_gltf\\.h", {"import/", "render/baseline/", "tests/unit/import/"}),
              IsEmpty());
  EXPECT_THAT(IncludersOf("zip\\.h"),
              testing::UnorderedElementsAre("render/baseline/threemf_writer.cpp",
                                            "tests/unit/baseline/mesh_writer_test.cpp"));
  EXPECT_THAT(IncludersOutside("(flatbuffers/.*|.*_generated\\.h)", {"render/model/"}), IsEmpty());
  EXPECT_THAT(IncludersOutside("hwy/.*", {"render/kernels/"}), IsEmpty());
  EXPECT_THAT(IncludersOutside("cairo.*", {"render/trade/"}), IsEmpty());
  EXPECT_THAT(IncludersOutside("(oneapi/)?tbb(/.*|\\.h)", {"render/base/parallel.h"}), IsEmpty())
      << "the thread sanitizer knows only the loops of parallel.h";
  EXPECT_THAT(IncludersOutside("openssl/.*", {"server/", "import/"}), IsEmpty());
}

TEST(Layering, HttplibIsInOneFile) {
  EXPECT_THAT(IncludersOutside("(.*/)?httplib\\.h", {"server/", "tests/"}), IsEmpty());
  std::vector<std::string> includers;
  for (const std::string& file : IncludersOf("(.*/)?httplib\\.h")) {
    if (StartsWith(file, "server/")) includers.push_back(file);
  }
  EXPECT_THAT(includers, SizeIs(1));
}

TEST(Layering, SqliteIsInOneFile) {
  EXPECT_THAT(IncludersOf("(.*/)?sqlite3\\.h"), testing::ElementsAre("server/service/store/database.cpp"));
}

TEST(Layering, PrometheusIsInOneFile) {
  EXPECT_THAT(IncludersOf("prometheus/.*"), testing::ElementsAre("server/service/http/metrics.cpp"));
}

TEST(Layering, LibrariesNeitherPrintNorEndTheProcess) {
  static const std::regex forbidden(
      R"((^|[^\w:.>])(std::)?(printf|fprintf|puts|abort|exit|_exit|terminate)\s*\(|std::(cout|cerr|clog)\b)");
  std::vector<std::string> found;
  for (const SourceFile& source : Sources()) {
    if (!StartsWithAny(source.path, {"render/", "bench/"})) continue;
    for (const std::string& line : source.lines) {
      if (std::regex_search(line, forbidden)) found.push_back(source.path + ": " + line);
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

}  // namespace
}  // namespace facetless
