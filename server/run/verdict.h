// The verdict on a run: what decides its exit code, and the sentences that say so.
//
//  1. A run fails where a threshold is broken, where there is a problem, and under --strict where something
//     was lost, a face has no triangle, or the file's unit is not known. Besides, a comparison without a
//     baseline has not passed, whatever the thresholds are; it has an exit code of its own.
//  2. Whatever makes a run fail has a sentence, which names the option to change or the place to look.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/options/options.h"

namespace facetless {

// What thresholds are compared with.
struct ViewValues {
  std::string view;
  double deviation_mm = 0, depth_mm = 0, silhouette_px = 0, flip = 0, share = 0;
};

// What a run has found out besides.
struct Findings {
  std::vector<std::string> problems;  // sentences; each fails the run
  std::size_t lost = 0;               // faces, loops and edges on the way in
  std::size_t unmeshed = 0;           // faces of the model that our tessellation lacks
  std::string no_baseline = {};       // why a comparison has nothing to compare with; empty: it has
  bool unit_known = true;             // the file says in which unit it is, or --unit does
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

// Law 2: one sentence for each reason for which `verdict` has failed; none where it has passed.
std::vector<std::string> VerdictSentences(const Verdict& verdict);

}  // namespace facetless
