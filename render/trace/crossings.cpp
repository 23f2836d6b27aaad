#include "render/trace/crossings.h"

#include <algorithm>
#include <tuple>

namespace facetless {

void PutInOrder(const PreparedView& view, std::vector<Crossing>* crossings) {
  const auto leaf_of = [&](const Crossing& c) -> const Leaf& { return view.tiles->leaves()[c.leaf]; };
  const auto by_face = [&](const Crossing& a, const Crossing& b) {
    const std::uint32_t face_a = leaf_of(a).placed_face, face_b = leaf_of(b).placed_face;
    return std::tie(a.sample, face_a, a.hit.depth, a.leaf) < std::tie(b.sample, face_b, b.hit.depth, b.leaf);
  };
  std::sort(crossings->begin(), crossings->end(), by_face);
  const auto twin = [&](const Crossing& a, const Crossing& b) {
    return a.sample == b.sample && leaf_of(a).placed_face == leaf_of(b).placed_face &&
           RootTwin(leaf_of(a), a.hit).Is(RootTwin(leaf_of(b), b.hit));
  };
  crossings->erase(std::unique(crossings->begin(), crossings->end(), twin), crossings->end());
  std::sort(crossings->begin(), crossings->end(), [](const Crossing& a, const Crossing& b) {
    return std::tie(a.sample, a.hit.depth, a.leaf) < std::tie(b.sample, b.hit.depth, b.leaf);
  });
}

}  // namespace facetless
