// Shared by the tests of the server: finds files and programs, writes files with a given text, and runs
// programs.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "server/base/temp_dir.h"
#include "server/importer/child_process.h"
#include "tests/support/files.h"

namespace facetless {

inline std::string Program(const std::string& name) {
  if (const char* directory = std::getenv("FACETLESS_BIN")) return std::string(directory) + "/" + name;
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / name).string();
}

inline std::string WriteText(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

inline std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

inline std::vector<std::string> Environment() {
  std::vector<std::string> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) environment.emplace_back(*entry);
  return environment;
}

// Runs a program until it ends, with this process's environment and `extra`.
inline ChildOutcome RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                               const std::string& directory, const std::vector<std::string>& extra = {}) {
  ChildRequest request;
  request.program = program;
  request.arguments = arguments;
  request.environment = Environment();
  request.environment.insert(request.environment.end(), extra.begin(), extra.end());
  request.working_directory = directory;
  request.limits.wall_seconds = 300;
  request.stdout_cap = 64 << 20;
  auto outcome = RunChild(request);
  return outcome.ok() ? outcome.value()
                      : ChildOutcome{.exit_code = -1, .out = {}, .error_tail = outcome.error().message};
}

// Sets the environment variable `name` to `value` while this object lives.
class ScopedEnvironment {
 public:
  ScopedEnvironment(const char* name, const std::string& value) : name_(name) {
    setenv(name, value.c_str(), 1);
  }
  ~ScopedEnvironment() { unsetenv(name_); }
  ScopedEnvironment(const ScopedEnvironment&) = delete;
  ScopedEnvironment& operator=(const ScopedEnvironment&) = delete;

 private:
  const char* name_;
};

}  // namespace facetless
