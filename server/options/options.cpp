#include "server/options/options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

#include "render/compare/compare_view.h"
#include "render/solve/solver.h"
#include "server/options/option_values.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

Result<Vec3> ParsePoint(const Json& json, const std::string& name) {
  const Error error = BadUsage("camera." + name + " is " + Quoted(json) + ", but must be [x, y, z]");
  if (!json.is_array() || json.size() != 3) return error;
  double xyz[3];
  for (std::size_t i = 0; i < 3; ++i) {
    if (!json[i].is_number() || !std::isfinite(json[i].get<double>())) return error;
    xyz[i] = json[i].get<double>();
  }
  return Vec3{xyz[0], xyz[1], xyz[2]};
}

// Returns whether any view of the options is a perspective view.
bool HasPerspective(const RunOptions& options) {
  const bool usual = options.projection == Projection::kPerspective;
  if (!options.cameras.is_array()) return usual;
  return std::any_of(options.cameras.begin(), options.cameras.end(), [usual](const Json& camera) {
    return camera.contains("projection") ? camera["projection"] == "perspective" : usual;
  });
}

bool IsFileStem(const std::string& name) {
  if (name.empty() || name.size() > 64) return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

// Refuses what the method of a view cannot do. The errors of surfaces that it does not take come with the model.
Result<void> CheckMethod(const RunOptions& options) {
  const SolverInfo* solver = options.method.method->solver;
  if (solver == nullptr) return {};
  const std::string name = options.method.method->name;
  if (!options.sections.empty())
    return BadUsage("the method " + name +
                    " cannot cut a model; leave out section, or use certified or fast");
  if (options.audit)
    return BadUsage("the method " + name +
                    " cannot count the crossings of a ray; leave out audit, or use certified or fast");
  if (options.accuracy.precision != Precision::kStandard)
    return BadUsage("the method " + name +
                    " computes in double precision and proves nothing; leave out precision");
  if (options.solver.starts && *options.solver.starts != SolverStarts::kPieces && !solver->takes_map)
    return BadUsage("the method " + name + " does not start at a map; write starts=pieces, or leave it out");
  return {};
}

}  // namespace

std::vector<MethodChoice> RunOptions::MethodsBeside() const {
  std::vector<MethodChoice> choices = with;
  for (const MethodChoice& choice : voxels_beside) {
    const auto same = [&](const MethodChoice& other) { return other.given && other.Name() == choice.Name(); };
    if (std::none_of(with.begin(), with.end(), same)) choices.push_back(choice);
  }
  return choices;
}

bool RunOptions::WantsAov(const std::string& name) const {
  return std::find(aovs.begin(), aovs.end(), name) != aovs.end();
}

Result<RunOptions> ParseOptions(const Json& json, const OptionTable& table) {
  if (!json.is_object()) return BadUsage("the options must be a JSON object");
  RunOptions options;
  std::set<std::string> given;
  for (const auto& [key, value] : json.items()) {
    const OptionRow* row = FindOption(key, table);
    if (row == nullptr)
      return BadUsage("there is no option " + Shortened(key) +
                      Suggestion(OptionName(key), OptionNames(table)) + "; the options are " +
                      Joined(OptionNames(table)));
    if (!given.insert(row->name).second) return BadUsage("the option " + row->name + " is given twice");
    if (auto stored = row->binding.store(*row, value, options); !stored) return stored.error();
  }
  for (const OptionRow& row : table)
    for (const std::string& other : row.excludes)
      if (given.contains(row.name) && given.contains(other))
        return BadUsage("give either " + row.name + " or " + other);
  if (auto can = CheckMethod(options); !can) return can.error();
  if (options.light.any() && options.inspection.kind != InspectionKind::kStudio)
    return BadUsage(
        "shade shows values without light; give either shade, or shadows, ambient_occlusion and material");
  if (options.picture.scale_bar && HasPerspective(options))
    return BadUsage("scale_bar needs an orthographic view: in perspective no length has one size");
  return options;
}

