// The verdict on a run: its exit code, and the sentences that explain it.
//
//  1. A run fails if a threshold is exceeded or if there is a problem. Under --strict it also fails if
//     something was lost, if a face has no triangle, or if the unit of the file is unknown. A comparison
//     without a baseline does not pass, whatever the thresholds are; it has a separate exit code.
//  2. Every reason for a failure has a sentence that names the option to change or the place to look.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/options/options.h"

namespace facetless {

// The values that are compared with thresholds.
struct ViewValues {
  std::string view;
  double deviation_mm = 0, depth_mm = 0, silhouette_px = 0, flip = 0, share = 0;
};

// The other findings of a run.
struct Findings {
  std::vector<std::string> problems;  // sentences; each fails the run
  std::size_t lost = 0;               // number of faces, loops and edges that the import lost
  std::size_t unmeshed = 0;           // number of faces without a triangle in the tessellation
  std::string no_baseline = {};       // the reason why a comparison has no baseline; empty if it has one
  bool unit_known = true;             // the file or --unit states the unit
};

// A threshold that a view breaks.
struct BrokenThreshold {
  std::string view, threshold;  // "fail_depth_mm"
  double limit = 0, value = 0;  // a value that does not exist (infinite) breaks every threshold
};

struct Verdict {
  bool passed = true, strict = false;
  std::size_t lost = 0, unmeshed = 0;
  bool unit_known = true;
  std::vector<std::string> problems;  // sentences, the lack of a baseline among them
  std::vector<BrokenThreshold> broken;
  int exit_code = 0;
};

// exit_code: 2 if the run fails (law 1); else 5 if there is no baseline; else 1 if something was lost or a face
// has no triangle; else 0.
Verdict Judge(const RunOptions& options, const std::vector<ViewValues>& values,
              const Findings& findings = {});

// The report's "verdict": {"passed", "strict", "lost", "unmeshed", "unit_known", "problems": [sentence],
// "broken": [{"view", "threshold", "limit", "value"}], "exit_code"}; an infinite value is null.
nlohmann::json VerdictJson(const Verdict& verdict);

// One sentence for each reason for which `verdict` failed (law 2); empty if it passed.
std::vector<std::string> VerdictSentences(const Verdict& verdict);

}  // namespace facetless
