#include "render/view/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "render/base/trigonometry.h"

namespace facetless {
namespace {

constexpr int kMaxPixels = 65536;
// The least sine of the angle between `up` and the view direction. Rounding rotates the image by about 1e-16
// / sine radians, which at this value is 1e-10, or a hundred-thousandth of a pixel at the largest size.
constexpr double kMinUpSine = 1e-6;
// The range of lengths, mm. Within it, products of four lengths, also of the small lengths of leaves, stay
// well inside the range of a double, and lengths stay inside the range of a float.
constexpr double kLeastLength = 1e-30, kGreatestLength = 1e30;
// The least depth that a perspective view shows, as a share of the model's diagonal.
constexpr double kNearShare = 1e-9;
constexpr double kNamedFovDeg = 40;
// A named perspective view keeps this share of the model's diagonal between the eye and the nearest corner of
// the box.
constexpr double kStandOff = 0.1;

// The tangent of half the field of view, the same on every processor. It is computed by doubling the tangent
// of an eighth twice, which keeps PolyTan in its most accurate range.
double TanOfHalf(double fov_deg) {
  double tangent = PolyTan(fov_deg * (std::numbers::pi / 1440));
  for (int doubling = 0; doubling < 2; ++doubling) tangent = 2 * tangent / std::fma(-tangent, tangent, 1.0);
  return tangent;
}

bool Finite(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool IsLength(double mm) {
  return mm >= kLeastLength && mm <= kGreatestLength;
}

bool IsPlace(Vec3 v) {
  return Length(v) <= kGreatestLength;
}

Error Bad(const Camera& camera, const std::string& what) {
  return {ErrorCode::kBadUsage, "camera '" + camera.name + "': " + what};
}

bool ValidName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

struct ViewDirection {
  const char* name;
  Vec3 toward_eye, up;  // toward_eye is not normalised
};
// docs/cameras.md shows the same table.
constexpr std::array<ViewDirection, 11> kViews = {{
    {"front", {0, -1, 0}, {0, 0, 1}},
    {"back", {0, 1, 0}, {0, 0, 1}},
    {"left", {-1, 0, 0}, {0, 0, 1}},
    {"right", {1, 0, 0}, {0, 0, 1}},
    {"top", {0, 0, 1}, {0, 1, 0}},
    {"bottom", {0, 0, -1}, {0, -1, 0}},
    {"iso", {1, -1, 1}, {0, 0, 1}},
    {"iso-left", {-1, -1, 1}, {0, 0, 1}},
    {"iso-back", {-1, 1, 1}, {0, 0, 1}},
    {"iso-right", {1, 1, 1}, {0, 0, 1}},
    {"iso-below", {1, -1, -1}, {0, 0, 1}},
}};

std::array<Vec3, 8> Corners(const Box3& box) {
  std::array<Vec3, 8> corners;
  for (int i = 0; i < 8; ++i)
    corners[i] = {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                  i & 4 ? box.high.z : box.low.z};
  return corners;
}

}  // namespace

Camera Camera::Supersampled(int kx, int ky) const {
  Camera camera = *this;
  camera.width_px *= kx;
  camera.height_px *= ky;
  camera.samples_x *= kx;
  camera.samples_y *= ky;
  return camera;
}

Result<CameraFrame> MakeFrame(const Camera& camera, double diagonal_mm) {
  // Check every number before it is used, in a form that rejects NaN.
  if (!ValidName(camera.name)) return Bad(camera, "a name consists of letters, digits, '_' and '-'");
  if (!Finite(camera.eye) || !Finite(camera.target) || !Finite(camera.up))
    return Bad(camera, "eye, target and up must be finite numbers");
  if (camera.samples_x < 1 || camera.samples_y < 1 || camera.width_px < 1 || camera.width_px > kMaxPixels ||
      camera.height_px < 1 || camera.height_px > kMaxPixels)
    return Bad(camera, "width and height must be 1 to 65536 pixels, samples included");
  const bool orthographic = camera.projection == Projection::kOrthographic;
  if (orthographic && !(camera.height > 0 && std::isfinite(camera.height)))
    return Bad(camera, "height must be a positive number of millimetres");
  if (!orthographic && !(camera.fov_y_deg > 0 && camera.fov_y_deg < 180))
    return Bad(camera, "fov_y_deg must lie between 0 and 180");

  if (diagonal_mm != 0 && !IsLength(diagonal_mm))
    return Bad(camera, "the model's size must lie between 1e-30 and 1e30 mm; scale it");
  if (!IsPlace(camera.eye) || !IsPlace(camera.target))
    return Bad(camera, "eye and target must lie within 1e30 mm of the origin");

  // Build the axes.
  CameraFrame frame;
  frame.projection = camera.projection;
  frame.eye = camera.eye;
  frame.forward = Normalized(camera.target - camera.eye);
  if (!(Length(frame.forward) > 0)) return Bad(camera, "eye and target must be different points");
  const Vec3 right = Cross(frame.forward, Normalized(camera.up));
  if (!(Length(right) >= kMinUpSine)) return Bad(camera, "up must not lie along the view direction");
  frame.right = Normalized(right);
  frame.down = Cross(frame.forward, frame.right);

  // Compute the size of samples. Pixels are square; samples need not be.
  const double window = orthographic ? camera.height : 2 * TanOfHalf(camera.fov_y_deg);
  const double sample_y = window / camera.height_px;
  frame.pixel_y = sample_y;
  frame.pixel_x = sample_y * camera.samples_y / camera.samples_x;
  if (!IsLength(window))
    return Bad(camera, orthographic ? "height must lie between 1e-30 and 1e30 mm"
                                    : "fov_y_deg is too small to tell its pixels apart");
  frame.center_x = 0.5 * camera.width_px;
  frame.center_y = 0.5 * camera.height_px;
  frame.near_mm = orthographic ? 0 : kNearShare * diagonal_mm;
  return frame;
}

Ray PixelRay(const CameraFrame& frame, double x, double y) {
  const double across = (x - frame.center_x) * frame.pixel_x;
  const double downward = (y - frame.center_y) * frame.pixel_y;
  const Vec3 offset = across * frame.right + downward * frame.down;
  if (frame.projection == Projection::kOrthographic) return {frame.eye + offset, frame.forward};
  return {frame.eye, frame.forward + offset};
}

PixelPoint Project(const CameraFrame& frame, Vec3 point) {
  const Vec3 from_eye = point - frame.eye;
  const double depth = Dot(from_eye, frame.forward);
  const double scale = frame.projection == Projection::kOrthographic ? 1 : depth;
  return {frame.center_x + Dot(from_eye, frame.right) / (scale * frame.pixel_x),
          frame.center_y + Dot(from_eye, frame.down) / (scale * frame.pixel_y), depth};
}

const std::vector<std::string>& ViewNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    list.reserve(std::size(kViews));
    for (const ViewDirection& view : kViews) list.emplace_back(view.name);
    return list;
  }();
  return names;
}

