// Which colour a placed face is drawn in.
//
//  1. kFile: the face's, else its instance's, else the default. kPart: one for each prototype, wherever it is
//     placed. kOne: one for all.
//  2. A part's colour follows from its place in the file alone: it does not change with what is shown beside
//     it.
//  3. The first twelve parts can be told apart with normal sight and without red, green or blue cones; then
//     the colours repeat, darker.
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

// By placed-face id, sRGB.
std::vector<Color> FaceColors(const Model& model, const Coloring& coloring = {});

// The colour of prototype `part` under kPart.
Color PartColor(std::uint32_t part);

}  // namespace facetless
