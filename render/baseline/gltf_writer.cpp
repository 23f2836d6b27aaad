// Writes glTF 2.0 binary with tinygltf, in the layout of the importer's files. There is a node for each
// placement, below a root node that converts millimetres with Z up to metres with Y up. There is a mesh for
// each part, and a primitive for each of its faces, with the index of the face in `extras`.
#include <tiny_gltf.h>

#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "render/base/utf8.h"
#include "render/baseline/mesh_encoder.h"

namespace facetless {
namespace {

// glTF binary stores the length of a file in 32 bits.
constexpr std::uint64_t kMaxBytes = std::uint64_t{0xffffffff};
// All materials look like plastic, neither metallic nor mirror-like.
constexpr double kRoughness = 0.6;

// Converts an sRGB byte to linear light, because colour factors in glTF are linear.
double Linear(std::uint8_t byte) {
  const double x = byte / 255.0;
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

class GlbWriter {
 public:
  GlbWriter(const Mesh& mesh, const Model& model) : mesh_(mesh), model_(model) {
    gltf_.asset.version = "2.0";
    gltf_.asset.generator = "facetless";
    gltf_.bufferViews.resize(2);
    gltf_.nodes.emplace_back();
  }

  Result<std::string> Write() {
    faces_of_part_.resize(mesh_.parts.size());
    for (const MeshNode& node : mesh_.nodes)
      if (!mesh_.parts[node.part].triangles.empty()) AddNode(node);
    FinishRoot();
    FinishAsset();
    if (vectors_.size() + indices_.size() > kMaxBytes)
      return Error{ErrorCode::kLimitExceeded,
                   "a glTF binary file holds at most 4 GB, and the mesh is larger"};
    JoinBuffers();
    std::ostringstream stream;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&gltf_, stream, false, true))
      return Error{ErrorCode::kInternal, "the mesh cannot be written as glTF"};
    std::string bytes = std::move(stream).str();
    if (bytes.size() > kMaxBytes)
      return Error{ErrorCode::kLimitExceeded,
                   "a glTF binary file holds at most 4 GB, and the mesh is larger"};
    return bytes;
  }

 private:
  // The accessors of a face, shared by all placements whatever their colours.
  struct FaceData {
    std::uint32_t face = 0;
    int positions = 0, normals = 0, indices = 0;
  };

