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

#include "render/base/result.h"
#include "render/base/vec.h"

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

// The axis of the model that named views draw upwards. What `front`, `top` and so on show turns with it:
// kY as in glTF (`front` looks along −Z, +X to the right), kX by exchanging the axes in a circle (`front`
// looks along +Z, +Y to the right).
enum class UpAxis : std::uint8_t { kX, kY, kZ };

// A direction that is (x, y, z) where Z is up, in a model whose `up` is up: a rotation of the axes.
Vec3 TurnedTo(UpAxis up, Vec3 direction);

struct NamedViewOptions {
  double margin = 0.05;  // free border, of the image's width and height, on each side: 0 … kMostMargin
  UpAxis up = UpAxis::kZ;
};
// Beyond it next to nothing is left for the model.
inline constexpr double kMostMargin = 0.45;

// What a camera that looks at the centre of `bounds` needs to show all of it: the height of an orthographic
// window, or the distance of a perspective eye from the centre. Only the camera's direction, field of view
// and size in pixels count. Errors: kBadUsage (those of MakeFrame; bounds that are empty).
struct BoxFit {
  double height_mm = 0, distance_mm = 0;
};
Result<BoxFit> FitBox(const Camera& camera, const Box3& bounds, double margin);

// A camera that looks at `bounds` and fits it into the window less its margin: with Z up, `front` looks
// along +Y, `right` along −X, `top` along −Z (+Y up), `iso` from (1, −1, 1)/√3; see the table in
// docs/cameras.md. Error: kBadUsage (no such name: names the valid ones; margin).
Result<Camera> NamedView(const std::string& name, const Box3& bounds, Projection projection, int width_px,
                         int height_px, const NamedViewOptions& options = {});

// `count` cameras around `first`'s target, beginning where it stands: each is turned about the axis that is
// up by a further 1/count of a turn, eye to the right, so that the model turns to the left. Where `fit` is
// given, all get the one window or distance that shows it from each of them; else they keep `first`'s. Names
// are `first`'s with the frame's number. Errors: those of FitBox.
struct TurntableFit {
  Box3 bounds;
  double margin = 0;
};
Result<std::vector<Camera>> TurntableCameras(const Camera& first, UpAxis up, int count,
                                             const TurntableFit* fit);

}  // namespace facetless
