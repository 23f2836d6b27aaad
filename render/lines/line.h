// Lines of a view: what a drawing shows of a model, in pixels.
//
//  1. Points are pixel coordinates of the view's camera and the depth there; between two of them runs a
//     straight line that is off the exact curve by at most kFlatness, and by kDepthFlatness in depth: a rim
//     that is seen edge-on is a straight line on the screen, and must not run through the inside of what
//     hides its far side.
//  2. Classes, in the order in which they are drawn: what comes later lies on top.
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
  kSeam,        // both sides are the same face
  kSmooth,      // two faces meet without a bend
  kFeature,     // two faces meet at an angle
  kBoundary,    // the edge of one face only
  kSilhouette,  // the surface turns away from the viewer
  kCut,         // a face meets a section plane
};
inline constexpr std::array<const char*, 6> kLineClassNames = {"seam",     "smooth",     "feature",
                                                               "boundary", "silhouette", "cut"};

// Which lines a picture shows. kHidden: those too that are hidden, dashed; but for seams and smooth edges,
// which would only be in the way.
enum class LineMode : std::uint8_t { kNone, kVisible, kHidden };

struct LinePoint {
  double x, y, depth;
};

struct ViewLine {
  LineClass kind = LineClass::kFeature;
  bool visible = true;
  std::vector<LinePoint> points;                           // two at least
  std::array<std::uint32_t, 2> faces{kNoIndex, kNoIndex};  // placed faces that it lies on
};

// The point at `share` of the way from a to b on the screen. Depth runs evenly on a straight line in an
// orthographic view, its reciprocal in perspective.
LinePoint Between(const CameraFrame& frame, const LinePoint& a, const LinePoint& b, double share);

// Where the planes cut a line away nothing is left of it. Appends what is to `out`; `except`: a plane that is
// not asked, −1 for none.
void ClipLine(const CameraFrame& frame, const std::vector<SectionPlane>& planes, int except, ViewLine line,
              std::vector<ViewLine>* out);

// Appends what of a line lies in a picture of width × height pixels, or so near that the line's width may
// touch it. Left out is also the way between two points more than 1e12 pixels apart: no number says where it
// crosses the picture.
void CutToPicture(const CameraFrame& frame, double width, double height, const ViewLine& line,
                  std::vector<ViewLine>* out);

}  // namespace facetless
