// Transparency, with a single layer: a transparent face shows what lies behind all transparent faces, dimmed
// by its own opacity. The opacities of several transparent faces behind each other are not combined.
#pragma once

#include <span>
#include <vector>

#include "render/image/film.h"
#include "render/model/mesh.h"
#include "render/model/model.h"
#include "render/view/samples.h"

namespace facetless {

// For each placed face, whether its colour is transparent; empty if none is.
std::vector<bool> TransparentFaces(std::span<const Color> colors);

// The mesh without the triangles of transparent faces. Requires a mesh of the model (Mesh::from_model).
Mesh OpaqueMesh(const Mesh& mesh, const std::vector<bool>& transparent);

// Blends `front` over `behind`, sample by sample, with the opacity of the colour of the front's face.
// Requires equal sizes.
void BlendOver(const SampleBuffer& front_samples, std::span<const Color> colors, const Film& behind,
               Film* front);

}  // namespace facetless
