// What a run has brought about, for the program that asked for it: the report is for readers, and nothing that
// the program itself needs has to be looked up in it.
//
//  1. Every file that a run leaves in its directory is in `files`, with the role under which the report names
//     it; report.json and report.html are there as "report" and "page".
//
//   for (const RunFile& file : result.files.list()) Print(file.view + " " + file.role + " " + file.name);
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/run/verdict.h"

namespace facetless {

struct RunFile {
  std::string view;  // its name; empty: the file is of the whole run
  std::string role;  // "direct", "depth", …
  std::string name;  // in the run's directory
};

class RunFiles {
 public:
  // A file of the same view and role is replaced.
  void Add(const std::string& view, const std::string& role, const std::string& name) {
    for (RunFile& file : list_)
      if (file.view == view && file.role == role) {
        file.name = name;
        return;
      }
    list_.push_back({view, role, name});
  }
  void AddFrame(const std::string& name) { frames_.push_back(name); }

  const std::vector<RunFile>& list() const { return list_; }
  // Of a turntable, in their order.
  const std::vector<std::string>& frames() const { return frames_; }
  // A report's "files": the name of each role of the view. Null where there is none.
  nlohmann::json Json(const std::string& view) const {
    nlohmann::json json;
    for (const RunFile& file : list_)
      if (file.view == view) json[file.role] = file.name;
    return json;
  }

 private:
  std::vector<RunFile> list_;
  std::vector<std::string> frames_;
};

// Why a comparison has no baseline. `reason`: that of MeshFailure; unusable (no triangle); or pending, in a
// report that is written while the mesher still works. `message` is one sentence, which names the file, what
// ran out and the remedy.
struct NoBaseline {
  std::string reason, message;
};

// Whether the reason lies in the file, so that the same question has the same answer again. What ran out (time,
// memory, threads) may be there at the next attempt, on a machine with less to do or with other limits.
inline bool LiesInFile(const NoBaseline& why) {
  return why.reason != "timeout" && why.reason != "memory" && why.reason != "threads" &&
         why.reason != "pending";
}

// One pass of the direct renderer over a view.
struct TracedRays {
  double rays = 0, seconds = 0;
};

struct RunResult {
  nlohmann::json report;  // as report.json has it
  Verdict verdict;
  RunFiles files;
  std::vector<TracedRays> traced;
  std::vector<std::string> warnings;      // sentences for a person
  std::optional<NoBaseline> no_baseline;  // of a comparison that has its exact half alone
};

}  // namespace facetless
