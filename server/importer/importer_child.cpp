#include "server/importer/importer_child.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>

#include "server/importer/syscall_filter.h"

namespace facetless {
namespace {

constexpr std::uint64_t kMegabyte = 1024 * 1024;

// Sanitizers reserve terabytes of address space, so a limit would stop the program before main. The leak
// check starts a process, which the sandbox refuses.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

// Limits far above the needs of a normal import, which has a handful of files open and writes even fewer. Its
// threads are those of the pools of OpenCASCADE and TBB, with one thread per core each, and those of
// sanitizers.
constexpr std::uint64_t kOpenFiles = 256, kWrittenFiles = 256, kSpareThreads = 16;

// Returns whether the environment variable names the resources of OpenCASCADE.
bool NamesResources(std::string_view variable) {
  return variable.starts_with("CSF_") || variable.starts_with("CASROOT=");
}

// Appends the absolute paths of a list such as LD_LIBRARY_PATH.
void AddPaths(std::string_view list, std::vector<std::string>& paths) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(':'), list.size());
    if (list.starts_with('/')) paths.emplace_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
}

// The files that the importer may reach: its input, its directory, its program with the necessary libraries
// and resources, and the files from which libraries read properties of the machine.
FileAccess ImporterFiles(const std::string& program, const std::string& input, const std::string& directory) {
  FileAccess access;
  access.writable = {directory};
  // The importer resets its peak memory through /proc/self.
  access.opened = {"/proc/self", "/dev/null"};
  access.runnable = {program,          "/lib",       "/lib64",     "/usr/lib", "/usr/lib64",
                     "/usr/local/lib", "/nix/store", "/gnu/store", "/opt/lib"};
  access.readable = {input,
                     "/usr/share",
                     "/usr/local/share",
                     "/opt",
                     "/etc/ld.so.cache",
                     "/etc/ld.so.preload",
                     "/etc/localtime",
                     "/etc/ssl/openssl.cnf",
                     "/proc/cpuinfo",
                     "/proc/meminfo",
                     "/proc/stat",
                     "/proc/sys/vm",
                     "/sys/devices/system",
                     "/sys/kernel/mm",
                     "/dev/urandom"};
  const std::filesystem::path beside = std::filesystem::path(program).parent_path();
  access.readable.push_back((beside.parent_path() / "lib").string());
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    if (NamesResources(text) || text.starts_with("LD_LIBRARY_PATH="))
      AddPaths(text.substr(text.find('=') + 1), access.readable);
  }
  return access;
}

// The limits of the child. The CPU time limit is for all cores together, so that users normally reach the
// wall-time limit first.
ChildLimits MakeChildLimits(const ImportRequest& request) {
  const ImportLimits& limits = request.limits;
  const double cores = std::max(1u, std::thread::hardware_concurrency());
  const double wall_s = limits.timeout_s + (request.meshes.empty() ? 0 : limits.mesh_timeout_s);
  ChildLimits child;
  child.cpu_seconds = static_cast<std::uint64_t>(std::ceil(wall_s * cores));
  child.memory_bytes = kSanitized ? 0 : limits.memory_mb * kMegabyte;
  child.file_bytes = limits.file_mb * kMegabyte;
  child.directory_bytes = child.file_bytes;
  child.directory_names = kWrittenFiles;
  child.open_files = kOpenFiles;
  child.threads = 2 * static_cast<std::uint64_t>(cores) + kSpareThreads;
  return child;
}

}  // namespace

std::string ProgramBesideThis(const char* name) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / name).string();
}

std::string ImporterPath() {
  if (const char* other = std::getenv("FACETLESS_IMPORTER"); other != nullptr && *other != '\0') return other;
  return ProgramBesideThis("facetless-import");
}

std::vector<std::string> ImporterEnvironment() {
  std::vector<std::string> environment = {"LC_ALL=C.UTF-8", "TZ=UTC"};
  if (kSanitized) {
    environment.push_back("ASAN_OPTIONS=detect_leaks=0");
    environment.push_back("TSAN_OPTIONS=report_signal_unsafe=0");  // tools/tsan.supp explains why
  }
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    if (NamesResources(text) || text.starts_with("LD_LIBRARY_PATH=") || text.starts_with("GLIBC_TUNABLES="))
      environment.emplace_back(text);
  }
  return environment;
}

Result<void> CheckInput(const std::string& path) {
  struct stat info = {};
  if (stat(path.c_str(), &info) != 0)
    return Error{ErrorCode::kFileUnreadable, "cannot open " + path + ": " + std::strerror(errno)};
  if (!S_ISREG(info.st_mode)) return Error{ErrorCode::kFileUnreadable, path + " is not a regular file"};
  if (access(path.c_str(), R_OK) != 0)
    return Error{ErrorCode::kFileUnreadable, "cannot open " + path + ": " + std::strerror(errno)};
  return {};
}

Result<void> Confine(const ImportRequest& request, const TempDir& directory, ChildRequest& child) {
  child.limits = MakeChildLimits(request);
  child.environment = ImporterEnvironment();
  child.environment.push_back("HOME=" + directory.path());
  child.environment.push_back("TMPDIR=" + directory.path());
  child.working_directory = directory.path();
  auto filter = ImporterSyscallFilter();
  if (!filter) return filter.error();
  child.syscall_filter = std::move(filter).value();
  child.file_access = ImporterFiles(child.program, child.arguments.front(), directory.path());
  child.cancel = request.execution.cancel;
  return {};
}

}  // namespace facetless
