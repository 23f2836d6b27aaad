// Fuzz target: mesh files, glTF binary and STL. A mesh that can be read is traced and cut in a small picture.
#include "render/baseline/mesh_file.h"
#include "render/baseline/mesh_section.h"
#include "render/baseline/tracer.h"
#include "tests/verify/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const facetless::InputFile file;
  facetless::MeshLoadOptions options;
  options.max_memory_bytes = std::uint64_t{64} << 20;
  options.max_nodes = 10'000;
  const auto mesh = facetless::LoadMesh(file.Write(data, size), options, nullptr);
  if (!mesh.ok()) return 0;
  // A mesh must have all indices in range.
  for (const facetless::MeshNode& node : mesh.value().nodes)
    facetless::Require(node.part < mesh.value().parts.size());
  for (const facetless::MeshPart& part : mesh.value().parts) {
    for (const auto& triangle : part.triangles)
      for (const std::uint32_t vertex : triangle) facetless::Require(vertex < part.positions.size());
  }
  const auto scene = facetless::BaselineScene::Build(mesh.value(), {.threads = 1});
  if (!scene.ok()) return 0;
  const facetless::Vec3 center = scene.value().bounds().center();
  facetless::Camera camera;
  camera.target = center;
  camera.height = scene.value().bounds().diagonal();
  camera.eye = center + camera.height * facetless::Vec3{1, -1, 1};
  camera.width_px = camera.height_px = 12;
  const auto traced = facetless::TraceBaseline(scene.value(), camera, {{.threads = 1}});
  if (traced.ok()) facetless::Require(traced.value().stats.hits <= traced.value().stats.rays);
  facetless::MeshSectionArea(mesh.value(), {center, {0, 0, 1}});
  return 0;
}
