// Measures the peak memory of one or more stretches of work.
//
//  1. The gauge measures resident memory of this process, as the kernel reports it (/proc/self), so it
//     includes the memory of libraries. Memory that was freed earlier is returned to the system first, so
//     that the work cannot reuse it unnoticed.
//  2. Stretches add up: memory that one stretch leaves allocated counts towards the peak of the next one.
//     Memory that is allocated between stretches does not count.
//  3. If the kernel reports nothing, or does not let a process reset its peak, the answer is 0: unknown.
#pragma once

#include <cstdint>

namespace facetless {

class MemoryGauge {
 public:
  MemoryGauge();
  // Begin() and End() enclose each stretch.
  void Begin();
  void End();
  // The peak memory, in bytes.
  std::uint64_t peak_bytes() const { return known_ ? peak_ : 0; }

 private:
  bool known_ = true;
  std::int64_t before_ = 0, held_ = 0;
  std::uint64_t peak_ = 0;
};

}  // namespace facetless
