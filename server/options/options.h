// What a caller may ask of a run. The command line and the HTTP service both fill it from JSON, so a name, a
// range and an error message exist once.
//
//  1. A JSON name is the command line's without the dashes in front, and with _ for - inside: --deflection-mm
//     is "deflection_mm". (- is accepted, too.)
//  2. An unknown name, a wrong type, a number out of range and two options that contradict each other are
//     kBadUsage; the message names the option and what is allowed.
//
// name            type, range                                                    default
// view            name or list of names (NamedView)                              iso
// camera          object or list: see ParseCamera; excludes view
// size            "WxH" or [W, H], each 1 … 65536 pixels                          1024x1024
// projection      orthographic | perspective, of named views                     orthographic
// samples         per pixel, 1 … 64, a near-square grid k × m (m ≤ 2k)            4
// precision       fast | standard | certified                                    standard
// check           auto | none | share | all: how many certified samples an independent check tests again  auto
// newton_tolerance  share of a leaf at which Newton stops, 1e-13 … 1e-3         the precision's own
// threads         0 (all cores) … 1024                                           0
// timeout         seconds for everything after the import, 0: none               600; of a trade 3600
// audit, edges    true | false                                                   false
// mesh_deviation  the same: of a comparison, measure every triangle               false
// background      studio | transparent                                           studio
// shade           NAME or NAME:KEY=VALUE,…, or an object: see ParseShade          studio
// orient          file | viewer: which side is outside for draft, curvature, thickness     file
// lines           none | visible | hidden: exact edges and silhouettes over the pictures   none
// svg             true: the view's lines as NAME.lines.svg                       false
// section         one or a list: "x,y,z,nx,ny,nz", "z=12.5", "-z=50%", … (section_options.h)
// margin, up, …   how pictures are arranged and labelled: see picture_options.h
// aov             list, or one string with commas: depth, normal, face, uv, certificate
// mesh            path of a mesh to compare with instead of our tessellation
// mesh_unit       mm | cm | m | in | ft                                          the format's own
// mesh_up         y | z                                                          the format's own
// deflection      relative to the diagonal, 1e-9 … 1                              1e-3
// deflection_mm   millimetres, > 0; excludes deflection
// angular         degrees, 0.1 … 90                                              20
// mesh_timeout    seconds that our tessellation may take, > 0; excludes mesh      300
// import_timeout  seconds of the rest of the import, > 0                         300
// import_memory   megabytes, >= 64                                               8192
// unit            name (mm, cm, m, in, ft, …) or millimetres                      the file's own
// max_view_memory megabytes of a view's leaves and the mesh's search tree, >= 1    4096
// strict          true: any loss fails                                           false
// deflections     numbers, or one string with commas: trade's meshes              1e-2,1e-3,1e-4,1e-5,1e-6
// angles          the same: their angles in degrees                              30,12,5
// tolerances      the same: trade's Newton tolerances, 1e-13 … 1e-3               1e-3,1e-5,1e-8
// budget_seconds  of one point of trade, > 0                                     60
// budget_memory   megabytes of one point of trade, >= 16                         4096
// max_error_mm, max_error_px  what trade is to keep an error under, > 0          0.5 pixels
// error_measure   mean | p95 | p99 | max: which statistic stands for the error   p99
// fail_deviation_mm, fail_depth_mm, fail_silhouette_px, fail_flip, fail_share
//                 numbers >= 0: a view fails if its deviation_mm.max, depth_mm.max,
//                 silhouette.max_distance_px, color.flip_mean or color.share_over_threshold is larger
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/inspect/inspection.h"
#include "render/lines/line.h"
#include "render/shade/shade.h"
#include "render/trace/direct.h"
#include "render/trade/trade_answers.h"
#include "render/view/camera.h"
#include "server/importer/import_process.h"
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

// What everything after the import may take if no option says otherwise, seconds: no input keeps a run going for ever.
inline constexpr double kRunTimeoutS = 600, kTradeTimeoutS = 3600;

struct RunOptions {
  std::vector<std::string> views = {"iso"};
  nlohmann::json cameras;  // null, or a list of camera objects
  int width = 1024, height = 1024;
  Projection projection = Projection::kOrthographic;
  int samples = 4;
  Precision precision = Precision::kStandard;
  CheckLevel check = CheckLevel::kAuto;
  double newton_tolerance = 0;  // 0: the precision's own
  int threads = 0;
  // Of the leaves of one view, and of the search tree of the mesh that it is compared with.
  std::uint64_t max_view_bytes = DirectOptions{}.max_bytes;
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
  TessellationOptions tessellation;
  ImportLimits import_limits;
  double unit_mm = 0;  // 0: the file's own
  bool strict = false;
  Thresholds fail;
  TradeOptions trade;

  bool WantsAov(const std::string& name) const;
};

// Error: kBadUsage.
Result<RunOptions> ParseOptions(const nlohmann::json& json);

// The names that ParseOptions knows, as in the table above.
const std::vector<std::string>& OptionNames();

// One camera. {"eye": [x,y,z]} is enough; the rest has defaults: "target" the centre of `bounds`, "up"
// the axis that is up (what `top` draws upwards if that is the view direction), "projection" that of the
// options, "height" (orthographic) what shows `bounds` from every side with the margin, "fov_y_deg" 40, "name" as given, "width" and "height_px" those of
// the options. So a camera of a report can be given back as it is. Error: kBadUsage.
Result<Camera> ParseCamera(const nlohmann::json& json, const RunOptions& options, const Box3& bounds,
                           const std::string& default_name);

// How many samples a run takes: pixels × samples per pixel × views, and those of a turntable's frames. It needs no model. Error: kBadUsage
// (a camera).
Result<std::uint64_t> CountSamples(const RunOptions& options);

// The cameras of a run, their names distinct. Error: kBadUsage.
Result<std::vector<Camera>> ResolveCameras(const RunOptions& options, const Box3& bounds);

const char* PrecisionName(Precision precision);
const char* ProjectionName(Projection projection);

}  // namespace facetless
