// What is seen through transparent faces: one layer. A transparent face shows what lies behind all
// transparent faces, dimmed by its own opacity; transparent faces behind each other are not added up.
#pragma once

#include <span>
#include <vector>

#include "render/image/film.h"
#include "render/model/mesh.h"
#include "render/model/model.h"
#include "render/view/samples.h"

namespace facetless {

// By placed face: whether its colour is transparent; empty if none is.
std::vector<bool> TransparentFaces(std::span<const Color> colors);

// The mesh without the triangles of those faces. Requires a mesh of the model's own (Mesh::from_model).
Mesh OpaqueMesh(const Mesh& mesh, const std::vector<bool>& transparent);

// Lays `front` over `behind`, sample by sample, as opaque as the colour of the front's face says. Requires
// equal sizes.
void BlendOver(const SampleBuffer& front_samples, std::span<const Color> colors, const Film& behind,
               Film* front);

}  // namespace facetless
