// How pictures are arranged, coloured and labelled, as a caller writes it.
//
// name            type, range                                                    default
// margin          free share of the picture on each side, 0 … 0.45               0.05
// up              x | y | z: the model's axis that named views draw upwards      z
// color           face | part | #rrggbb                                          face
// parts, hide     a pattern or a list of them (render/view/arrangement.h)       all, none
// explode         0 … 100: how much farther apart occurrences are                0
// show_hidden     bool: also what the file hides                                 false
// scale_bar, axes, sheet   true | false                                          false
// turntable       frames, 2 … 360; 0: none                                       0
// turntable_seconds  of one turn, 0.1 … 600                                      6
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/compare/face_colors.h"
#include "render/view/arrangement.h"
#include "render/view/camera.h"

namespace facetless {

struct PictureOptions {
  double margin = NamedViewOptions{}.margin;
  UpAxis up = UpAxis::kZ;
  Coloring coloring;
  ArrangementRequest arrangement;
  bool scale_bar = false, axes = false, sheet = false;
  int turntable = 0;
  double turntable_s = 6;
};

// The names of the table above.
const std::vector<std::string>& PictureOptionNames();

// Stores the option `name`, one of PictureOptionNames(). Error: kBadUsage.
Result<void> ParsePictureOption(const std::string& name, const nlohmann::json& json, PictureOptions& options);

// Whether `command` ("render", "compare", "trade", "bench", "regress") can do what the options ask for. Error: kBadUsage names the option
// that it cannot.
Result<void> CheckPictureOptions(const PictureOptions& options, const std::string& command);

}  // namespace facetless
