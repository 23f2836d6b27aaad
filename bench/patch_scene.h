// Scenes of untrimmed rational surfaces, of our own, in the spirit of those of A. Sisojevs's thesis ("3D
// scene rendering", table 5): a free-form body, 27 of it, a device with many small parts, and a machine
// element of quadrics and tori; and growing fields of faces.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/model/model.h"

namespace facetless {

struct NamedScene {
  std::string name;
  Model model;
};

// The four scenes, in the order of the table.
std::vector<NamedScene> PatchScenes();

// About `faces` curved bicubic faces on a wavy ground, each a patch of its own, seen from above at once.
Model FieldOfFaces(int faces);

// A patch of the scene in world coordinates: (w·x, w·y, w·z, w), v fastest.
struct ScenePatch {
  int degree_u = 1, degree_v = 1;
  std::vector<std::array<double, 4>> points;
  std::uint32_t placed_face = 0;
};

// Every patch of every placed face, in the model's order. Requires degrees of at most kMaxSceneDegree.
std::vector<ScenePatch> PatchesOf(const Model& model);

}  // namespace facetless
