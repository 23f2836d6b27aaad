// Progress of a command, shown on standard error.
//
//  1. On a terminal, one line is rewritten and finally removed. Elsewhere, with --progress, one line is
//     printed per stage and tenth of it. Otherwise nothing is printed.
#pragma once

#include <string>

namespace facetless {

class Progress {
 public:
  explicit Progress(bool forced);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Reports that the fraction `fraction` (0 … 1) of `stage` is done.
  void Report(const std::string& stage, double fraction);

 private:
  bool terminal_ = false, plain_ = false, line_shown_ = false;
  std::string stage_;
  int tenth_ = -1;
};

}  // namespace facetless
