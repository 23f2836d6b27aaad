// What a caller may ask of a run. The command line and the HTTP service both fill it from JSON, so a name, a
// range and an error message exist once.
//
//  1. Which options there are, their ranges and defaults, and what they exclude is in the option table
//     (option_table.h).
//  2. An unknown name, a wrong type, a number out of range and two options that contradict each other are
//     kBadUsage; the message names the option and what is allowed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/compare/method.h"
#include "render/inspect/inspection.h"
#include "render/lines/line.h"
#include "render/shade/shade.h"
#include "render/trace/direct.h"
#include "render/trade/trade_answers.h"
#include "render/view/camera.h"
#include "server/importer/import_process.h"
#include "server/options/option_table.h"
#include "server/options/picture_options.h"
#include "server/options/section_options.h"

namespace facetless {

// The largest values that a run may have and still pass.
struct Thresholds {
  std::optional<double> deviation_mm, depth_mm, silhouette_px, flip, share;
};

// What `facetless trade` sweeps, and what it is asked.
struct TradeOptions {
  std::vector<double> deflections = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
  std::vector<double> angles_deg = {30, 12, 5};
  std::vector<double> tolerances = {1e-3, 1e-5, 1e-8};
  double budget_s = 60;
  std::uint64_t budget_mb = 4096;
  TradeLimits limits;  // none given: half a pixel
  ErrorMeasure measure = ErrorMeasure::kP99;
};

// What everything after the import may take if no option says otherwise, seconds: no input keeps a run going
// for ever.
inline constexpr double kRunTimeoutS = 600, kTradeTimeoutS = 3600;

struct RunOptions {
  std::vector<std::string> views = {"iso"};
  nlohmann::json cameras;  // null, or a list of camera objects
  int width = 1024, height = 1024;
  Projection projection = Projection::kOrthographic;
  int samples = 4;
  // max_bytes bounds the search tree of the mesh that a view is compared with, too.
  ExactTraceOptions accuracy;
  int threads = 0;
  std::optional<double> timeout_s;  // none: kRunTimeoutS or kTradeTimeoutS; 0: no limit
  bool audit = false, edges = false, mesh_deviation = false;
  Background background = Background::kStudio;
  Inspection inspection;
  Orient orient = Orient::kFile;  // goes into the inspection when a view is made
  LineMode lines = LineMode::kNone;
  bool svg = false;
  std::vector<SectionRequest> sections;
  PictureOptions picture;
  std::vector<std::string> aovs;
  std::string mesh, mesh_unit, mesh_up;
  std::vector<MethodChoice> with;  // what is compared or measured beside the mesh
  TessellationOptions tessellation;
  ImportLimits import_limits;
  double unit_mm = 0;  // 0: the file's own
  bool strict = false;
  Thresholds fail;
  TradeOptions trade;

  bool WantsAov(const std::string& name) const;
};

// Error: kBadUsage.
Result<RunOptions> ParseOptions(const nlohmann::json& json, const OptionTable& table = AllOptions());

// One camera. {"eye": [x,y,z]} is enough; the rest has defaults: "target" the centre of `bounds`, "up" the
// axis that is up (what `top` draws upwards if that is the view direction), "projection" that of the options,
// "height" (orthographic) what shows `bounds` from every side with the margin, "fov_y_deg" 40, "name" as
// given, "width" and "height_px" those of the options. So a camera of a report can be given back as it is.
// Error: kBadUsage.
Result<Camera> ParseCamera(const nlohmann::json& json, const RunOptions& options, const Box3& bounds,
                           const std::string& default_name);

// How many samples a run takes: pixels × samples per pixel × views, and those of a turntable's frames. It
// needs no model. Error: kBadUsage (a camera).
Result<std::uint64_t> CountSamples(const RunOptions& options);

// The cameras of a run, their names distinct. Error: kBadUsage.
Result<std::vector<Camera>> ResolveCameras(const RunOptions& options, const Box3& bounds);

const char* PrecisionName(Precision precision);
const char* ProjectionName(Projection projection);

}  // namespace facetless
