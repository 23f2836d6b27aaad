#include "render/compare/face_colors.h"

#include <algorithm>
#include <iterator>

namespace facetless {
namespace {

// The colours were found by a search. Each is, of all colours of medium lightness and little chroma, the one
// farthest in CIELAB from those before it, where the smallest distance of four kinds of colour vision counts.
// The nearest two are 13 apart; tests/unit/compare/face_colors_test.cpp checks it.
constexpr std::uint8_t kPartColors[][3] = {
    {112, 142, 190}, {154, 94, 52}, {220, 208, 178}, {130, 220, 232}, {172, 136, 136}, {220, 154, 106},
    {112, 94, 118},  {82, 106, 82}, {166, 154, 178}, {70, 100, 148},  {160, 178, 232}, {232, 172, 184}};
// Each further round through the colours multiplies their light by the next of these shares; the last one
// stays.
constexpr float kNextRound = 0.8f;
constexpr std::uint32_t kRounds = 4;

}  // namespace

Color PartColor(std::uint32_t part) {
  const std::uint32_t count = std::size(kPartColors);
  const auto& rgb = kPartColors[part % count];
  float light = 1.0f / 255;
  for (std::uint32_t round = part / count % kRounds; round > 0; --round) light *= kNextRound;
  return {light * rgb[0], light * rgb[1], light * rgb[2]};
}

std::vector<Color> FaceColors(const Model& model, const Coloring& coloring) {
  std::vector<Color> colors(model.PlacedFaceCount(), coloring.one);
  if (coloring.source == ColorSource::kFile) {
    for (std::uint32_t id = 0; id < colors.size(); ++id) colors[id] = model.PlacedFaceColor(id);
  } else if (coloring.source == ColorSource::kPart) {
    for (const Instance& instance : model.instances)
      std::fill_n(colors.begin() + instance.first_placed_face, model.parts[instance.part].faces.count,
                  PartColor(instance.part));
  }
  return colors;
}

}  // namespace facetless
