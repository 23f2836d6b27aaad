// The colours in which placed faces are drawn.
//
//  1. kFile: the colour of the face, or else of its instance, or else the default. kPart: one colour for each
//     prototype, wherever it is placed. kOne: one colour for all faces.
//  2. The colour of a part depends only on its position in the file, not on the other parts that are shown.
//  3. The first twelve colours are distinct for normal vision and for all kinds of colour blindness. After
//     that, the colours repeat, darker.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"

namespace facetless {

enum class ColorSource : std::uint8_t { kFile, kPart, kOne };

struct Coloring {
  ColorSource source = ColorSource::kFile;
  Color one;  // of kOne
};

// The sRGB colours, indexed by placed-face id.
std::vector<Color> FaceColors(const Model& model, const Coloring& coloring = {});

// The colour of prototype `part` under kPart.
Color PartColor(std::uint32_t part);

}  // namespace facetless
