// How much memory a stretch of work takes at its fullest.
//
//  1. Measured, not counted: resident memory of this process, from the kernel (/proc/self), so it includes
//     what the libraries hold. Memory that was freed earlier is given back to the system first, so that the
//     work cannot use it unseen.
//  2. Stretches add up: what one leaves allocated counts below the next one's peak, and what happens between
//     them does not.
//  3. Where the kernel tells nothing, or doesn't let a process reset its peak, the answer is 0: unknown.
#pragma once

#include <cstdint>

namespace facetless {

class MemoryGauge {
 public:
  MemoryGauge();
  // Around each stretch.
  void Begin();
  void End();
  // The most that was held at once, in bytes.
  std::uint64_t peak_bytes() const { return known_ ? peak_ : 0; }

 private:
  bool known_ = true;
  std::int64_t before_ = 0, held_ = 0;
  std::uint64_t peak_ = 0;
};

}  // namespace facetless
