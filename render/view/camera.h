// Camera: the definition of the ray of each sample. All tracers use it.
//
//     Result<Camera> camera = NamedView("iso", model.bounds, Projection::kOrthographic, 1024, 768);
//     if (!camera) return camera.error();
//     Result<CameraFrame> frame = MakeFrame(camera.value(), model.Diagonal());
//     const Ray ray = PixelRay(frame.value(), column + 0.5, row + 0.5);
//
//  1. The frame is right-handed: `forward` = target − eye, `right` = forward × up, `down` = forward × right,
//     all normalised. The model's Z axis points up.
//  2. Pixel (column i, row j), with row 0 at the top, has its centre at (i + 0.5, j + 0.5). With k×m samples
//     per pixel, the sample grid is a camera of k·width × m·height pixels over the same window.
//  3. The depth of a point is its distance from the eye plane along `forward`, in mm. In orthographic views,
//     the eye plane does not clip, and hits may have any depth. In perspective views, hits are farther away
//     than near_mm.
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
  double height = 1;      // orthographic views: height of the window, mm
  double fov_y_deg = 40;  // perspective views: vertical field of view
  int width_px = 512, height_px = 512;
  int samples_x = 1,
      samples_y = 1;  // more than 1 if width_px and height_px count samples (see Supersampled)

  // A camera over the same window, each of whose pixels is one of the samples_x × samples_y samples of a
  // pixel of this camera.
  Camera Supersampled(int samples_x, int samples_y) const;
};

struct CameraFrame {  // derived from a Camera by MakeFrame
  Vec3 eye, right, down, forward;
  double pixel_x = 1, pixel_y = 1;    // orthographic: mm per pixel; perspective: the same at depth 1 mm
  double center_x = 0, center_y = 0;  // pixel coordinates of the axis: width/2, height/2
  Projection projection = Projection::kOrthographic;
  double near_mm = 0;  // perspective views: points at this depth or nearer are not visible
};

// Computes the frame of a camera. near_mm is 1e-9 times `diagonal_mm`, the diagonal of the model. Errors:
// kBadUsage (the eye equals the target; up is parallel to the view direction; the size, the height or the
// field of view is out of range: 1 … 65,536 px, 0 < fov_y_deg < 180).
Result<CameraFrame> MakeFrame(const Camera& camera, double diagonal_mm);

struct Ray {
  Vec3 origin,
      direction;  // the component of direction along forward is 1, so origin + depth·direction has that depth
};
// The ray through pixel coordinates (x, y).
Ray PixelRay(const CameraFrame& frame, double x, double y);

// The pixel coordinates and the depth of a point. In perspective views, x and y are meaningless for depth <=
// 0.
struct PixelPoint {
  double x, y, depth;
};
PixelPoint Project(const CameraFrame& frame, Vec3 point);

// The names that NamedView accepts, in order: front back left right top bottom iso iso-left iso-back
// iso-right iso-below.
const std::vector<std::string>& ViewNames();

// The model axis that points up in named views. The directions of `front`, `top` and so on turn with it. With
// kY, `front` looks along −Z with +X to the right, as in glTF. With kX, the axes are permuted cyclically, and
// `front` looks along +Z with +Y to the right.
enum class UpAxis : std::uint8_t { kX, kY, kZ };

// Rotates a direction that is defined for Z up to a model whose axis `up` points up.
Vec3 RotateToUpAxis(UpAxis up, Vec3 direction);

struct NamedViewOptions {
  double margin = 0.05;  // margin on each side, as a share of the image's width and height: 0 … kMostMargin
  UpAxis up = UpAxis::kZ;
};
// The largest margin. A larger one would leave almost no room for the model.
inline constexpr double kMostMargin = 0.45;

// Computes what a camera that looks at the centre of `bounds` needs to show all of it: the height of an
// orthographic window, or the distance of a perspective eye from the centre. Only the direction, the field of
// view and the size in pixels of `camera` are used. Errors: kBadUsage (the errors of MakeFrame; empty
// bounds).
struct BoxFit {
  double height_mm = 0, distance_mm = 0;
};
Result<BoxFit> FitBox(const Camera& camera, const Box3& bounds, double margin);

// A camera that looks at `bounds` and fits it into the window inside the margin. With Z up, `front` looks
// along +Y, `right` along −X, `top` along −Z with +Y up, and `iso` from the direction (1, −1, 1)/√3;
// docs/cameras.md has a table. Errors: kBadUsage (an unknown name, and the message lists the valid ones; the
// margin is out of range; empty bounds).
Result<Camera> NamedView(const std::string& name, const Box3& bounds, Projection projection, int width_px,
                         int height_px, const NamedViewOptions& options = {});

// `count` cameras on a circle around the target of `first`, starting with `first` itself. Each camera is
// rotated about the up axis by another 1/count of a turn. The eye moves to the right, so the model seems to
// turn to the left. If `fit` is given, all cameras get the one window height or distance that shows the box
// from all of them; otherwise they keep that of `first`. The name of a camera is the name of `first` followed
// by the number of the frame. Errors: the errors of FitBox.
struct TurntableFit {
  Box3 bounds;
  double margin = 0;
};
Result<std::vector<Camera>> TurntableCameras(const Camera& first, UpAxis up, int count,
                                             const TurntableFit* fit);

}  // namespace facetless
