// The command line of facetless-import. Mesh options apply to the --mesh option before them, so that one call
// can mesh a model with several deflections. A table of options cannot express this order, so the parser is
// written by hand.
#pragma once

#include <string>
#include <vector>

#include "render/base/result.h"

namespace facetless {

struct MeshRequest {
  std::string path;
  double deflection = 1e-3;  // relative to the diagonal of the model
  double deflection_mm = 0;  // if above 0, used instead of `deflection`
  double angular_deg = 20;
};

struct CommandLine {
  bool help = false;
  std::string input, model;
  std::vector<MeshRequest> meshes;
  unsigned deadline_s = 0;  // 0: no deadline
  int threads = 0;          // number of threads; 0: one per core
  double unit_mm = 0;       // if above 0, the length of the file's unit in mm; overrides what the file says
  // Rays for OpenCASCADE's exact intersector (exact_intersector.h); none if `rays` is empty.
  std::string rays, depths;
  double rays_seconds = 10;
  double rays_near = 0;  // smallest depth of a hit; 0: hits may lie anywhere on the line
};

// Error: kBadUsage, with the name of the wrong option.
Result<CommandLine> ParseCommandLine(int argc, const char* const* argv);

const char* CommandLineHelp();

}  // namespace facetless
