// The final pictures of a run: scale bars and axes, the contact sheet, and the turntable.
//
//  1. These functions change no number, because the pictures have been compared before.
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

// Draws the scale bar and the axes that the options select into the picture of a view. A legend below the
// view is not changed.
void Decorate(Image8& image, const Camera& camera, const CameraFrame& frame, const PictureOptions& options);

// Collects all views of a run on one picture, reduced when they are added. It collects nothing without
// --sheet.
class ContactSheet {
 public:
  // `columns` is the number of columns; 0 makes the sheet about square.
  ContactSheet(bool wanted, int columns) : wanted_(wanted), columns_(columns) {}

  // Adds the part of a picture that shows the view, without a legend.
  Result<void> Add(const Image8& picture, const Camera& camera, const std::string& label);
  // Writes sheet.png and names it in `files`, as "sheet".
  Result<void> Write(const std::string& directory, RunFiles& files) const;

 private:
  bool wanted_;
  int columns_;
  std::vector<SheetTile> tiles_;
};

// The input of a turntable.
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