Vec3 RotateToUpAxis(UpAxis up, Vec3 direction) {
  const auto [x, y, z] = direction;
  if (up == UpAxis::kX) return {z, x, y};
  if (up == UpAxis::kY) return {x, z, 0 - y};  // no -0 in reports
  return direction;
}

Result<BoxFit> FitBox(const Camera& camera, const Box3& bounds, double margin) {
  if (bounds.empty() || !Finite(bounds.low) || !Finite(bounds.high))
    return Bad(camera, "the model has no extent to look at");
  const double size = bounds.diagonal() > 0 ? bounds.diagonal() : 1.0;
  const Result<CameraFrame> frame = MakeFrame(camera, size);
  if (!frame.ok()) return frame.error();

  // Fit the corners of the box into the window inside the margin.
  const double used = 1 - 2 * margin;
  const double aspect = static_cast<double>(camera.width_px) / camera.height_px;
  const double tan_y = TanOfHalf(camera.fov_y_deg) * used;
  BoxFit fit;
  for (const Vec3 corner : Corners(bounds)) {
    const Vec3 d = corner - bounds.center();
    const double x = std::fabs(Dot(d, frame.value().right));
    const double y = std::fabs(Dot(d, frame.value().down));
    const double z = Dot(d, frame.value().forward);
    fit.height_mm = std::max({fit.height_mm, 2 * y / used, 2 * x / (aspect * used)});
    fit.distance_mm =
        std::max({fit.distance_mm, y / tan_y - z, x / (aspect * tan_y) - z, kStandOff * size - z});
  }
  return fit;
}

Result<Camera> NamedView(const std::string& name, const Box3& bounds, Projection projection, int width_px,
                         int height_px, const NamedViewOptions& options) {
  const auto view =
      std::find_if(kViews.begin(), kViews.end(), [&](const ViewDirection& v) { return name == v.name; });
  if (view == kViews.end()) {
    std::string names;
    for (const std::string& known : ViewNames()) names += (names.empty() ? "" : ", ") + known;
    return Error{ErrorCode::kBadUsage, "no view is named '" + name + "'; there are: " + names};
  }
  if (bounds.empty() || !Finite(bounds.low) || !Finite(bounds.high))
    return Error{ErrorCode::kBadUsage, "view '" + name + "': the model has no extent to look at"};

  if (!(options.margin >= 0 && options.margin <= kMostMargin))
    return Error{ErrorCode::kBadUsage, "view '" + name + "': the margin must lie between 0 and 0.45"};

  // Look at the centre; a model that is a point gets a window of 1 mm.
  const double size = bounds.diagonal() > 0 ? bounds.diagonal() : 1.0;
  Camera camera;
  camera.name = name;
  camera.projection = projection;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.target = bounds.center();
  camera.up = RotateToUpAxis(options.up, view->up);
  camera.fov_y_deg = kNamedFovDeg;
  camera.height = size;
  const Vec3 toward_eye = Normalized(RotateToUpAxis(options.up, view->toward_eye));
  camera.eye = camera.target + size * toward_eye;
  const Result<BoxFit> fit = FitBox(camera, bounds, options.margin);
  if (!fit.ok()) return fit.error();
  if (projection == Projection::kOrthographic) {
    if (fit.value().height_mm > 0) camera.height = fit.value().height_mm;  // else: a line along the view
  } else {
    camera.height = 0;
    camera.eye = camera.target + fit.value().distance_mm * toward_eye;
  }
  return camera;
}

}  // namespace facetless
