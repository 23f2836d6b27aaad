// Numbering of boxes along a space-filling curve: neighbours in space get numbers that are close together.
//
//     const std::vector<std::uint32_t> order = CurveOrder(boxes.boxes());  // order[i]: the i-th box's id
//
//  1. The curve is Morton's (z-order) through the centres of the boxes, with 2^21 steps on each axis of the
//     centres' box. Equal places keep the order of the ids.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/accel/structure.h"

namespace facetless {

std::vector<std::uint32_t> CurveOrder(std::span<const SlabBox> boxes);

}  // namespace facetless
