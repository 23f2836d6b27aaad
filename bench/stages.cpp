#include "bench/stages.h"

#include <algorithm>
#include <span>
#include <utility>

#include "bench/svg.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using enum StageGroup;

const char* ColorOf(StageGroup group) {
  switch (group) {
    case kProgram:
      return "#7a8288";
    case kImport:
      return "#3f8f5b";
    case kExact:
      return "#126690";
    case kMesh:
      return "#cc5c0d";
    case kOutput:
      break;
  }
  return "#b59a2c";
}

constexpr std::pair<StageGroup, const char*> kLegend[] = {{kProgram, "program"},
                                                          {kImport, "import"},
                                                          {kExact, "exact picture"},
                                                          {kMesh, "mesh picture"},
                                                          {kOutput, "difference and files"}};

// Returns a number of an object, or 0 if the object or the number is absent.
double Number(const Json& object, const char* name) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  return found != object.end() && found->is_number() ? found->get<double>() : 0;
}

// Returns the sum over all views of a time of `part`, which is "direct" or "baseline", or of the views themselves
// if it is empty.
double OfViews(const Json& report, const char* part, const char* name) {
  double sum = 0;
  for (const Json& view : report.at("views")) {
    const Json& owner = *part == '\0' ? view : view.contains(part) ? view.at(part) : Json();
    if (owner.is_object() && owner.contains("timing_ms")) sum += Number(owner.at("timing_ms"), name);
  }
  return sum;
}

// Returns the time of meshing, which is a part of the import and is the same in all views.
double MeshingMs(const Json& report) {
  for (const Json& view : report.at("views"))
    if (view.contains("baseline") && view.at("baseline").is_object() &&
        view.at("baseline").contains("timing_ms"))
      return Number(view.at("baseline").at("timing_ms"), "mesh");
  return 0;
}

bool TakesTime(const Stage& stage) {
  return stage.ms > 0;
}

}  // namespace

ProgramStages StagesOf(const Json& report, const ProcessTimes& process) {
  const Json& timing = report.at("timing_ms");
  const double import_ms = Number(timing, "import"), read_ms = Number(timing, "import_read"),
               transfer_ms = Number(timing, "import_transfer"), convert_ms = Number(timing, "import_convert"),
               mesh_ms = MeshingMs(report), total_ms = Number(timing, "total");
  const auto direct = [&](const char* name) { return OfViews(report, "direct", name); };
  const auto mesh = [&](const char* name) { return OfViews(report, "baseline", name); };
  std::vector<Stage> stages = {{"start", "start and end of a process", kProgram, process.start_ms},
                               {"import_process", "import: process, repairs, model file", kImport,
                                std::max(0.0, import_ms - read_ms - transfer_ms - convert_ms - mesh_ms)},
                               {"import_read", "import: reading", kImport, read_ms},
                               {"import_transfer", "import: transfer", kImport, transfer_ms},
                               {"import_convert", "import: conversion", kImport, convert_ms},
                               {"import_mesh", "import: meshing", kImport, mesh_ms},
                               {"load", "loading model and mesh", kImport, Number(timing, "load")},
                               {"scene", "exact: trimming", kExact, Number(timing, "scene")},
                               {"direct_prepare", "exact: preparation", kExact, direct("prepare")},
                               {"direct_trace", "exact: tracing", kExact, direct("trace")},
                               {"direct_color", "exact: samples for the colour", kExact, direct("color")},
                               {"direct_lines", "exact: lines", kExact, direct("lines")},
                               {"direct_shade", "exact: shading", kExact, direct("shade")},
                               {"mesh_build", "mesh: tree", kMesh, mesh("build")},
                               {"mesh_trace", "mesh: tracing", kMesh, mesh("trace")},
                               {"mesh_color", "mesh: samples for the colour", kMesh, mesh("color")},
                               {"mesh_shade", "mesh: shading", kMesh, mesh("shade")},
                               {"difference", "difference", kOutput, OfViews(report, "", "difference")},
                               {"files", "files of the views", kOutput, OfViews(report, "", "files")}};
  double known_ms = -process.start_ms;
  for (const Stage& stage : stages) known_ms += stage.ms;
  stages.push_back({"other", "all else before the report", kOutput, std::max(0.0, total_ms - known_ms)});
  stages.push_back({"report", "report.json, report.html", kOutput,
                    std::max(0.0, process.wall_ms - process.start_ms - total_ms)});

  ProgramStages run;
  run.command = report.value("command", "");
  run.wall_ms = process.wall_ms;
  double sum = 0;
  for (const Stage& stage : stages) sum += stage.ms;
  run.overlap_ms = std::max(0.0, sum - process.wall_ms);
  run.stages = std::move(stages);
  return run;
}

