// A stopwatch on the steady clock.
#pragma once

#include <chrono>

namespace facetless {

class Stopwatch {
 public:
  // Milliseconds since the stopwatch was made.
  double Milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }
  double Seconds() const { return 1e-3 * Milliseconds(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace facetless
