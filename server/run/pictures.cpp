#include "server/run/pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "render/base/stopwatch.h"
#include "render/compare/report.h"
#include "render/image/animation.h"
#include "render/image/io.h"
#include "render/image/overlay.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

std::string FrameFile(std::size_t frame) {
  char name[48];
  std::snprintf(name, sizeof name, "turntable.%03zu.png", frame + 1);
  return name;
}

// Returns the cameras of all frames. A named view is fitted again, because a turning model needs more width.
Result<std::vector<Camera>> FrameCameras(const RunOptions& options, const Box3& bounds) {
  auto views = ResolveCameras(options, bounds);
  if (!views) return views.error();
  const TurntableFit fit = {bounds, options.picture.margin};
  return TurntableCameras(views.value().front(), options.picture.up, options.picture.turntable,
                          options.cameras.is_array() ? nullptr : &fit);
}

int FrameTime(const PictureOptions& options, std::size_t frame) {
  constexpr double kMillisecondsPerSecond = 1000;
  return static_cast<int>(std::round(kMillisecondsPerSecond * options.turntable_s *
                                     static_cast<double>(frame) / options.turntable));
}

}  // namespace

void Decorate(Image8& image, const Camera& camera, const CameraFrame& frame, const PictureOptions& options) {
  DrawOverlay(image, camera.height_px, frame, {options.axes, options.scale_bar});
}

Result<void> ContactSheet::Add(const Image8& picture, const Camera& camera, const std::string& label) {
  if (!wanted_) return {};
  Image8 view = picture;
  view.height = std::min(view.height, camera.height_px);
  view.bytes.resize(static_cast<std::size_t>(view.width) * view.height * view.channels);
  auto reduced = Reduced(view, kSheetTile);
  if (!reduced) return reduced.error();
  tiles_.push_back({std::move(reduced).value(), label});
  return {};
}

Result<void> ContactSheet::Write(const std::string& directory, RunFiles& files) const {
  if (!wanted_) return {};
  auto sheet = DrawSheet(tiles_, columns_ > 0 ? columns_ : SheetColumns(tiles_.size()));
  if (!sheet) return sheet.error();
  constexpr const char* kName = "sheet.png";
  files.Add("", "sheet", kName);
  return WritePng(directory + "/" + kName, sheet.value());
}

Result<Json> RenderTurntable(const TurntableRun& run, RunFiles& files) {
  const Stopwatch stopwatch;
  auto cameras = FrameCameras(run.options, run.model.bounds);
  if (!cameras) return cameras.error();
  const PictureOptions& options = run.options.picture;
  const Camera& first = cameras.value().front();
  auto animation = Animation::Begin(first.width_px, first.height_px);
  if (!animation) return animation.error();
  ViewOptions view_options = run.view;
  view_options.uv = view_options.depth_error = view_options.audit = false;

  Json names = Json::array();
  for (std::size_t frame = 0; frame < cameras.value().size(); ++frame) {
    run.progress(static_cast<double>(frame) / options.turntable);
    const Camera& camera = cameras.value()[frame];
    auto view = RenderView(run.exact, run.model, camera, view_options);
    if (!view) return view.error();
    Image8& image = view.value().image;
    Decorate(image, camera, view.value().frame, options);
    if (auto written = WritePng(run.directory + "/" + FrameFile(frame), image); !written)
      return written.error();
    if (auto added = animation.value().Add(image, FrameTime(options, frame)); !added) return added.error();
    names.push_back(FrameFile(frame));
    files.AddFrame(FrameFile(frame));
  }
  constexpr const char* kName = "turntable.webp";
  if (auto written =
          animation.value().Write(run.directory + "/" + kName, FrameTime(options, cameras.value().size()));
      !written)
    return written.error();
  files.Add("", "turntable", kName);
  run.progress(1);
  constexpr const char* kAxes[] = {"x", "y", "z"};
  return Json{{"up", kAxes[static_cast<int>(options.up)]},
              {"seconds", options.turntable_s},
              {"frames", std::move(names)},
              {"camera", CameraJson(first)},
              {"timing_ms", {{"total", stopwatch.Milliseconds()}}}};
}

}  // namespace facetless
