// Implements TurntableCameras of camera.h.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "render/base/trigonometry.h"
#include "render/view/camera.h"

namespace facetless {
namespace {

// The cosine and the sine of step/count of a turn, the same on every processor. They are computed by the
// rational form in the tangent of half the angle, relative to the nearest axis, and are exact for quarters of
// a turn.
Vec2 OnTurn(int step, int count) {
  const int quarter = (8 * step + count) / (2 * count);                         // the nearest, rounded up
  const double rest = static_cast<double>(4 * step - quarter * count) / count;  // in quarters, ±1/2
  const double t = PolyTan(rest * (std::numbers::pi / 4));
  Vec2 p{(1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)};
  for (int turn = quarter % 4; turn > 0; --turn) p = {-p.y, p.x};
  return p;
}

// Rotates `v` about the unit vector `axis`.
Vec3 Turned(Vec3 v, Vec3 axis, Vec2 turn) {
  const Vec3 along = Dot(v, axis) * axis, across = v - along;
  return along + turn.x * across + turn.y * Cross(axis, across);
}

std::string FrameName(const std::string& name, int frame) {
  char number[16];
  std::snprintf(number, sizeof number, "-%03d", frame + 1);
  return name + number;
}

}  // namespace

Result<std::vector<Camera>> TurntableCameras(const Camera& first, UpAxis up, int count,
                                             const TurntableFit* fit) {
  const Vec3 axis = RotateToUpAxis(up, {0, 0, 1});
  std::vector<Camera> cameras;
  BoxFit needed;
  for (int frame = 0; frame < count; ++frame) {
    const Vec2 turn = OnTurn(frame, count);
    Camera camera = first;
    camera.name = FrameName(first.name, frame);
    camera.eye = first.target + Turned(first.eye - first.target, axis, turn);
    camera.up = Turned(first.up, axis, turn);
    if (fit != nullptr) {
      const Result<BoxFit> own = FitBox(camera, fit->bounds, fit->margin);
      if (!own.ok()) return own.error();
      needed.height_mm = std::max(needed.height_mm, own.value().height_mm);
      needed.distance_mm = std::max(needed.distance_mm, own.value().distance_mm);
    }
    cameras.push_back(std::move(camera));
  }
  if (fit == nullptr) return cameras;

  // Use the same window for all frames, so that the size of the model does not change during the turn.
  for (Camera& camera : cameras) {
    if (camera.projection == Projection::kPerspective) {
      camera.eye = camera.target + needed.distance_mm * Normalized(camera.eye - camera.target);
    } else if (needed.height_mm > 0) {
      camera.height = needed.height_mm;
    }
  }
  return cameras;
}

}  // namespace facetless
