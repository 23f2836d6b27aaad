// Starts the built programs for tests. Requires FACETLESS_BIN, which ctest sets.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace facetless {

struct ProgramResult {
  int exit_code = -1;  // −1: the program could not be started, or died of a signal
  std::string output;  // standard output
};

// Runs `command`, a shell command line relative to the folder of the programs: "facetless inspect 'x'".
inline ProgramResult RunProgram(const std::string& command) {
  const char* folder = std::getenv("FACETLESS_BIN");
  ProgramResult result;
  std::FILE* pipe =
      popen((std::string(folder != nullptr ? folder : "build/bin") + "/" + command).c_str(), "r");
  if (pipe == nullptr) return result;
  char buffer[4096];
  for (std::size_t count = 0; (count = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    result.output.append(buffer, count);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  return result;
}

}  // namespace facetless
