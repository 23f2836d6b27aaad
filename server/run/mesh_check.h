// Checks whether a mesh is related to the model with which it is compared, and whether it is inside out. The
// check uses all views of a run together.
//
//   MeshCheck check(model.Diagonal());
//   for (const Difference& difference : differences) check.Add(difference);
//   for (const std::string& problem : check.Problems()) ...
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "render/compare/difference.h"

namespace facetless {

class MeshCheck {
 public:
  explicit MeshCheck(double diagonal_mm) : diagonal_mm_(diagonal_mm) {}

  // Adds the difference of one view.
  void Add(const Difference& difference);
  // The problems as sentences; empty if there are none.
  std::vector<std::string> Problems() const;

 private:
  const double diagonal_mm_;
  std::uint64_t direct_ = 0, baseline_ = 0, both_ = 0, oriented_ = 0, opposite_ = 0;
  double nearest_mm_ = INFINITY;
};

}  // namespace facetless
