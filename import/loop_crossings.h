// Finds loops of a face that cross each other or themselves: what such loops enclose is hardly what the file
// means.
#pragma once

#include <cstddef>
#include <vector>

#include "import/face_loops.h"

namespace facetless {

struct LoopCrossing {
  std::size_t first_loop = 0, second_loop = 0;  // the same: it crosses itself
  Vec2 at;                                      // native parameters
};

// At most one crossing for each pair of loops. Curves that touch, that meet at their ends or that run along
// each other do not cross; nor do borders that were made for the face.
std::vector<LoopCrossing> FindLoopCrossings(const std::vector<FaceLoop>& loops);

}  // namespace facetless
