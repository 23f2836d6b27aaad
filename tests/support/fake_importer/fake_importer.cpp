// Replaces facetless-import in tests. The first word of the input file selects its behaviour:
//   ok         writes a model of one square, and a mesh file of its two triangles per --mesh
//   slow       does the same after the given number of milliseconds (second word)
//   unmeshed   does the same as ok, and reports that a face has no triangle
//   unusable   exits with code 4 and an error of the given code (second word)
//   mesh-MODE  writes its model, begins to mesh, and only then does what MODE says; without a --mesh it acts like ok
//   crash      dies of SIGSEGV
//   hang       never ends, and ignores SIGTERM
//   spin       uses processor time without end
//   memory     allocates until it fails, and dies of the exception
//   flood      writes without end to both streams
//   bigfile    writes a file without end
//   outputs    writes files of 256 KB without end
//   manyfiles  writes small files without end
//   deep       makes nested directories without end
//   nameless   writes without end to files that it has removed
//   threads    starts threads without end
//   leave      leaves its process group, then hangs
//   link       answers with a model file that is a symbolic link to the given path (second word)
//   pipe       answers with a model file that is a pipe
//   nothing    reports success, but has written nothing
//   words      dies with an error text that must not reach a terminal
//   lies       answers with an error code that does not exist
//   open       reports how many files it may open, as `opened`
// With --serve-forks alone it forks a child for each file, as the importer does.
// The following report as `denied` whether they were prevented:
//   socket, fork, vfork, memfd
//   signal     signals its parent, its parent's group and all processes
//   ptrace     attaches to its parent, reads its memory, changes its limits
//   read, list, write, run      the given path
// Two more:
//   env        reports its environment, directory and open files
//   garbage    exits with 0 and an answer that is no JSON
#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "render/model/builder.h"
#include "render/model/model_file.h"
#include "sandbox/fork_requests.h"

namespace {

using facetless::Model;

// A 10 mm × 10 mm square in the plane z = 0: one bilinear patch, no loops.
Model Square() {
  facetless::ModelBuilder builder;
  facetless::ImportInfo& info = builder.info();
  info.file = "square";
  info.sha256 = std::string(64, '0');
  info.format = "TEST";
  info.unit = "millimetre";
  info.faces_declared = info.faces_imported = 1;
  builder.AddPart("square");
  facetless::Face face;
  face.name = "square";
  builder.AddFace({facetless::SurfaceKind::kPlane,
                   1,
                   1,
                   {{0, 10}},
                   {{0, 10}},
                   {{0, 0, 0, 1}, {0, 10, 0, 1}, {10, 0, 0, 1}, {10, 10, 0, 1}}},
                  face);
  builder.AddInstance({});
  return std::move(builder).Finish().value();
}

int Answer(const std::string& text) {
  std::printf("%s\n", text.c_str());
  return 0;
}

// The square's two triangles, in the format in which the importer writes a mesh.
std::string SquareMesh() {
  const float vectors[24] = {-5, -5, 0, 5, -5, 0, 5, 5, 0, -5, 5, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  const std::uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  std::string data(reinterpret_cast<const char*>(vectors), sizeof vectors);
  data.append(reinterpret_cast<const char*>(indices), sizeof indices);
  std::string json =
      R"({"asset":{"version":"2.0","extras":{"from_model":true,"deflection_mm":1,"angular_deg":20}},"scene":0,)"
      R"("scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"matrix":[1e-3,0,0,0,0,0,-1e-3,0,0,1e-3,0,0,0,0,0,1]},)"
      R"({"mesh":0,"translation":[5,5,0],"extras":{"first_placed_face":0}}],"meshes":[{"primitives":[{"attributes":)"
      R"({"POSITION":0,"NORMAL":1},"indices":2,"extras":{"face":0}}]}],"buffers":[{"byteLength":120}],"bufferViews":)"
      R"([{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":24}],"accessors":[{"bufferView":0,)"
      R"("componentType":5126,"count":4,"type":"VEC3"},{"bufferView":0,"byteOffset":48,"componentType":5126,"count":4,)"
      R"("type":"VEC3"},{"bufferView":1,"componentType":5125,"count":6,"type":"SCALAR"}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t value) {
    const auto stored = static_cast<std::uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&stored), sizeof stored);
  };
  return "glTF" + word(2) + word(28 + json.size() + data.size()) + word(json.size()) + "JSON" + json +
         word(data.size()) + std::string("BIN\0", 4) + data;
}

