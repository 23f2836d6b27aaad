// Parsing section planes in the forms in which callers write them.
//
//   "x,y,z,nx,ny,nz"   a point in millimetres and a normal of any length; the normal's side is removed
//   "z=12.5"           the plane z = 12.5; removes everything above it; "-z=12.5" everything below
//   "z=50%"            the same, at this percentage of the model's bounds
//   [x,y,z,nx,ny,nz]   in JSON, or {"point": [x,y,z], "normal": [nx,ny,nz]}
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/view/section.h"

namespace facetless {

// A section plane whose position may depend on the model's bounds.
struct SectionRequest {
  SectionPlane plane;
  // 0 … 2: the plane is perpendicular to this axis, at `share` of the bounds; −1: `plane` is complete.
  int axis = -1;
  double share = 0;  // 0 … 1
};

// Parses one plane or a list of planes. Error: kBadUsage, which states what is allowed.
Result<std::vector<SectionRequest>> ParseSections(const nlohmann::json& json);

// Computes the planes for a model's bounds. Error: kBadUsage (a percentage of empty bounds).
Result<std::vector<SectionPlane>> ResolveSections(const std::vector<SectionRequest>& requests,
                                                  const Box3& bounds);

}  // namespace facetless
