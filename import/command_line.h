// The command line of facetless-import. Mesh options follow the --mesh that they belong to, so that one call
// can mesh a model at many deflections; that is why it is read by hand and not by a table of options.
#pragma once

#include <string>
#include <vector>

#include "render/base/result.h"

namespace facetless {

struct MeshRequest {
  std::string path;
  double deflection = 1e-3;  // relative to the diagonal of the model
  double deflection_mm = 0;  // above 0: used instead
  double angular_deg = 20;
};

struct CommandLine {
  bool help = false;
  std::string input, model;
  std::vector<MeshRequest> meshes;
  unsigned deadline_s = 0;  // 0: none
  double unit_mm = 0;       // above 0: one unit of the file in mm, whatever the file says
  // Rays for OpenCASCADE's exact intersector (exact_intersector.h); none if `rays` is empty.
  std::string rays, depths;
  double rays_seconds = 10;
  double rays_near = 0;  // 0: hits may lie anywhere on the line
};

// Error: kBadUsage, with the option that is wrong.
Result<CommandLine> ParseCommandLine(int argc, const char* const* argv);

const char* CommandLineHelp();

}  // namespace facetless
