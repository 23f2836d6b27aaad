#include "import/memory_gauge.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace facetless {
namespace {

// Returns the value of a line such as "VmHWM:  1234 kB" of /proc/self/status, in bytes; −1 if there is none.
std::int64_t StatusBytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(name + ":", 0) == 0)
      return std::strtoll(line.c_str() + name.size() + 1, nullptr, 10) * 1024;
  }
  return -1;
}

// Lowers VmHWM to the memory that is resident now: see proc(5), clear_refs.
bool ResetPeak() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return file.good();
}

}  // namespace

MemoryGauge::MemoryGauge() {
  malloc_trim(0);
}

void MemoryGauge::Begin() {
  known_ = known_ && ResetPeak();
  before_ = StatusBytes("VmRSS");
}

void MemoryGauge::End() {
  const std::int64_t peak = StatusBytes("VmHWM"), after = StatusBytes("VmRSS");
  known_ = known_ && before_ >= 0 && peak >= 0 && after >= 0;
  peak_ = std::max(peak_, static_cast<std::uint64_t>(std::max<std::int64_t>(held_ + peak - before_, 0)));
  held_ += after - before_;
}

}  // namespace facetless
