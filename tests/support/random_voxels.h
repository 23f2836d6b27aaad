// Random voxel models for property tests.
#pragma once

#include <rapidcheck.h>

#include <vector>

#include "render/voxels/run_model.h"

namespace facetless::testing {

// A size of 1 … `most` along each axis, each drawn on its own.
inline VoxelPoint AnySize(int most) {
  return {*rc::gen::inRange(1, most + 1), *rc::gen::inRange(1, most + 1), *rc::gen::inRange(1, most + 1)};
}

// One of few voxels, so that neighbours are often equal; empty in one case of four.
inline Voxel AnyVoxel() {
  const int kind = *rc::gen::inRange(0, 8);
  if (kind < 2) return {};
  if (kind < 7)
    return Voxel::Of(static_cast<std::uint8_t>(40 * kind), 100, 7, static_cast<std::uint8_t>(kind));
  return Voxel::Of(*rc::gen::arbitrary<std::uint8_t>(), *rc::gen::arbitrary<std::uint8_t>(),
                   *rc::gen::arbitrary<std::uint8_t>(), *rc::gen::inRange<std::uint8_t>(1, 255));
}

// A box that may reach out of the model, or be empty.
inline VoxelBox AnyBox(VoxelPoint size) {
  const auto from = [](int n) { return *rc::gen::inRange(-3, n + 2); };
  const VoxelPoint low{from(size.x), from(size.y), from(size.z)};
  const auto extent = [](int n) { return *rc::gen::inRange(0, n + 4); };
  return {low, {low.x + extent(size.x), low.y + extent(size.y), low.z + extent(size.z)}};
}

// A model of some filled boxes and some single voxels.
inline RunModel AnyModel(int most_size) {
  RunModel model(AnySize(most_size));
  const int boxes = *rc::gen::inRange(0, 6), singles = *rc::gen::inRange(0, 40);
  for (int i = 0; i < boxes; ++i) model.Fill(AnyBox(model.size()), AnyVoxel());
  for (int i = 0; i < singles; ++i) {
    const VoxelPoint p = AnyBox(model.size()).low;
    model.Set(p.x, p.y, p.z, AnyVoxel());
  }
  return model;
}

}  // namespace facetless::testing
