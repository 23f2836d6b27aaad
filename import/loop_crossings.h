// Finds loops of a face that cross each other or themselves. The area that such loops enclose is hardly the
// area that the file means.
#pragma once

#include <cstddef>
#include <vector>

#include "import/face_loops.h"

namespace facetless {

struct LoopCrossing {
  std::size_t first_loop = 0, second_loop = 0;  // equal if the loop crosses itself
  Vec2 at;                                      // the place, in native parameters
};

// Returns at most one crossing for each pair of loops. Curves that touch, that meet at their ends or that run
// along each other do not cross. Borders that were made for the face are ignored.
std::vector<LoopCrossing> FindLoopCrossings(const std::vector<FaceLoop>& loops);

}  // namespace facetless
