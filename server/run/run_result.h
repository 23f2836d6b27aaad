// The result of a run, for the program that started it. The report is for readers; the program itself does
// not need to look anything up in it.
//
//  1. Every file that a run leaves in its directory is in `files`, with the role that it has in the report.
//     report.json and report.html have the roles "report" and "page".
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
  std::string view;  // name of the view; empty: the file belongs to the whole run
  std::string role;  // "direct", "depth", …
  std::string name;  // file name in the run's directory
};

class RunFiles {
 public:
  // Adds a file. It replaces a file of the same view and role.
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
  // The frames of a turntable, in order.
  const std::vector<std::string>& frames() const { return frames_; }
  // Returns the report's "files" of the view: the file name for each role. Null if there is none.
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

// The reason why a comparison has no baseline. `reason` is that of MeshFailure, or unusable (no triangle), or
// pending in a report that is written while the mesher still works. `message` is one sentence that names the
// file, the cause and the remedy.
struct NoBaseline {
  std::string reason, message;
};

// Returns whether the reason lies in the file, so that the same question always has this answer. If time,
// memory or threads ran out, the next attempt may succeed, on a less busy machine or with other limits.
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
  std::vector<std::string> warnings;      // sentences for the user
  std::optional<NoBaseline> no_baseline;  // the reason if a comparison has only its exact half
};

}  // namespace facetless
