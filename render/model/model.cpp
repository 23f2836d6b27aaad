#include "render/model/model.h"

#include <algorithm>
#include <cassert>

#include "render/model/walk.h"

namespace facetless {

const char* SurfaceKindName(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kPlane:
      return "plane";
    case SurfaceKind::kCylinder:
      return "cylinder";
    case SurfaceKind::kCone:
      return "cone";
    case SurfaceKind::kSphere:
      return "sphere";
    case SurfaceKind::kTorus:
      return "torus";
    case SurfaceKind::kRevolution:
      return "revolution";
    case SurfaceKind::kExtrusion:
      return "extrusion";
    case SurfaceKind::kBezier:
      return "bezier";
    case SurfaceKind::kBspline:
      return "bspline";
    case SurfaceKind::kOffset:
      return "offset";
    case SurfaceKind::kOther:
      return "other";
  }
  return "other";
}

std::uint32_t Model::PlacedFaceCount() const {
  if (instances.empty()) return 0;
  const Instance& last = instances.back();
  return last.first_placed_face + parts[last.part].faces.count;
}

std::uint32_t Model::InstanceOfPlacedFace(std::uint32_t id) const {
  assert(id < PlacedFaceCount());
  // Find the last instance that starts at or before `id`. An instance of an empty part shares its start with
  // the next one, which comes later.
  const auto after = std::upper_bound(
      instances.begin(), instances.end(), id,
      [](std::uint32_t value, const Instance& instance) { return value < instance.first_placed_face; });
  return static_cast<std::uint32_t>(after - instances.begin()) - 1;
}

std::uint32_t Model::FaceOfPlacedFace(std::uint32_t id) const {
  const Instance& instance = instances[InstanceOfPlacedFace(id)];
  return FacesOf(*this, instance).first + (id - instance.first_placed_face);
}

std::string Model::PlacedFaceName(std::uint32_t id) const {
  const Instance& instance = instances[InstanceOfPlacedFace(id)];
  const Part& part = parts[instance.part];
  const std::uint32_t index = id - instance.first_placed_face;
  const Face& face = faces[part.faces.first + index];
  // Name the occurrence, or else its prototype.
  std::string name = instance.name.empty() ? part.name : instance.name;
  if (!name.empty()) name += "/";
  // Append the name of the face: from the file, or else its entity, or else its number in the part.
  if (!face.name.empty()) {
    name += face.name;
    if (!face.entity.empty()) name += " " + face.entity;
  } else if (!face.entity.empty()) {
    name += "face " + face.entity;
  } else {
    name += "face " + std::to_string(index);
  }
  return name;
}

Color Model::PlacedFaceColor(std::uint32_t id) const {
  const Instance& instance = instances[InstanceOfPlacedFace(id)];
  const Face& face = faces[FacesOf(*this, instance).first + (id - instance.first_placed_face)];
  if (face.has_color) return face.color;
  if (instance.has_color) return instance.color;
  return Color{};
}

}  // namespace facetless
