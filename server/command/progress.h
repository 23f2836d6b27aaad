// Progress for a person who waits, on standard error.
//
//  1. On a terminal, one line that is rewritten and removed at the end; with --progress elsewhere, one line
//     per stage and tenth; else nothing.
#pragma once

#include <string>

namespace facetless {

class Progress {
 public:
  explicit Progress(bool forced);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `fraction` 0 … 1 of `stage`.
  void Report(const std::string& stage, double fraction);

 private:
  bool terminal_ = false, plain_ = false, line_shown_ = false;
  std::string stage_;
  int tenth_ = -1;
};

}  // namespace facetless