namespace {

// Reads a camera without checking its position. `bounds` supply the defaults.
Result<Camera> ReadCamera(const Json& json, const RunOptions& options, const Box3& bounds,
                          const std::string& default_name) {
  static const std::set<std::string> kKeys = {"name",   "eye",       "target", "up",       "projection",
                                              "height", "fov_y_deg", "width",  "height_px"};
  for (const auto& [key, value] : json.items()) {
    if (!kKeys.contains(key))
      return BadUsage("a camera has no " + Shortened(key) +
                      Suggestion(key, std::vector<std::string>(kKeys.begin(), kKeys.end())) +
                      "; it has name, eye, target, up, projection, height or fov_y_deg, width, height_px");
  }
  Camera camera;
  camera.name = default_name;
  camera.target = bounds.center();
  camera.projection = options.projection;
  camera.width_px = options.width;
  camera.height_px = options.height;

  // Read the name and the projection.
  if (json.contains("name")) {
    auto name = ParseText(json["name"], "camera.name");
    if (!name) return name.error();
    camera.name = name.value();
  }
  if (!IsFileStem(camera.name))
    return BadUsage("camera.name \"" + camera.name +
                    "\" must be 1 to 64 letters, digits, _ or -, since files are named after it");
  if (json.contains("projection")) {
    auto index = ParseWord(json["projection"], "camera.projection", {"orthographic", "perspective"});
    if (!index) return index.error();
    camera.projection = static_cast<Projection>(index.value());
  }

  // Read the position and the direction.
  if (!json.contains("eye")) return BadUsage("a camera needs an \"eye\": [x, y, z] in millimetres");
  for (auto [key, point] : {std::pair{"eye", &camera.eye}, {"target", &camera.target}, {"up", &camera.up}}) {
    if (!json.contains(key)) continue;
    if (auto stored = StoreInto(ParsePoint(json[key], key), *point); !stored) return stored.error();
  }
  if (!json.contains("up")) {
    const Vec3 forward = Normalized(camera.target - camera.eye);
    // Within 0.06 degrees of the up axis, rounding of the direction would visibly rotate the picture.
    constexpr double kSineOfVertical = 1e-3;
    const Vec3 up = RotateToUpAxis(options.picture.up, {0, 0, 1});
    camera.up =
        Length(Cross(forward, up)) > kSineOfVertical ? up : RotateToUpAxis(options.picture.up, {0, 1, 0});
  }

  // Read the size of the view.
  const bool orthographic = camera.projection == Projection::kOrthographic;
  if (json.contains(orthographic ? "fov_y_deg" : "height"))
    return BadUsage(orthographic ? "an orthographic camera has a height, no fov_y_deg"
                                 : "a perspective camera has a fov_y_deg, no height");
  for (auto [key, size] : {std::pair{"width", &camera.width_px}, {"height_px", &camera.height_px}}) {
    if (!json.contains(key)) continue;
    if (auto stored = StoreInto(ParseInteger(json[key], std::string("camera.") + key, 1, 65536), *size);
        !stored)
      return stored.error();
  }
  const double aspect = static_cast<double>(camera.width_px) / camera.height_px;
  camera.height = (1 + options.picture.margin) * bounds.diagonal() / std::min(1.0, aspect);
  if (json.contains("height")) {
    auto height = ParseNumber(json["height"], "camera.height", std::numeric_limits<double>::min(), 1e15);
    if (auto stored = StoreInto(std::move(height), camera.height); !stored) return stored.error();
  }
  if (json.contains("fov_y_deg")) {
    auto angle = ParseNumber(json["fov_y_deg"], "camera.fov_y_deg", 1e-3, 179);
    if (auto stored = StoreInto(std::move(angle), camera.fov_y_deg); !stored) return stored.error();
  }
  return camera;
}

// The default name of the camera at `index`: "camera", "camera-2", …
std::string DefaultCameraName(std::size_t index) {
  return index == 0 ? "camera" : "camera-" + std::to_string(index + 1);
}

}  // namespace

Result<Camera> ParseCamera(const Json& json, const RunOptions& options, const Box3& bounds,
                           const std::string& default_name) {
  auto camera = ReadCamera(json, options, bounds, default_name);
  if (!camera) return camera.error();
  if (auto frame = MakeFrame(camera.value(), bounds.diagonal()); !frame) return frame.error();
  return camera;
}

Result<std::uint64_t> CountSamples(const RunOptions& options) {
  const auto of_picture = [&](int width, int height) {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) *
           static_cast<std::uint64_t>(options.samples);
  };
  std::vector<std::uint64_t> views;
  if (options.cameras.is_array()) {
    Box3 any;
    any.Add({0, 0, 0});
    any.Add({1, 1, 1});
    for (const Json& json : options.cameras) {
      const auto camera = ReadCamera(json, options, any, DefaultCameraName(views.size()));
      if (!camera) return camera.error();
      views.push_back(of_picture(camera.value().width_px, camera.value().height_px));
    }
  } else {
    views.assign(options.views.size(), of_picture(options.width, options.height));
  }
  std::uint64_t count = 0;
  for (std::uint64_t view : views) count += view;
  if (!views.empty()) count += static_cast<std::uint64_t>(options.picture.turntable) * views.front();
  return count;
}

Result<std::vector<Camera>> ResolveCameras(const RunOptions& options, const Box3& bounds) {
  std::vector<Camera> cameras;
  if (options.cameras.is_array()) {
    for (const Json& json : options.cameras) {
      auto camera = ParseCamera(json, options, bounds, DefaultCameraName(cameras.size()));
      if (!camera) return camera.error();
      cameras.push_back(std::move(camera).value());
    }
  } else {
    for (const std::string& view : options.views) {
      auto camera = NamedView(view, bounds, options.projection, options.width, options.height,
                              {options.picture.margin, options.picture.up});
      if (!camera) return camera.error();
      cameras.push_back(std::move(camera).value());
    }
  }
  std::set<std::string> names;
  for (const Camera& camera : cameras) {
    if (!names.insert(camera.name).second)
      return BadUsage("two views are named " + camera.name + ", but files are named after them");
  }
  return cameras;
}

const char* PrecisionName(Precision precision) {
  constexpr const char* kNames[] = {"fast", "standard", "certified"};
  return kNames[static_cast<int>(precision)];
}

const char* ProjectionName(Projection projection) {
  return projection == Projection::kOrthographic ? "orthographic" : "perspective";
}

}  // namespace facetless
