#include "server/command/progress.h"

#include <unistd.h>

#include <cstdio>

namespace facetless {

Progress::Progress(bool forced) : terminal_(isatty(STDERR_FILENO) == 1), plain_(forced && !terminal_) {}

Progress::~Progress() {
  if (line_shown_) std::fputs("\r\033[K", stderr);
}

void Progress::Report(const std::string& stage, double fraction) {
  if (!terminal_ && !plain_) return;
  const int tenth = static_cast<int>(fraction * 10);
  if (plain_) {
    if (stage == stage_ && tenth == tenth_) return;
    std::fprintf(stderr, "%s %d%%\n", stage.c_str(), tenth * 10);
  } else {
    std::fprintf(stderr, "\r\033[K%-9s %3.0f%%", stage.c_str(), 100 * fraction);
    line_shown_ = true;
  }
  std::fflush(stderr);
  stage_ = stage;
  tenth_ = tenth;
}

}  // namespace facetless
