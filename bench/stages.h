// Where the time of a command goes, from the start of the program to its end.
//
//     ProgramStages run = StagesOf(report, {.wall_ms = 460, .start_ms = 12});
//
//  1. Stages are disjoint, and they are listed in the order in which they run. Their times come from report.json.
//     What the program does before and after what the report measures is measured around its process.
//  2. The times of several views are added.
//  3. The stages and overlap_ms make up wall_ms: wall_ms = sum of all stages − overlap_ms. The overlap is the time
//     that stages of the report ran beside each other.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"

namespace facetless {

enum class StageGroup : std::uint8_t { kProgram, kImport, kExact, kMesh, kOutput };

struct Stage {
  const char* name;   // in JSON: "import_read"
  const char* title;  // in tables and plots: "import: reading"
  StageGroup group;
  double ms;
};

struct ProgramStages {
  std::string file, command;
  std::vector<Stage> stages;
  double wall_ms = 0, overlap_ms = 0;
};

// What is measured around the program's process.
struct ProcessTimes {
  double wall_ms = 0;
  double start_ms = 0;  // of a process of the program that does nothing
};

// Returns the stages of a run of `render` or `compare` from its report.json. Every run has all stages; those that
// its command does not have take no time.
ProgramStages StagesOf(const nlohmann::json& report, const ProcessTimes& process);

// Returns the run with the median wall_ms. Requires at least one run.
ProgramStages MedianRun(std::vector<ProgramStages> runs);

// Returns a table for each file, with a column for each of its commands. The runs of a file must lie side by side.
std::vector<Table> StageTables(const std::vector<ProgramStages>& runs);

// Draws a panel for each run, two in a row, with a bar for each stage that begins where the one before ends.
// Without runs, the picture says so.
std::string StagePlot(const std::vector<ProgramStages>& runs);

nlohmann::json StagesJson(const ProgramStages& run);

}  // namespace facetless
