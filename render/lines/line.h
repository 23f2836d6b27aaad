// The lines of a view, which a line drawing of a model shows.
//
//  1. The points of a line are pixel coordinates of the view's camera, with the depth there. The straight
//     line between two successive points deviates from the exact curve by at most kFlatness on the screen,
//     and by at most kDepthFlatness in depth. The depth matters because a rim that is seen edge-on is a
//     straight line on the screen, but its chords must not pass through the material that hides its far side.
//  2. The classes are listed in drawing order: later classes lie on top.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/view/camera.h"
#include "render/view/section.h"

namespace facetless {

inline constexpr double kFlatness = 0.03, kDepthFlatness = 0.5;  // pixels

enum class LineClass : std::uint8_t {
  kSeam,        // the face on both sides is the same
  kSmooth,      // two faces meet without a bend
  kFeature,     // two faces meet at an angle
  kBoundary,    // the edge of one face only
  kSilhouette,  // the surface turns away from the viewer
  kCut,         // a face meets a section plane
};
inline constexpr std::array<const char*, 6> kLineClassNames = {"seam",     "smooth",     "feature",
                                                               "boundary", "silhouette", "cut"};

// The lines that a picture shows. kHidden also shows hidden lines, dashed, except for hidden seams and smooth
// edges, which would clutter the picture.
enum class LineMode : std::uint8_t { kNone, kVisible, kHidden };

struct LinePoint {
  double x, y, depth;
};

struct ViewLine {
  LineClass kind = LineClass::kFeature;
  bool visible = true;
  std::vector<LinePoint> points;                           // at least two
  std::array<std::uint32_t, 2> faces{kNoIndex, kNoIndex};  // the placed faces on which the line lies
};

// The point at the share `share` of the way from a to b on the screen. Along a straight line, the depth is
// linear in orthographic views, and its reciprocal is linear in perspective views.
LinePoint Between(const CameraFrame& frame, const LinePoint& a, const LinePoint& b, double share);

// Appends the parts of a line that the section planes keep to `out`. `except` is the index of a plane to
// ignore; −1: none.
void ClipLine(const CameraFrame& frame, const std::vector<SectionPlane>& planes, int except, ViewLine line,
              std::vector<ViewLine>* out);

// Appends the parts of a line that lie in a picture of width × height pixels, or so near that the stroke may
// touch it. Segments longer than 1e12 pixels are left out, because rounding hides where they cross the
// picture.
void CutToPicture(const CameraFrame& frame, double width, double height, const ViewLine& line,
                  std::vector<ViewLine>* out);

}  // namespace facetless
