// Camera: which ray belongs to which sample. The one definition that both tracers share.
//
//  1. Right-handed: `forward` = target − eye normalised, `right` = forward × up, `down` = forward × right.
//     Model axes are Z up.
//  2. Pixel (column i, row j), row 0 on top, has its centre at (i + 0.5, j + 0.5). With k×m samples per pixel
//     the sample grid is a camera of k·width × m·height pixels over the same window.
//  3. Depth of a point is its distance from the eye plane along `forward`, in mm. Orthographic hits may have
//     any depth (the eye plane does not clip); perspective ones are farther than near_mm.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/model/result.h"
#include "render/model/vec.h"

namespace facetless {

enum class Projection : std::uint8_t { kOrthographic, kPerspective };

struct Camera {
  std::string name = "iso";  // file name stem of the view's images: [A-Za-z0-9_-]+
  Vec3 eye{0, 0, 1}, target{0, 0, 0}, up{0, 1, 0};
  Projection projection = Projection::kOrthographic;
  double height = 1;      // orthographic: of the window, model units
  double fov_y_deg = 40;  // perspective
  int width_px = 512, height_px = 512;
  int samples_x = 1,
      samples_y = 1;  // more than 1 where width_px and height_px count samples: see Supersampled

  // The camera whose pixels are this one's samples_x × samples_y samples, over the same window.
  Camera Supersampled(int samples_x, int samples_y) const;
};

struct CameraFrame {  // derived from a Camera by MakeFrame
  Vec3 eye, right, down, forward;
  double pixel_x = 1, pixel_y = 1;    // orthographic: mm per pixel; perspective: the same at depth 1 mm
  double center_x = 0, center_y = 0;  // pixel coordinates of the axis: width/2, height/2
  Projection projection = Projection::kOrthographic;
  double near_mm = 0;  // perspective: nothing nearer is seen
};

// Errors: kBadUsage (eye = target, up along the view direction, size or height or fov out of range: 1 …
// 65,536 px, 0 < fov < 180). near_mm is 1e-9 of `diagonal_mm`, the model's.
Result<CameraFrame> MakeFrame(const Camera& camera, double diagonal_mm);

struct Ray {
  Vec3 origin,
      direction;  // direction has unit component along forward: origin + depth·direction is at that depth
};
// The ray through pixel coordinates (x, y).
Ray PixelRay(const CameraFrame& frame, double x, double y);

// Pixel coordinates and depth of a point; perspective: meaningless for depth <= 0.
struct PixelPoint {
  double x, y, depth;
};
PixelPoint Project(const CameraFrame& frame, Vec3 point);

// Names of NamedView, in order: front back left right top bottom iso iso-left iso-back iso-right iso-below.
const std::vector<std::string>& ViewNames();

// A camera that looks at `bounds` and fits it with 5 % of margin: `front` looks along +Y, `right` along −X,
// `top` along −Z (+Y up), `iso` from (1, −1, 1)/√3; see the table in docs/cameras.md. Error: kBadUsage names
// the valid names.
Result<Camera> NamedView(const std::string& name, const Box3& bounds, Projection projection, int width_px,
                         int height_px);

}  // namespace facetless