ProgramStages MedianRun(std::vector<ProgramStages> runs) {
  std::sort(runs.begin(), runs.end(),
            [](const ProgramStages& a, const ProgramStages& b) { return a.wall_ms < b.wall_ms; });
  return runs[runs.size() / 2];
}

std::vector<Table> StageTables(const std::vector<ProgramStages>& runs) {
  std::vector<Table> tables;
  for (std::size_t first = 0; first < runs.size();) {
    std::size_t last = first;
    while (last < runs.size() && runs[last].file == runs[first].file) ++last;
    const std::span of_file(runs.data() + first, last - first);
    Table table;
    table.title = "From start to end: " + runs[first].file;
    table.columns = {"stage"};
    for (const ProgramStages& run : of_file) table.columns.push_back(run.command);
    const auto add_row = [&](const char* title, const auto& ms_of) {
      std::vector<std::string> row = {title};
      for (const ProgramStages& run : of_file)
        row.push_back(ms_of(run) > 0 ? MillisecondsText(ms_of(run)) : "-");
      const bool empty =
          std::all_of(of_file.begin(), of_file.end(), [&](const auto& run) { return !(ms_of(run) > 0); });
      if (!empty) table.rows.push_back(std::move(row));
    };
    for (std::size_t stage = 0; stage < runs[first].stages.size(); ++stage)
      add_row(runs[first].stages[stage].title,
              [&](const ProgramStages& run) { return run.stages[stage].ms; });
    add_row("beside another stage", [](const ProgramStages& run) { return run.overlap_ms; });
    add_row("whole", [](const ProgramStages& run) { return run.wall_ms; });
    tables.push_back(std::move(table));
    first = last;
  }
  return tables;
}

std::string StagePlot(const std::vector<ProgramStages>& runs) {
  constexpr double kWidth = 1180, kPanel = 580, kLabels = 240, kNumbers = 80, kTop = 86, kHead = 30,
                   kRow = 17, kGap = 24;
  std::string svg;
  double legend_x = 24;
  for (const auto& [group, name] : kLegend) {
    svg += SvgBox(legend_x, 50, 12, 12, ColorOf(group)) + SvgText(legend_x + 18, 61, "start", 13, name);
    legend_x += 170;
  }
  if (runs.empty()) svg += SvgText(24, kTop + 24, "start", 13, "No run was measured.");

  double y = kTop;
  for (std::size_t first = 0; first < runs.size(); first += 2) {
    // Both panels of a row have one scale.
    const std::size_t last = std::min(first + 2, runs.size());
    double longest = 0;
    std::size_t rows = 0;
    for (std::size_t i = first; i < last; ++i) {
      longest = std::max(longest, runs[i].wall_ms + std::max(0.0, runs[i].overlap_ms));
      rows = std::max(rows, static_cast<std::size_t>(
                                std::count_if(runs[i].stages.begin(), runs[i].stages.end(), TakesTime)));
    }
    for (std::size_t i = first; i < last; ++i) {
      const double x = 12 + kPanel * static_cast<double>(i - first), bars = x + kLabels;
      svg += SvgText(x + 12, y + 18, "start", 14,
                     runs[i].command + " " + runs[i].file + ": " + MillisecondsText(runs[i].wall_ms),
                     " font-weight=\"bold\"");
      double begin = 0, top = y + kHead;
      for (const Stage& stage : runs[i].stages) {
        if (!TakesTime(stage)) continue;
        const double scale = (kPanel - kLabels - kNumbers) / longest;
        const double left = bars + begin * scale, width = std::max(stage.ms * scale, 0.5);
        svg += SvgText(bars - 8, top + 11, "end", 11, stage.title) +
               SvgBox(left, top, width, kRow - 4, ColorOf(stage.group)) +
               SvgText(left + width + 4, top + 11, "start", 11, MillisecondsText(stage.ms));
        begin += stage.ms;
        top += kRow;
      }
    }
    y += kHead + kRow * static_cast<double>(rows) + kGap;
  }
  return SvgPicture(kWidth, std::max(y, kTop + 56), "From the start of the program to its end", svg);
}

Json StagesJson(const ProgramStages& run) {
  Json stages = Json::array();
  for (const Stage& stage : run.stages) stages.push_back({{"name", stage.name}, {"ms", stage.ms}});
  return {{"file", run.file},
          {"command", run.command},
          {"wall_ms", run.wall_ms},
          {"overlap_ms", run.overlap_ms},
          {"stages", std::move(stages)}};
}

}  // namespace facetless