  void AddNode(const MeshNode& node) {
    std::vector<Rgba> colors = PlacedFaceColors(node, model_);
    const auto [mesh, fresh] =
        meshes_.try_emplace({node.part, std::move(colors)}, static_cast<int>(gltf_.meshes.size()));
    if (fresh) AddMesh(node.part, mesh->first.second);
    tinygltf::Node placed;
    placed.name = Printable(model_.instances[model_.InstanceOfPlacedFace(node.first_placed_face)].name);
    placed.mesh = mesh->second;
    const auto& m = node.placement.m;
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) placed.matrix.push_back(m[row][column]);
      placed.matrix.push_back(column == 3 ? 1 : 0);
    }
    placed.extras = tinygltf::Value(
        {{"first_placed_face", tinygltf::Value(static_cast<double>(node.first_placed_face))}});
    gltf_.nodes.front().children.push_back(static_cast<int>(gltf_.nodes.size()));
    gltf_.nodes.push_back(std::move(placed));
  }

  void AddMesh(std::uint32_t part, const std::vector<Rgba>& colors) {
    std::vector<FaceData>& faces = faces_of_part_[part];
    if (faces.empty()) faces = AddFaces(mesh_.parts[part]);
    tinygltf::Mesh mesh;
    mesh.name = Printable(mesh_.parts[part].name);
    for (const FaceData& face : faces) {
      tinygltf::Primitive primitive;
      primitive.mode = TINYGLTF_MODE_TRIANGLES;
      primitive.attributes["POSITION"] = face.positions;
      primitive.attributes["NORMAL"] = face.normals;
      primitive.indices = face.indices;
      primitive.material = MaterialIndex(colors[face.face]);
      primitive.extras = tinygltf::Value({{"face", tinygltf::Value(static_cast<int>(face.face))}});
      mesh.primitives.push_back(std::move(primitive));
    }
    gltf_.meshes.push_back(std::move(mesh));
  }

  // Triangles of a part are grouped by face (mesh.h, law 2).
  std::vector<FaceData> AddFaces(const MeshPart& part) {
    std::vector<FaceData> faces;
    std::vector<std::uint32_t> place(part.positions.size(), kNoIndex);
    for (std::size_t begin = 0, end = 0; begin < part.triangles.size(); begin = end) {
      const std::uint32_t face = part.face_of_triangle[begin];
      while (end < part.triangles.size() && part.face_of_triangle[end] == face) ++end;
      // Collect the vertices of the face, in the order of its triangles.
      std::vector<std::uint32_t> vertices, corners;
      for (std::size_t t = begin; t < end; ++t)
        for (std::uint32_t vertex : part.triangles[t]) {
          if (place[vertex] == kNoIndex) {
            place[vertex] = static_cast<std::uint32_t>(vertices.size());
            vertices.push_back(vertex);
          }
          corners.push_back(place[vertex]);
        }
      FaceData data;
      data.face = face;
      data.positions = AddVectors(part.positions, vertices, true);
      data.normals = AddVectors(part.normals, vertices, false);
      data.indices = AddIndices(corners);
      faces.push_back(data);
      for (std::uint32_t vertex : vertices) place[vertex] = kNoIndex;
    }
    return faces;
  }

  int AddVectors(const std::vector<std::array<float, 3>>& all, const std::vector<std::uint32_t>& chosen,
                 bool bounded) {
    tinygltf::Accessor accessor;
    accessor.bufferView = 0;
    accessor.byteOffset = vectors_.size();
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.count = chosen.size();
    accessor.type = TINYGLTF_TYPE_VEC3;
    std::array<float, 3> low = all[chosen.front()], high = low;
    for (std::uint32_t vertex : chosen) {
      const auto* bytes = reinterpret_cast<const unsigned char*>(all[vertex].data());
      vectors_.insert(vectors_.end(), bytes, bytes + sizeof all[vertex]);
      for (int k = 0; k < 3; ++k) {
        low[k] = std::fmin(low[k], all[vertex][k]);
        high[k] = std::fmax(high[k], all[vertex][k]);
      }
    }
    if (bounded) {
      accessor.minValues.assign(low.begin(), low.end());
      accessor.maxValues.assign(high.begin(), high.end());
    }
    gltf_.accessors.push_back(std::move(accessor));
    return static_cast<int>(gltf_.accessors.size()) - 1;
  }

  int AddIndices(const std::vector<std::uint32_t>& corners) {
    tinygltf::Accessor accessor;
    accessor.bufferView = 1;
    accessor.byteOffset = indices_.size();
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.count = corners.size();
    accessor.type = TINYGLTF_TYPE_SCALAR;
    const auto* bytes = reinterpret_cast<const unsigned char*>(corners.data());
    indices_.insert(indices_.end(), bytes, bytes + sizeof(std::uint32_t) * corners.size());
    gltf_.accessors.push_back(std::move(accessor));
    return static_cast<int>(gltf_.accessors.size()) - 1;
  }

  int MaterialIndex(const Rgba& color) {
    const auto [place, fresh] = materials_.try_emplace(color, static_cast<int>(gltf_.materials.size()));
    if (fresh) {
      tinygltf::Material material;
      material.name = "color_" + HexRgba(color);
      material.pbrMetallicRoughness.baseColorFactor = {Linear(color[0]), Linear(color[1]), Linear(color[2]),
                                                       color[3] / 255.0};
      if (color[3] < 255) material.alphaMode = "BLEND";
      material.pbrMetallicRoughness.metallicFactor = 0;
      material.pbrMetallicRoughness.roughnessFactor = kRoughness;
      // Open shells are visible from both sides.
      material.doubleSided = true;
      gltf_.materials.push_back(std::move(material));
    }
    return place->second;
  }

  // Sets the column-major matrix of the root, which converts millimetres with Z up to metres with Y up: (x,
  // y, z) -> (x, z, -y) / 1000.
  void FinishRoot() {
    tinygltf::Node& root = gltf_.nodes.front();
    root.name = Printable(model_.info.file);
    root.matrix = {1e-3, 0, 0, 0, 0, 0, -1e-3, 0, 0, 1e-3, 0, 0, 0, 0, 0, 1};
    tinygltf::Scene scene;
    scene.nodes.push_back(0);
    gltf_.scenes.push_back(std::move(scene));
    gltf_.defaultScene = 0;
  }

  void FinishAsset() {
    tinygltf::Value::Array unmeshed;
    for (const std::string& name : mesh_.faces_unmeshed) unmeshed.emplace_back(Printable(name));
    gltf_.asset.extras = tinygltf::Value({{"deflection_mm", tinygltf::Value(mesh_.deflection_mm)},
                                          {"angular_deg", tinygltf::Value(mesh_.angular_deg)},
                                          {"mesh_ms", tinygltf::Value(mesh_.mesh_ms)},
                                          {"faces_unmeshed", tinygltf::Value(unmeshed)},
                                          {"from_model", tinygltf::Value(true)}});
  }

  // Makes one buffer with two views, for positions and normals and for indices. There is none without
  // triangles.
  void JoinBuffers() {
    if (indices_.empty()) {
      gltf_.bufferViews.clear();
      return;
    }
    gltf_.bufferViews[0].buffer = gltf_.bufferViews[1].buffer = 0;
    gltf_.bufferViews[0].byteLength = vectors_.size();
    gltf_.bufferViews[0].byteStride = 3 * sizeof(float);
    gltf_.bufferViews[0].target = TINYGLTF_TARGET_ARRAY_BUFFER;
    gltf_.bufferViews[1].byteOffset = vectors_.size();
    gltf_.bufferViews[1].byteLength = indices_.size();
    gltf_.bufferViews[1].target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
    gltf_.buffers.resize(1);
    vectors_.insert(vectors_.end(), indices_.begin(), indices_.end());
    gltf_.buffers[0].data = std::move(vectors_);
  }

  const Mesh& mesh_;
  const Model& model_;
  tinygltf::Model gltf_;
  std::vector<unsigned char> vectors_, indices_;
  std::vector<std::vector<FaceData>> faces_of_part_;
  std::map<std::pair<std::uint32_t, std::vector<Rgba>>, int> meshes_;
  std::map<Rgba, int> materials_;
};

}  // namespace

Result<std::string> EncodeGlb(const Mesh& mesh, const Model& model) {
  return GlbWriter(mesh, model).Write();
}

}  // namespace facetless
