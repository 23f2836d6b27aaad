#include "render/compare/see_through.h"

#include "render/base/parallel.h"

namespace facetless {

std::vector<bool> TransparentFaces(std::span<const Color> colors) {
  std::vector<bool> transparent(colors.size());
  bool any = false;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    transparent[i] = colors[i].a < 1;
    any = any || transparent[i];
  }
  return any ? transparent : std::vector<bool>();
}

Mesh OpaqueMesh(const Mesh& mesh, const std::vector<bool>& transparent) {
  Mesh opaque = mesh;
  opaque.parts.clear();
  // The placements of one part may differ in which faces are transparent, so each placement gets its own
  // part.
  for (MeshNode& node : opaque.nodes) {
    const MeshPart& whole = mesh.parts[node.part];
    MeshPart part = whole;
    part.triangles.clear();
    part.face_of_triangle.clear();
    for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
      const std::uint32_t face = whole.face_of_triangle[t];
      if (transparent[node.first_placed_face + face]) continue;
      part.triangles.push_back(whole.triangles[t]);
      part.face_of_triangle.push_back(face);
    }
    node.part = static_cast<std::uint32_t>(opaque.parts.size());
    opaque.parts.push_back(std::move(part));
  }
  return opaque;
}

void BlendOver(const SampleBuffer& front_samples, std::span<const Color> colors, const Film& behind,
               Film* front) {
  ParallelFor(0, front->height, [&](int y) {
    const std::size_t first = static_cast<std::size_t>(y) * front->width;
    for (std::size_t i = first; i < first + front->width; ++i) {
      const std::uint32_t face = front_samples.face[i];
      const float opacity = face < colors.size() ? colors[face].a : 1;
      if (!(opacity < 1)) continue;
      for (int c = 0; c < 4; ++c)
        front->pixels[i][c] = opacity * front->pixels[i][c] + (1 - opacity) * behind.pixels[i][c];
    }
  });
}

}  // namespace facetless
