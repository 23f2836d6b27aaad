#include "render/trace/crossings.h"

#include <algorithm>
#include <tuple>

namespace facetless {

void SortCrossings(const PreparedView& view, std::vector<Crossing>* crossings) {
  const LeafSpans leaves = view.tiles->leaves();
  const auto face_of = [&](const Crossing& c) { return leaves.Header(c.leaf).placed_face; };
  // If nothing else distinguishes two crossings, the order of their leaves in the tile's list decides.
  const auto leaf_first = [&](const Crossing& a, const Crossing& b) {
    return FrontToBack(leaves, a.leaf, b.leaf);
  };
  std::sort(crossings->begin(), crossings->end(), [&](const Crossing& a, const Crossing& b) {
    const std::uint32_t face_a = face_of(a), face_b = face_of(b);
    const auto key_a = std::tie(a.sample, face_a, a.hit.depth),
               key_b = std::tie(b.sample, face_b, b.hit.depth);
    return key_a != key_b ? key_a < key_b : leaf_first(a, b);
  });
  const auto twin = [&](const Crossing& a, const Crossing& b) {
    return a.sample == b.sample && face_of(a) == face_of(b) &&
           RootTwin(view, a.leaf, a.hit).Is(RootTwin(view, b.leaf, b.hit));
  };
  crossings->erase(std::unique(crossings->begin(), crossings->end(), twin), crossings->end());
  std::sort(crossings->begin(), crossings->end(), [&](const Crossing& a, const Crossing& b) {
    const auto key_a = std::tie(a.sample, a.hit.depth), key_b = std::tie(b.sample, b.hit.depth);
    return key_a != key_b ? key_a < key_b : leaf_first(a, b);
  });
}

}  // namespace facetless
