// Writes binary STL: a header of 80 bytes, the number of triangles, and 50 bytes for each triangle.
#include <cstring>
#include <limits>

#include "render/baseline/mesh_encoder.h"
#include "render/baseline/mesh_topology.h"

namespace facetless {
namespace {

// The header must not start with "solid", because readers would take the file for ASCII.
constexpr std::string_view kHeader = "facetless: binary STL, millimetres, Z up";
constexpr std::size_t kHeaderBytes = 80, kRecordBytes = 50;

void AppendVector(std::string& bytes, Vec3 v) {
  const float stored[3] = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  bytes.append(reinterpret_cast<const char*>(stored), sizeof stored);
}

}  // namespace

Result<std::string> EncodeStl(const Mesh& mesh, const Model& model) {
  std::string bytes(kHeader);
  bytes.resize(kHeaderBytes + sizeof(std::uint32_t));
  std::uint64_t count = 0;
  for (const MeshNode& node : mesh.nodes) {
    const MeshPart& part = mesh.parts[node.part];
    if (part.triangles.empty()) continue;
    const WeldedPart welded = Weld(part, SolidsOfFaces(node, model));
    count += welded.triangles.size();
    if (count > std::numeric_limits<std::uint32_t>::max())
      return Error{ErrorCode::kLimitExceeded,
                   "an STL file holds at most 4,294,967,295 triangles, and the mesh has more"};
    const bool mirrored = node.placement.Determinant() < 0;
    bytes.reserve(bytes.size() + kRecordBytes * welded.triangles.size());
    for (const auto& triangle : welded.triangles) {
      Vec3 corners[3];
      for (int k = 0; k < 3; ++k) {
        const auto& p = welded.positions[triangle[mirrored ? 2 - k : k]];
        corners[k] = node.placement.Point({p[0], p[1], p[2]});
      }
      AppendVector(bytes, Normalized(Cross(corners[1] - corners[0], corners[2] - corners[0])));
      for (const Vec3& corner : corners) AppendVector(bytes, corner);
      bytes.append(2, '\0');
    }
  }
  const auto stored = static_cast<std::uint32_t>(count);
  std::memcpy(bytes.data() + kHeaderBytes, &stored, sizeof stored);
  return bytes;
}

}  // namespace facetless
