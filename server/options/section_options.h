// Section planes as a caller writes them.
//
//  "x,y,z,nx,ny,nz"   a point in millimetres and a normal of any length; the side that it points to is removed
//  "z=12.5"           the plane z = 12.5, all above it removed; "-z=12.5": all below it
//  "z=50%"            the same, at that share of the model's bounds
//  [x,y,z,nx,ny,nz]   in JSON, or {"point": [x,y,z], "normal": [nx,ny,nz]}
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/view/section.h"

namespace facetless {

// A plane that may wait for the model's bounds.
struct SectionRequest {
  SectionPlane plane;
  int axis = -1;     // 0 … 2: the plane stands at `share` of the bounds along it
  double share = 0;  // 0 … 1
};

// One plane, or a list. Error: kBadUsage says what is allowed.
Result<std::vector<SectionRequest>> ParseSections(const nlohmann::json& json);

// Errors: kBadUsage (a share of bounds that are empty).
Result<std::vector<SectionPlane>> ResolveSections(const std::vector<SectionRequest>& requests,
                                                  const Box3& bounds);

}  // namespace facetless
