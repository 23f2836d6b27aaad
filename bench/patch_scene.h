// Scenes of untrimmed rational surfaces. They are our own, but resemble those of A. Sisojevs's thesis ("3D
// scene rendering", table 5): a free-form body, 27 copies of it, a device with many small parts, and a
// machine element of quadrics and tori. Also fields with a growing number of faces.
#pragma once

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

// The body of the first scene with all weights 1.
Model BezierBird();

// Returns about `faces` curved bicubic faces on a wavy ground. Each is a patch of its own, and a view from
// above shows all of them.
Model FieldOfFaces(int faces);

}  // namespace facetless
