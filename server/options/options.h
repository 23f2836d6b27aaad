// The options of a run. The command line and the HTTP service both fill RunOptions from JSON, so every name,
// range and error message exists once.
//
//     Result<RunOptions> options = ParseOptions({{"view", {"iso", "top"}}, {"margin", 0.1}});
//     if (!options) return options.error();
//     Result<std::vector<Camera>> cameras = ResolveCameras(options.value(), model.bounds);
//
//  1. The option table (option_table.h) defines the options, their ranges and defaults, and which options
//     exclude each other.
//  2. An unknown name, a wrong type, a number out of range, and two contradictory options are kBadUsage. The
//     message names the option and what is allowed.
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
#include "render/voxel_walks/voxel_picture.h"
#include "render/voxels/voxelize.h"
#include "server/importer/import_process.h"
#include "server/options/option_table.h"
#include "server/options/picture_options.h"
#include "server/options/section_options.h"

namespace facetless {

// The largest values with which a run passes.
struct Thresholds {
  std::optional<double> deviation_mm, depth_mm, silhouette_px, flip, share;
};

// The parameters that `facetless trade` varies, and the questions that it answers.
struct TradeOptions {
  std::vector<double> deflections = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
  std::vector<double> angles_deg = {30, 12, 5};
  std::vector<double> tolerances = {1e-3, 1e-5, 1e-8};
  std::vector<MethodChoice> methods;  // besides RunOptions::with
  double budget_s = 60;
  std::uint64_t budget_mb = 4096;
  TradeLimits limits;  // if none is given, half a pixel
  ErrorMeasure measure = ErrorMeasure::kP99;
};

// The default time limits for everything after the import, seconds. No input can keep a run going endlessly.
inline constexpr double kRunTimeoutS = 600, kTradeTimeoutS = 3600;

// The axis of slices of voxels: that of the header beside them, or z; or an axis by name.
enum class SliceAxis { kAuto, kX, kY, kZ };

// How `facetless voxelize` makes voxels, and how `facetless convert` reads and writes them.
struct VoxelRunOptions {
  int resolution = 256;
  std::optional<double> pitch_mm;  // instead of the resolution
  VoxelFill fill = VoxelFill::kSolid;
  std::optional<int> fraction;  // divisions of a voxel (render/voxels/voxel_shares.h)
  SliceAxis slice_axis = SliceAxis::kAuto;
  double threshold = 0;  // of convert: a voxel of a file of numbers is filled if its number is above it
};

// How `facetless render` shows a voxel file.
struct VoxelPictureRunOptions {
  std::string walk;                // empty: the usual one of an octree
  std::optional<double> ambient;   // nothing: that of VoxelPictureOptions
  std::vector<PointLight> lights;  // none: one beside the eye
  bool side_normals = false;
};

struct RunOptions {
  std::vector<std::string> views = {"iso"};
  nlohmann::json cameras;  // null, or a list of camera objects
  int width = 1024, height = 1024;
  Projection projection = Projection::kOrthographic;
  int samples = 4;
  bool uniform_samples = false;
  // max_bytes bounds the search tree of the mesh that a view is compared with, too.
  ExactTraceOptions accuracy;
  MethodChoice method{&CertifiedMethod()};  // what traces the exact surfaces
  SolverOptions solver;                     // for methods that are solvers
  int threads = 0;                          // the caller makes the Execution of a run from it
  std::optional<double> timeout_s;          // nothing: kRunTimeoutS or kTradeTimeoutS; 0: no limit
  bool audit = false, edges = false, mesh_deviation = false;
  Background background = Background::kStudio;
  Inspection inspection;
  Orient orient = Orient::kFile;  // copied to the inspection when a view is made
  LightOptions light;             // a radius of 0 means a quarter of the model's diagonal
  LineMode lines = LineMode::kNone;
  bool svg = false;
  std::vector<SectionRequest> sections;
  PictureOptions picture;
  std::vector<std::string> aovs;
  std::string mesh, mesh_unit, mesh_up;
  std::vector<MethodChoice> with;           // what is compared or measured beside the mesh
  std::vector<MethodChoice> voxels_beside;  // and voxels, by their number along the longest side
  std::string voxel_encoding = "octree";
  std::optional<VoxelNormals> voxel_normals;  // nothing: exact
  TessellationOptions tessellation;
  ImportLimits import_limits;
  double unit_mm = 0;  // 0: the unit of the file
  bool strict = false;
  Thresholds fail;
  TradeOptions trade;
  VoxelRunOptions voxels;
  VoxelPictureRunOptions voxel_picture;

  bool WantsAov(const std::string& name) const;
  // with and voxels_beside, each once.
  std::vector<MethodChoice> MethodsBeside() const;
  VoxelLook voxel_look() const {
    return {.encoding = voxel_encoding, .normals = voxel_normals.value_or(VoxelNormals::kExact)};
  }
};

// Parses options. Error: kBadUsage (law 2).
Result<RunOptions> ParseOptions(const nlohmann::json& json, const OptionTable& table = AllOptions());

// Parses one camera. Only "eye": [x,y,z] is required. The defaults are: for "target", the centre of `bounds`;
// for "up", the up axis of the options (or the up direction of the view `top` if that axis is the view
// direction); for "projection", "width" and "height_px", those of the options; for "height" of an
// orthographic camera, a value that shows `bounds` from every side with the margin; for "fov_y_deg", 40; for
// "name", `default_name`. The camera object of a report can be passed unchanged. Error: kBadUsage.
Result<Camera> ParseCamera(const nlohmann::json& json, const RunOptions& options, const Box3& bounds,
                           const std::string& default_name);

// The number of samples of a run: pixels × samples per pixel × views, plus those of the frames of a
// turntable. No model is needed. Error: kBadUsage (a camera).
Result<std::uint64_t> CountSamples(const RunOptions& options);

// The cameras of a run, with distinct names. Error: kBadUsage.
Result<std::vector<Camera>> ResolveCameras(const RunOptions& options, const Box3& bounds);

const char* PrecisionName(Precision precision);
const char* ProjectionName(Projection projection);

}  // namespace facetless