int WriteModelAndMeshes(int argc, const char* const* argv, bool answer = true) {
  std::fprintf(stderr, "progress read 0.5\nprogress transfer 1\n");
  for (int i = 2; i + 1 < argc; ++i) {
    if (std::string(argv[i]) == "--mesh") std::ofstream(argv[i + 1]) << SquareMesh();
    if (std::string(argv[i]) != "--model") continue;
    if (auto written = facetless::WriteModel(Square(), argv[i + 1]); !written) {
      Answer(R"({"ok":false,"error":{"code":"write-failed","message":"The model cannot be written."}})");
      return 4;  // the same exit code as the importer
    }
  }
  return answer ? Answer(R"({"ok":true,"faces":1})") : 0;
}

int ReportDenied(int argc, const char* const* argv, bool denied) {
  WriteModelAndMeshes(argc, argv, false);
  return Answer(std::string("{\"ok\":true,\"denied\":") + (denied ? "true}" : "false}"));
}

// Returns whether signals to all other processes are denied.
bool SignalsDenied() {
  const pid_t parent = getppid();
  siginfo_t info = {};
  info.si_code = SI_QUEUE;
  const long handle = syscall(SYS_pidfd_open, parent, 0);
  return kill(parent, 0) != 0 && kill(-getpgid(parent), 0) != 0 && kill(-1, 0) != 0 &&
         syscall(SYS_tgkill, parent, parent, 0) != 0 && syscall(SYS_tkill, parent, 0) != 0 &&
         syscall(SYS_rt_sigqueueinfo, parent, 0, &info) != 0 &&
         (handle < 0 || syscall(SYS_pidfd_send_signal, handle, 0, nullptr, 0) != 0);
}

// Returns whether it is denied to inspect or change the parent process.
bool TracingDenied() {
  const pid_t parent = getppid();
  char here[8] = {};
  iovec to = {here, sizeof here}, from = {here, sizeof here};
  const rlimit limit = {RLIM_INFINITY, RLIM_INFINITY};
  return ptrace(PTRACE_ATTACH, parent, nullptr, nullptr) != 0 &&
         process_vm_readv(parent, &to, 1, &from, 1, 0) < 0 &&
         prlimit(parent, RLIMIT_CORE, &limit, nullptr) != 0;
}

bool IsDenied(const std::string& mode, const std::string& path) {
  if (mode == "socket") {
    int pair[2];
    return socket(AF_INET, SOCK_STREAM, 0) < 0 && socket(AF_INET6, SOCK_DGRAM, 0) < 0 &&
           socket(AF_UNIX, SOCK_STREAM, 0) < 0 && socket(AF_NETLINK, SOCK_RAW, 0) < 0 &&
           socketpair(AF_UNIX, SOCK_STREAM, 0, pair) < 0;
  }
  if (mode == "fork") {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    return child < 0;
  }
  if (mode == "vfork") {
    const long child = syscall(SYS_clone, CLONE_VM | CLONE_VFORK | SIGCHLD, nullptr);
    if (child == 0) _exit(0);
    return child < 0;
  }
  if (mode == "memfd")
    return syscall(SYS_memfd_create, "bomb", 0) < 0 && open(".", O_TMPFILE | O_RDWR, 0600) < 0;
  if (mode == "signal") return SignalsDenied();
  if (mode == "ptrace") return TracingDenied();
  if (mode == "read") return open(path.c_str(), O_RDONLY) < 0;
  if (mode == "list") return opendir(path.c_str()) == nullptr;
  if (mode == "write") return open(path.c_str(), O_WRONLY | O_CREAT, 0600) < 0;
  // execve returns only if it failed.
  char* arguments[] = {const_cast<char*>(path.c_str()), nullptr};
  execve(path.c_str(), arguments, environ);
  return true;
}

void WriteWithoutEnd(const std::string& mode) {
  const std::string block(1 << 20, 'x');
  for (int i = 0;; ++i) {
    const std::string name = "file" + std::to_string(i);
    if (mode == "bigfile") {
      std::ofstream file("big");
      for (;;) file << block << std::flush;
    } else if (mode == "outputs") {
      std::ofstream(name) << block.substr(0, 1 << 18);
    } else if (mode == "manyfiles") {
      std::ofstream(name) << "x";
    } else if (mode == "deep") {
      if (mkdir(name.c_str(), 0700) != 0 || chdir(name.c_str()) != 0) pause();
    } else {
      const int file = open(name.c_str(), O_CREAT | O_WRONLY, 0600);
      unlink(name.c_str());
      if (file < 0 || write(file, block.data(), block.size()) < 0) pause();
    }
  }
}

