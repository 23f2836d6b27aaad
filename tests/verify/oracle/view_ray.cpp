#include "tests/verify/oracle/view_ray.h"

namespace facetless::oracle {
namespace {

Real3 Widened(Vec3 v) {
  return {v.x, v.y, v.z};
}

}  // namespace

ViewRay ViewRay::Moved(Real along_across, Real along_down) const {
  ViewRay moved = *this;
  moved.origin = origin + along_across * across + along_down * down;
  return moved;
}

ViewRay ViewPixelRay(const View& view, double x, double y) {
  // Compute the camera's axes.
  const Real3 eye = Widened(view.eye);
  const Real3 forward = Normalized(Widened(view.target) - eye);
  const Real3 right = Normalized(Cross(forward, Widened(view.up)));
  const Real3 down = Cross(forward, right);
  // Compute the pixel's position in the window, in mm, or for perspective in mm at a depth of 1 mm.
  const Real window = view.perspective ? 2 * Tan(Real(view.fov_y_deg) * Pi() / 360) : Real(view.height);
  const Real pixel = window / view.height_px;
  const Real3 offset =
      (Real(x) - Real(view.width) / 2) * pixel * right + (Real(y) - Real(view.height_px) / 2) * pixel * down;
  ViewRay ray;
  ray.eye = eye;
  ray.forward = forward;
  ray.perspective = view.perspective;
  ray.origin = view.perspective ? eye : eye + offset;
  ray.direction = view.perspective ? forward + offset : forward;
  // Choose two directions across the ray. `right` is never along it.
  const Real3 along = Normalized(ray.direction);
  ray.across = Normalized(right - Dot(right, along) * along);
  ray.down = Cross(along, ray.across);
  return ray;
}

}  // namespace facetless::oracle
