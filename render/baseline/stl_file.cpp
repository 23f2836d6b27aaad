// STL through assimp, with every other importer of that library switched off.
#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <string_view>
#include <vector>

#include "render/baseline/mesh_reader.h"
#include "render/baseline/smooth_normals.h"

namespace facetless {
namespace {

constexpr std::size_t kBinaryHeader = 84, kBinaryRecord = 50;

// How long a binary file that claims this many triangles must be; 0 if `bytes` is shorter.
std::size_t BinaryLength(Bytes bytes) {
  if (bytes.size() < kBinaryHeader) return 0;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, bytes.data() + 80, 4);
  const std::size_t length = kBinaryHeader + kBinaryRecord * static_cast<std::size_t>(triangles);
  return length <= bytes.size() ? length : 0;
}

// "solid", and "facet" or "endsolid" soon after: the headers of many binary files begin with "solid" too.
bool LooksLikeAscii(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              std::min<std::size_t>(bytes.size(), 2048));
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos || text.substr(start, 5) != "solid") return false;
  return text.find('\0') == std::string_view::npos &&
         (text.find("facet") != std::string_view::npos || text.find("endsolid") != std::string_view::npos);
}

void KeepOnlyStl(Assimp::Importer& importer) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    const aiImporterDesc* description = importer.GetImporterInfo(i);
    if (std::string_view(description->mFileExtensions) == "stl") continue;
    // Who takes a loader out owns it.
    const std::unique_ptr<Assimp::BaseImporter> loader(importer.GetImporter(i));
    importer.UnregisterLoader(loader.get());
  }
}

Result<MeshPart> CopyTriangles(const aiScene& scene, const std::string& name,
                               const MeshLoadOptions& options) {
  MeshPart part;
  part.name = name;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    const std::size_t base = part.positions.size();
    const std::uint64_t memory =
        (base + mesh.mNumVertices) * kVertexBytes + (part.triangles.size() + mesh.mNumFaces) * kTriangleBytes;
    if (base + mesh.mNumVertices >= kNoIndex || memory > options.max_memory_bytes)
      return Error{ErrorCode::kLimitExceeded, name + ": unpacked, it takes more than " +
                                                  std::to_string(options.max_memory_bytes) + " bytes"};
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        return Error{ErrorCode::kNotFinite,
                     name + ": vertex " + std::to_string(base + v) + " is not a number"};
      part.positions.push_back({p.x, p.y, p.z});
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<std::uint32_t, 3> triangle;
      for (int k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices)
          return Error{ErrorCode::kFormatBroken, name + ": a triangle names a vertex that is not there"};
        triangle[k] = static_cast<std::uint32_t>(base + face.mIndices[k]);
      }
      part.triangles.push_back(triangle);
    }
  }
  if (part.triangles.empty()) return Error{ErrorCode::kNothingUsable, name + ": holds no triangle"};
  part.face_of_triangle.assign(part.triangles.size(), 0);
  return part;
}

}  // namespace

bool LooksLikeStl(Bytes bytes) {
  return LooksLikeAscii(bytes) || BinaryLength(bytes) > 0;
}

Result<Mesh> ReadStl(Bytes bytes, const std::string& name, FileAxes axes, const MeshLoadOptions& options) {
  // Cut what follows the last record: assimp takes a file for binary only if its length is exact.
  const bool ascii = LooksLikeAscii(bytes);
  if (!ascii) bytes = bytes.first(BinaryLength(bytes));
  if (!ascii && bytes.size() == kBinaryHeader)
    return Error{ErrorCode::kNothingUsable, name + ": holds no triangle"};

  Assimp::Importer importer;
  KeepOnlyStl(importer);
  const aiScene* scene = nullptr;
  try {
    scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, "stl");
  } catch (const std::exception& error) {
    return Error{ErrorCode::kFormatBroken, name + ": not a sound STL file: " + error.what()};
  }
  if (scene == nullptr)
    return Error{ErrorCode::kFormatBroken, name + ": not a sound STL file: " + importer.GetErrorString()};

  Result<MeshPart> part = CopyTriangles(*scene, name, options);
  if (!part.ok()) return part.error();
  MakeSmoothNormals(part.value(), options.crease_deg);
  Mesh mesh;
  mesh.parts.push_back(std::move(part).value());
  mesh.nodes.push_back({0, FileToModel(axes), 0});
  return mesh;
}

}  // namespace facetless
