// Whether a mesh has anything to do with the model that it is compared with, and whether it is turned inside
// out: judged of all views of a run together.
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

  // One view.
  void Add(const Difference& difference);
  // Sentences; none where nothing is wrong.
  std::vector<std::string> Problems() const;

 private:
  const double diagonal_mm_;
  std::uint64_t direct_ = 0, baseline_ = 0, both_ = 0, oriented_ = 0, opposite_ = 0;
  double nearest_mm_ = INFINITY;
};

}  // namespace facetless
