// The commands, after their command lines have been parsed. Each returns an exit code (exit_code.h).
// docs/cli.md documents what they print.
#pragma once

#include <string>
#include <vector>

#include "render/base/result.h"
#include "server/options/options.h"
#include "server/run/bench.h"

namespace facetless {

struct CommandArguments {
  std::string file;       // the CAD file, the voxel file of render, or the manifest of regress
  std::string out;        // --out
  bool progress = false;  // --progress
  bool update = false;    // regress --update
  // The arguments of bench.
  std::vector<std::string> files;
  std::string json_out, plot_out, stage_plot_out;  // --json, --plot, --stage-plot; empty: not written
  BenchSettings bench;
  RunOptions options;
  std::vector<std::string> given;  // the names of the options that were given
};

int InspectCommand(const CommandArguments& arguments);
int ContinuityCommand(const CommandArguments& arguments);
int RenderCommand(const CommandArguments& arguments);
int MeshCommand(const CommandArguments& arguments);
int CompareCommand(const CommandArguments& arguments);
int TradeCommand(const CommandArguments& arguments);
int MethodsCommand(const CommandArguments& arguments);
int VoxelizeCommand(const CommandArguments& arguments);
int ConvertCommand(const CommandArguments& arguments);
int BenchCommand(const CommandArguments& arguments);
int RegressCommand(const CommandArguments& arguments);

}  // namespace facetless