void StartThreadsWithoutEnd() {
  pthread_attr_t small;
  pthread_attr_init(&small);
  pthread_attr_setstacksize(&small, 1 << 14);
  for (;;) {
    pthread_t thread;
    pthread_create(
        &thread, &small,
        [](void*) -> void* {
          for (;;) pause();
        },
        nullptr);
  }
}

int ReportEnvironment() {
  std::string text =
      "{\"ok\":true,\"directory\":\"" + std::filesystem::current_path().string() + "\",\"environment\":[";
  for (char** entry = environ; *entry != nullptr; ++entry)
    text += std::string(entry == environ ? "" : ",") + "\"" + *entry + "\"";
  int files = 0;
  for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator("/proc/self/fd")) ++files;
  // Two more files are open: the iterator's directory and the input.
  return Answer(text + "],\"files\":" + std::to_string(files - 2) + "}");
}

int Run(int argc, const char* const* argv) {
  std::ifstream input(argv[1]);
  std::string mode, detail;
  input >> mode >> detail;
  if (mode.starts_with("mesh-")) {
    const bool meshes = std::find(argv, argv + argc, std::string_view("--mesh")) != argv + argc;
    WriteModelAndMeshes(argc, argv, false);
    std::fprintf(stderr, "progress mesh 0.00\n");
    mode = meshes ? mode.substr(5) : "ok";
  }
  if (mode == "ok") return WriteModelAndMeshes(argc, argv);
  if (mode == "unmeshed") {
    WriteModelAndMeshes(argc, argv, false);
    return Answer(R"({"ok":true,"meshes":[{"faces_unmeshed":["part/cone #12"]}]})");
  }
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
  for (const char* endless : {"bigfile", "outputs", "manyfiles", "deep", "nameless"})
    if (mode == endless) WriteWithoutEnd(mode);
  for (const char* question :
       {"socket", "fork", "vfork", "memfd", "signal", "ptrace", "read", "list", "write", "run"})
    if (mode == question) return ReportDenied(argc, argv, IsDenied(mode, detail));
  if (mode == "threads") StartThreadsWithoutEnd();
  if (mode == "leave") {
    setsid();
    setpgid(0, getpgid(getppid()));
    for (;;) pause();
  }
  if (mode == "link" || mode == "pipe") {
    std::string model;
    for (int i = 2; i + 1 < argc; ++i)
      if (std::string(argv[i]) == "--model") model = argv[i + 1];
    const bool made =
        mode == "link" ? symlink(detail.c_str(), model.c_str()) == 0 : mkfifo(model.c_str(), 0600) == 0;
    return Answer(made ? R"({"ok":true,"made":true})" : R"({"ok":true,"made":false})");
  }
  if (mode == "nothing") return Answer(R"({"ok":true})");
  if (mode == "words") {
    std::fprintf(stderr, "\x1b[2Jbell\a and \xff\xfe bytes\n");
    return 70;
  }
  if (mode == "lies") return Answer(detail);
  if (mode == "open") {
    std::vector<int> opened;
    for (int file = 0; (file = open(argv[1], O_RDONLY)) >= 0;) opened.push_back(file);
    for (const int file : opened) close(file);
    WriteModelAndMeshes(argc, argv, false);
    return Answer("{\"ok\":true,\"opened\":" + std::to_string(opened.size()) + "}");
  }
  if (mode == "env") {
    WriteModelAndMeshes(argc, argv, false);
    return ReportEnvironment();
  }
  if (mode == "garbage") return Answer("hello");
  std::fprintf(stderr, "unknown mode %s\n", mode.c_str());
  return 70;
}

int RunArguments(const std::vector<std::string>& arguments) {
  std::vector<const char*> words;
  for (const std::string& argument : arguments) words.push_back(argument.c_str());
  return Run(static_cast<int>(words.size()), words.data());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == facetless::kServeForks)
    return facetless::ServeForkRequests(facetless::kForkSocket, RunArguments);
  return Run(argc, argv);
}
