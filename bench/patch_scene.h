// Scenes of untrimmed rational surfaces. They are our own, but resemble those of A. Sisojevs's thesis ("3D
// scene rendering", table 5): a free-form body, 27 copies of it, a device with many small parts, and a
// machine element of quadrics and tori. Also fields with a growing number of faces.
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

// Returns the four scenes, in the order of the table.
std::vector<NamedScene> PatchScenes();

// Returns about `faces` curved bicubic faces on a wavy ground. Each is a patch of its own, and a view from
// above shows all of them.
Model FieldOfFaces(int faces);

// A patch of the scene in world coordinates: (w·x, w·y, w·z, w), the index of v varies fastest.
struct ScenePatch {
  int degree_u = 1, degree_v = 1;
  std::vector<std::array<double, 4>> points;
  std::uint32_t placed_face = 0;
};

// Returns every patch of every placed face, in the model's order. Requires degrees of at most
// kMaxSceneDegree.
std::vector<ScenePatch> PatchesOf(const Model& model);

}  // namespace facetless
