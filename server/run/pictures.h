// Pictures as they leave a run: what is drawn into them at last, the contact sheet, the turntable.
//
//  1. Nothing here changes a number: pictures were compared before.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/compare/compare_view.h"
#include "render/image/sheet.h"
#include "server/options/options.h"
#include "server/run/run_result.h"

namespace facetless {

// Scale bar and axes, as the options say, into the picture of a view; a legend below the view stays as it is.
void Decorate(Image8& image, const Camera& camera, const CameraFrame& frame, const PictureOptions& options);

// All views of a run on one picture, reduced as they come. Without --sheet it keeps nothing.
class ContactSheet {
 public:
  // So many columns; 0: as many as make it about square.
  ContactSheet(bool wanted, int columns) : wanted_(wanted), columns_(columns) {}

  // The view's part of a picture.
  Result<void> Add(const Image8& picture, const Camera& camera, const std::string& label);
  // Writes sheet.png and names it in `files`, as "sheet".
  Result<void> Write(const std::string& directory, RunFiles& files) const;

 private:
  bool wanted_;
  int columns_;
  std::vector<SheetTile> tiles_;
};

// What a turntable is made with.
struct TurntableRun {
  const Representation& exact;
  const Model& model;
  const RunOptions& options;
  const ViewOptions& view;
  const std::string& directory;
  std::function<void(double fraction)> progress;
};

// Writes turntable.001.png, … and turntable.webp around the first view; the report's "turntable": {"up",
// "seconds", "frames": [names], "camera": of the first frame, "timing_ms"}, and the animation in `files`,
// as "turntable". One frame is held at a time. Errors: those of ResolveCameras, RenderView, Animation and
// WritePng.
Result<nlohmann::json> RenderTurntable(const TurntableRun& run, RunFiles& files);

}  // namespace facetless
