// Fuzz target: mesh files, glTF binary and STL.
#include "render/baseline/mesh_file.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const facetless::InputFile file;
  facetless::MeshLoadOptions options;
  options.max_memory_bytes = std::uint64_t{64} << 20;
  options.max_nodes = 10'000;
  const auto mesh = facetless::LoadMesh(file.Write(data, size), options, nullptr);
  if (!mesh.ok()) return 0;
  // What is promised of a mesh: indices in range.
  for (const facetless::MeshNode& node : mesh.value().nodes)
    facetless::Require(node.part < mesh.value().parts.size());
  for (const facetless::MeshPart& part : mesh.value().parts) {
    for (const auto& triangle : part.triangles)
      for (const std::uint32_t vertex : triangle) facetless::Require(vertex < part.positions.size());
  }
  return 0;
}
