#include "server/run/mesh_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "render/baseline/mesh_file.h"
#include "render/baseline/mesh_topology.h"
#include "server/base/files.h"

namespace facetless {
namespace {

// A format whose rounding exceeds this share of the chord error makes the mesh noticeably less accurate.
constexpr double kMostRounding = 0.1;

// Returns the largest distance in mm by which STL's single precision moves a corner.
double StlRounding(const Mesh& mesh) {
  const Box3 bounds = MeshBounds(mesh);
  if (bounds.empty()) return 0;
  double largest = 0;
  for (const Vec3& corner : {bounds.low, bounds.high})
    largest = std::max({largest, std::fabs(corner.x), std::fabs(corner.y), std::fabs(corner.z)});
  const auto stored = static_cast<float>(largest);
  // The error is half a unit in the last place in each of the three directions.
  return std::sqrt(3.0) / 2 * (static_cast<double>(std::nextafter(stored, INFINITY)) - stored);
}

std::string Millimetres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g mm", length);
  return text;
}

}  // namespace

std::size_t LeaveOutHidden(const Model& model, Mesh& mesh) {
  return std::erase_if(mesh.nodes, [&](const MeshNode& node) {
    return !mesh.parts[node.part].triangles.empty() &&
           model.instances[model.InstanceOfPlacedFace(node.first_placed_face)].hidden;
  });
}

Result<std::vector<std::string>> WriteMeshFiles(const Model& model, Mesh mesh, MeshFormat format,
                                                bool show_hidden, const std::string& path) {
  std::vector<std::string> sentences;
  if (!RefersToFacesOfModel(mesh, model))
    return Error{ErrorCode::kInternal, "the mesh to be written does not belong to the model"};
  if (!show_hidden) {
    const std::size_t hidden = LeaveOutHidden(model, mesh);
    if (PlacedTriangleCount(mesh) == 0)
      return Error{ErrorCode::kBadUsage,
                   "the file hides everything that the mesh would show; use --show-hidden to write it"};
    if (hidden > 0)
      sentences.push_back(
          "the mesh leaves out " + std::to_string(hidden) +
          (hidden == 1 ? " placement that the file hides" : " placements that the file hides") +
          "; --show-hidden writes " + (hidden == 1 ? "it" : "them"));
  }
  const std::filesystem::path named(path);
  auto files = EncodeMesh(mesh, model, format, named.stem().string());
  if (!files) return files.error();
  for (const MeshOutput& file : files.value()) {
    std::filesystem::path place = named;
    if (!file.suffix.empty()) place.replace_extension(file.suffix);
    if (auto written = WriteFileAtomically(place.string(), file.bytes); !written) return written.error();
  }
  if (const double rounding = format == MeshFormat::kStl ? StlRounding(mesh) : 0;
      rounding > kMostRounding * mesh.deflection_mm)
    sentences.push_back("warning: STL rounds the corners of this mesh by up to " + Millimetres(rounding) +
                        ", because it lies far from the origin; the other formats do not");
  sentences.push_back(TopologySentence(MeasureTopology(mesh, model)));
  return sentences;
}

}  // namespace facetless
