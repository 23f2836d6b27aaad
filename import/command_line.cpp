#include "import/command_line.h"

#include <cmath>
#include <cstdlib>

namespace facetless {
namespace {

constexpr char kHelp[] =
    R"(Usage: facetless-import INPUT --model OUT.flm [--mesh OUT.glb [mesh options]]... [--deadline-s N]

Reads a STEP, IGES or BREP file, whatever its extension, and writes its exact surfaces as a model file.

  --model OUT.flm      the model file
  --mesh OUT.glb       also write a tessellation as glTF binary; may be given several times, each with options:
    --deflection REL     largest distance of facets to the surface, divided by the model's diagonal
                         (default 0.001)
    --deflection-mm MM   the same in millimetres
    --angular DEG        largest angle between the normals of neighbouring facets (default 20)
  --rays IN --depths OUT
                       also trace rays with OpenCASCADE's exact intersector: IN has six doubles per ray
                       (origin, direction), OUT receives one (depth in units of the direction's length,
                       infinite for a miss)
    --rays-seconds S     trace as many rays as S seconds allow (default 10)
    --rays-near D        ignore hits at a depth below D
  --unit-mm MM         length of the file's unit in millimetres, whatever the file says
  --threads N          use at most N threads (default: one per core)
  --deadline-s N       give up after N seconds

Standard output is one JSON object. Exit status: 0 written, 4 nothing usable, 64 bad usage.
)";

// More threads than any machine has cores.
constexpr double kMostThreads = 4096;

Error Usage(const std::string& what) {
  return {ErrorCode::kBadUsage, what + " See facetless-import --help."};
}

// Parses a number above 0; returns 0 if the text is no such number.
double PositiveNumber(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end != text.c_str() && *end == '\0' && std::isfinite(value) && value > 0 ? value : 0;
}

}  // namespace

Result<CommandLine> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--help" || option == "-h") {
      line.help = true;
      return line;
    }
    if (!option.starts_with("--")) {
      if (!line.input.empty())
        return Usage("There are two input files, " + line.input + " and " + option + ".");
      line.input = option;
      continue;
    }
    if (i + 1 >= argc) return Usage(option + " needs a value.");
    const std::string value = argv[++i];
    if (option == "--model") {
      line.model = value;
    } else if (option == "--rays") {
      line.rays = value;
    } else if (option == "--depths") {
      line.depths = value;
    } else if (option == "--mesh") {
      line.meshes.push_back({});
      line.meshes.back().path = value;
    } else if (option == "--deflection" || option == "--deflection-mm" || option == "--angular" ||
               option == "--deadline-s" || option == "--unit-mm" || option == "--threads" ||
               option == "--rays-seconds" || option == "--rays-near") {
      const double number = PositiveNumber(value);
      if (number == 0) return Usage(option + " needs a number above 0, not \"" + value + "\".");
      if (option == "--deadline-s") {
        line.deadline_s = static_cast<unsigned>(std::ceil(std::fmin(number, 1e9)));
        continue;
      }
      if (option == "--threads") {
        if (!(number >= 1)) return Usage(option + " needs a whole number from 1, not \"" + value + "\".");
        line.threads = static_cast<int>(std::fmin(number, kMostThreads));
        continue;
      }
      if (option == "--unit-mm") {
        line.unit_mm = number;
        continue;
      }
      if (option.starts_with("--rays-")) {
        (option == "--rays-near" ? line.rays_near : line.rays_seconds) = number;
        continue;
      }
      if (line.meshes.empty()) return Usage(option + " must follow the --mesh that it belongs to.");
      MeshRequest& mesh = line.meshes.back();
      (option == "--deflection"      ? mesh.deflection
       : option == "--deflection-mm" ? mesh.deflection_mm
                                     : mesh.angular_deg) = number;
    } else {
      return Usage("There is no option " + option + ".");
    }
  }
  if (line.input.empty()) return Usage("There is no input file.");
  if (line.model.empty()) return Usage("--model OUT.flm is missing.");
  if (line.rays.empty() != line.depths.empty()) return Usage("--rays and --depths go together.");
  return line;
}

const char* CommandLineHelp() {
  return kHelp;
}

}  // namespace facetless
