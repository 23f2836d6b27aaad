#include "render/shade/studio.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

struct Light {
  Vec3 toward;                    // unit
  Vec3 color;                     // linear
  double wrap;                    // 0: Lambert; 1: the terminator lies on the far side
  double scale = 1 / (1 + wrap);  // makes full light 1
};

Vec3 Times(Vec3 a, Vec3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
Vec3 Mix(Vec3 a, Vec3 b, double t) {
  return (1 - t) * a + t * b;
}

// A warm key light from above left, and a cool fill light from the right and a little below.
const Light kKey = {Normalized({-0.50, 0.72, 0.66}), {1.46, 1.37, 1.25}, 0.25};
const Light kFill = {Normalized({0.82, -0.12, 0.45}), {0.17, 0.20, 0.25}, 0.60};
// Ambient light: a bright ceiling and a warm floor.
constexpr Vec3 kCeiling = {0.215, 0.225, 0.245}, kFloor = {0.105, 0.098, 0.090};
// The strengths of the tight and the wide highlight of the key light, and of the rim, where surfaces reflect
// the ceiling.
constexpr double kTight = 0.13, kWide = 0.03, kRim = 0.24;
constexpr Vec3 kRimColor = {0.93, 0.97, 1.0};
// The strengths of the key light and of all other light on a floor that catches shadows. They are closer to each other
// than on the model, so that a shadow on the bright background is not black.
constexpr double kFloorKey = 0.85, kFloorOther = 0.75;
// The beginning of the shoulder curve; smaller values are not changed.
constexpr double kShoulder = 0.60;

double Diffuse(const Light& light, Vec3 normal) {
  // Wrapped Lambert, mixed with its square, so that the terminator is soft.
  const double wrapped = std::max((Dot(normal, light.toward) + light.wrap) * light.scale, 0.0);
  return wrapped * (0.45 + 0.55 * wrapped);
}

// As Diffuse, but without the wrap, so that the light ends where the surface turns away from it.
double DiffuseWithShadow(const Light& light, Vec3 normal) {
  const double cosine = std::max(Dot(normal, light.toward), 0.0);
  return cosine * (0.45 + 0.55 * cosine);
}

double Shoulder(double x) {
  if (x <= kShoulder) return std::max(x, 0.0);
  constexpr double kScale = 1 / (1 - kShoulder);
  const double over = (x - kShoulder) * kScale;
  return kShoulder + (1 - kShoulder) * (over / (1 + over));
}

}  // namespace

StudioView::StudioView(Vec3 toward) : toward_(toward), half_(Normalized(kKey.toward + toward)) {}

// The highlights of the key light around the half vector: cosines to the powers 8 and 64.
double StudioView::KeyHighlight(Vec3 normal) const {
  const double half = std::max(Dot(normal, half_), 0.0);
  const double half2 = half * half, half4 = half2 * half2, half8 = half4 * half4;
  const double half16 = half8 * half8, half32 = half16 * half16, half64 = half32 * half32;
  return kWide * half8 + kTight * half64;
}

// Schlick's fifth power of the grazing angle, brighter on surfaces that face up.
double StudioView::Rim(Vec3 normal) const {
  const double grazing = 1 - std::clamp(Dot(normal, toward_), 0.0, 1.0);
  const double grazing2 = grazing * grazing;
  return kRim * grazing2 * grazing2 * grazing * (0.35 + 0.65 * (0.5 + 0.5 * normal.y));
}

Vec3 StudioView::Light(Vec3 normal, Vec3 albedo) const {
  // Add the diffuse light of both lights and the ambient light.
  const double up = 0.5 + 0.5 * normal.y;
  const Vec3 incoming =
      Diffuse(kKey, normal) * kKey.color + Diffuse(kFill, normal) * kFill.color + Mix(kFloor, kCeiling, up);
  Vec3 light = Times(albedo, incoming) + KeyHighlight(normal) * kKey.color + Rim(normal) * kRimColor;
  return {Shoulder(light.x), Shoulder(light.y), Shoulder(light.z)};
}

Vec3 StudioView::Light(Vec3 normal, Vec3 albedo, const LightShare& share) const {
  const double up = 0.5 + 0.5 * normal.y;
  const double key = share.shadows ? share.key * DiffuseWithShadow(kKey, normal) : Diffuse(kKey, normal);
  const Vec3 other = Diffuse(kFill, normal) * kFill.color + Mix(kFloor, kCeiling, up);
  const double highlight = share.shadows ? share.key * KeyHighlight(normal) : KeyHighlight(normal);
  const Vec3 light = Times(albedo, key * kKey.color + share.open * other) + highlight * kKey.color +
                     (share.open * Rim(normal)) * kRimColor;
  return {Shoulder(light.x), Shoulder(light.y), Shoulder(light.z)};
}

Vec3 KeyDirection() {
  return kKey.toward;
}

Vec3 StudioTone(Vec3 light) {
  return {Shoulder(light.x), Shoulder(light.y), Shoulder(light.z)};
}

double FloorLight(double key_cosine, const LightShare& share) {
  const double key = kFloorKey * std::max(key_cosine, 0.0);
  return (key * share.key + kFloorOther * share.open) / (key + kFloorOther);
}

Vec3 StudioBackground() {
  return {0.905, 0.890, 0.858};
}

}  // namespace facetless
