// The importer itself: a child of the loaded one gives the same bytes as a new process, whatever was imported before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "render/model/model_file.h"
#include "server/importer/import_process.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

// The samples, and the files of FACETLESS_FORKED_FILES, separated by colons.
std::vector<std::string> Files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SourceRoot() / "samples")) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".step" || extension == ".iges") files.push_back(entry.path().string());
  }
  std::istringstream more(
      std::getenv("FACETLESS_FORKED_FILES") == nullptr ? "" : std::getenv("FACETLESS_FORKED_FILES"));
  for (std::string file; std::getline(more, file, ':');) files.push_back(file);
  return files;
}

// The numbers of a mesh in binary glTF: what follows its text, which tells the time that meshing took.
std::string NumbersOf(const std::string& glb) {
  std::uint32_t text_bytes = 0;
  constexpr std::size_t kLength = 12, kText = 20;  // where the text's length and the text begin
  if (glb.size() < kText) return glb;
  std::memcpy(&text_bytes, glb.data() + kLength, sizeof text_bytes);
  return glb.substr(std::min<std::size_t>(kText + text_bytes, glb.size()));
}

// What an import gives, without its times and its memory: the model, the mesh, or the error.
std::string BytesOf(const std::string& file, ForkServer* fork_server) {
  int started = 0;
  ImportRequest request;
  request.input = file;
  request.meshes = {{}};
  request.model_suffices = true;
  request.fork_server = fork_server;
  request.ended = [&](bool forked) { started += forked == (fork_server != nullptr) ? 1 : 2; };
  const auto files = RunImporter(request);
  EXPECT_EQ(started, 1) << file;
  if (!files.ok()) return files.error().message;
  auto model = ReadModel(files.value().model_path);
  EXPECT_TRUE(model.ok()) << file;
  if (!model.ok()) return {};
  ImportInfo& info = model.value().info;
  info.read_ms = info.transfer_ms = info.convert_ms = 0;
  info.peak_bytes = 0;
  const std::string copy = files.value().directory.File("copy.flm");
  EXPECT_TRUE(WriteModel(model.value(), copy).ok()) << file;
  std::string bytes = ReadText(copy);
  for (const std::string& mesh : files.value().mesh_paths) bytes += NumbersOf(ReadText(mesh));
  return bytes;
}

TEST(ForkedImport, GivesTheBytesOfANewProcess) {
  ForkServer fork_server(ImporterForkServer());
  ASSERT_GT(fork_server.WaitForProcess(60), 0);
  for (const std::string& file : Files())
    EXPECT_TRUE(BytesOf(file, &fork_server) == BytesOf(file, nullptr)) << file;
}

}  // namespace
}  // namespace facetless
