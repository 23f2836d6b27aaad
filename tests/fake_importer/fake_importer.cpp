// Stands in for facetless-import in tests. What it does is the first word of the input file:
//   ok         writes a model of one square, and a mesh file of a few bytes per --mesh
//   slow       the same after so many milliseconds (second word)
//   unusable   exit code 4 with an error of the given code (second word)
//   crash      dies of SIGSEGV
//   hang       never ends, and ignores SIGTERM
//   spin       uses processor time without end
//   memory     allocates until it fails, and dies of the exception
//   flood      writes without end to both streams
//   bigfile    writes a file without end
//   socket     reports whether it may open a socket
//   fork       reports whether it may start a process
//   env        reports its environment, directory and open files
//   garbage    exits 0 with an answer that is no JSON
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "render/model/model_file.h"

namespace {

using facetless::Model;

// A 10 mm × 10 mm square in the plane z = 0: one bilinear patch, no loops.
Model Square() {
  Model model;
  model.info.file = "square";
  model.info.sha256 = std::string(64, '0');
  model.info.format = "TEST";
  model.info.unit = "millimetre";
  model.info.faces_declared = model.info.faces_imported = 1;
  model.spans = {{0, 10}, {0, 10}};
  model.control_points = {{0, 0, 0, 1}, {0, 10, 0, 1}, {10, 0, 0, 1}, {10, 10, 0, 1}};
  facetless::Surface surface;
  surface.kind = facetless::SurfaceKind::kPlane;
  surface.u_spans = {0, 1};
  surface.v_spans = {1, 1};
  model.surfaces = {surface};
  facetless::Face face;
  face.name = "square";
  model.faces = {face};
  facetless::Part part;
  part.name = "square";
  part.faces = {0, 1};
  model.parts = {part};
  model.instances.emplace_back();
  model.bounds.Add({0, 0, 0});
  model.bounds.Add({10, 10, 0});
  return model;
}

int Answer(const std::string& text) {
  std::printf("%s\n", text.c_str());
  return 0;
}

int WriteModelAndMeshes(int argc, char** argv) {
  std::fprintf(stderr, "progress read 0.5\nprogress transfer 1\n");
  for (int i = 2; i + 1 < argc; ++i) {
    if (std::string(argv[i]) == "--mesh") std::ofstream(argv[i + 1]) << "mesh";
    if (std::string(argv[i]) != "--model") continue;
    if (auto written = facetless::WriteModel(Square(), argv[i + 1]); !written) {
      std::fprintf(stderr, "%s\n", written.error().message.c_str());
      return 70;
    }
  }
  return Answer(R"({"ok":true,"faces":1})");
}

int ReportEnvironment() {
  std::string text =
      "{\"ok\":true,\"directory\":\"" + std::filesystem::current_path().string() + "\",\"environment\":[";
  for (char** entry = environ; *entry != nullptr; ++entry)
    text += std::string(entry == environ ? "" : ",") + "\"" + *entry + "\"";
  int files = 0;
  for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator("/proc/self/fd")) ++files;
  // Besides, the iterator's directory and the input are open.
  return Answer(text + "],\"files\":" + std::to_string(files - 2) + "}");
}

}  // namespace

int main(int argc, char** argv) {
  std::ifstream input(argv[1]);
  std::string mode, detail;
  input >> mode >> detail;
  if (mode == "ok") return WriteModelAndMeshes(argc, argv);
  if (mode == "slow") {
    std::this_thread::sleep_for(std::chrono::milliseconds(std::atoi(detail.c_str())));
    return WriteModelAndMeshes(argc, argv);
  }
  if (mode == "unusable") {
    Answer("{\"ok\":false,\"error\":{\"code\":\"" + detail + "\",\"message\":\"nothing in here\"}}");
    return 4;
  }
  if (mode == "crash") {
    signal(SIGSEGV, SIG_DFL);
    raise(SIGSEGV);
  }
  if (mode == "hang") {
    signal(SIGTERM, SIG_IGN);
    for (;;) pause();
  }
  if (mode == "spin") {
    std::atomic<long> turns{0};
    for (;;) ++turns;
  }
  if (mode == "memory") {
    std::vector<std::string> blocks;
    for (;;) blocks.emplace_back(std::size_t{1} << 24, 'x');
  }
  if (mode == "flood") {
    const std::string block(1 << 16, 'x');
    for (;;) {
      std::fputs(block.c_str(), stdout);
      std::fputs(block.c_str(), stderr);
    }
  }
  if (mode == "bigfile") {
    std::ofstream file("big");
    const std::string block(1 << 20, 'x');
    for (;;) file << block << std::flush;
  }
  if (mode == "socket")
    return Answer(std::string("{\"ok\":true,\"denied\":") +
                  (socket(AF_INET, SOCK_STREAM, 0) < 0 ? "true}" : "false}"));
  if (mode == "fork") {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    return Answer(std::string("{\"ok\":true,\"denied\":") + (child < 0 ? "true}" : "false}"));
  }
  if (mode == "env") return ReportEnvironment();
  if (mode == "garbage") return Answer("hello");
  std::fprintf(stderr, "unknown mode %s\n", mode.c_str());
  return 70;
}
