#include "render/accel/plane_traversal.h"

namespace facetless {

void AppendPlanes(std::span<const SlabBox> boxes, std::vector<BoxPlane>& planes) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto first = static_cast<std::ptrdiff_t>(planes.size());
    for (std::uint32_t box = 0; box < boxes.size(); ++box)
      for (const bool high : {false, true}) planes.push_back({boxes[box].side[high][axis], box, high});
    std::sort(planes.begin() + first, planes.end(), [](const BoxPlane& a, const BoxPlane& b) {
      return a.at != b.at ? a.at < b.at : a.high != b.high ? b.high : a.box < b.box;
    });
  }
}

PlaneTraversal::PlaneTraversal(std::span<const Box3> boxes) : boxes_(boxes) {
  planes_.reserve(6 * boxes.size());
  AppendPlanes(boxes_.boxes(), planes_);
}

}  // namespace facetless
