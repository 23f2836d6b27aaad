// Reads glTF 2.0 binary with tinygltf. The library is trusted to parse JSON and to copy chunks. Everything
// that it returns is checked here.
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "render/baseline/mesh_reader.h"
#include "render/baseline/smooth_normals.h"

namespace facetless {
namespace {

// tinygltf processes `extras` and extensions recursively, with a few hundred bytes of stack per level. This
// depth is safe.
constexpr int kMaxJsonDepth = 100;
// A parsed JSON document takes about twenty times the memory of its text.
constexpr std::size_t kMaxJsonBytes = std::size_t{256} << 20;
constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;
// The tolerance of |n|² for a unit normal in float32: three rounded squares, and the rounding of the
// coordinates.
constexpr double kUnitSlack = 8 * 1.2e-7;

std::uint32_t ReadU32(const unsigned char* p) {
  std::uint32_t value = 0;
  std::memcpy(&value, p, 4);
  return value;
}

// The deepest nesting of brackets in a JSON text, outside of strings.
int JsonDepth(Bytes text) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      deepest = std::max(deepest, ++depth);
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return deepest;
}

class GlbReader {
 public:
  GlbReader(std::string name, const MeshLoadOptions& options) : name_(std::move(name)), options_(options) {}

  Result<Mesh> Read(Bytes bytes, FileAxes axes);

 private:
  struct View {  // an accessor's elements, checked to lie within its buffer
    const unsigned char* data = nullptr;
    std::size_t count = 0, stride = 0;
  };

  Error Broken(const std::string& what) const { return {ErrorCode::kFormatBroken, name_ + ": " + what}; }
  Error TooLarge() const {
    return {ErrorCode::kLimitExceeded, name_ + ": the triangles take more memory than " +
                                           std::to_string(options_.max_memory_bytes) + " bytes"};
  }
  // Counts memory of the mesh, and returns whether the limit is kept. Primitives may share data, so a small
  // file can describe a large mesh.
  bool Charge(std::uint64_t bytes) { return (memory_ += bytes) <= options_.max_memory_bytes; }
  Result<void> CheckChunks(Bytes bytes) const;
  Result<void> Parse(Bytes bytes);
  Result<void> CheckExtensions() const;
  void ReadAssetExtras(Mesh& mesh) const;
  Result<View> Elements(int accessor, int type, int component_type, const char* what) const;
  Result<std::vector<std::array<float, 3>>> ReadVectors(int accessor, const char* what) const;
  Result<std::vector<std::uint32_t>> ReadIndices(int accessor) const;
  Result<MeshPart> ReadPart(const tinygltf::Mesh& mesh, bool& faces_named);
  Result<std::uint32_t> AddVertices(const tinygltf::Primitive& primitive, MeshPart& part,
                                    bool& normals_missing);
  Result<void> AddTriangles(const tinygltf::Primitive& primitive, std::uint32_t base, std::uint32_t face,
                            MeshPart& part);
  Result<Placement> LocalPlacement(const tinygltf::Node& node) const;
  Result<void> ReadNodes(const Placement& root, Mesh& mesh);

  const std::string name_;
  const MeshLoadOptions& options_;
  tinygltf::Model gltf_;
  std::map<std::pair<int, int>, std::uint32_t>
      vertex_blocks_;         // (position, normal accessors) → first vertex in the part
  std::uint64_t memory_ = 0;  // memory of the mesh so far, bytes
};

Result<void> GlbReader::CheckChunks(Bytes bytes) const {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
    return Error{ErrorCode::kLimitExceeded,
                 name_ + ": the file is larger than 4 GB, the limit of glTF binary"};
  if (bytes.size() < kGlbHeader + kChunkHeader)
    return Broken("the glTF header is incomplete; the file was cut short");
  if (ReadU32(&bytes[4]) != 2)
    return Broken("glTF version " + std::to_string(ReadU32(&bytes[4])) +
                  " is not supported; only version 2 is");
  if (ReadU32(&bytes[8]) > bytes.size())
    return Broken("the file is smaller than its header says; it was cut short");
  const std::size_t json = ReadU32(&bytes[kGlbHeader]);
  if (json > bytes.size() - kGlbHeader - kChunkHeader)
    return Broken("the JSON chunk reaches beyond the file");
  if (json > kMaxJsonBytes)
    return Error{ErrorCode::kLimitExceeded,
                 name_ + ": its JSON is larger than " + std::to_string(kMaxJsonBytes) + " bytes"};
  if (JsonDepth(bytes.subspan(kGlbHeader + kChunkHeader, json)) > kMaxJsonDepth)
    return Error{ErrorCode::kLimitExceeded,
                 name_ + ": its JSON is nested deeper than " + std::to_string(kMaxJsonDepth) + " levels"};
  return {};
}

Result<void> GlbReader::Parse(Bytes bytes) {
  tinygltf::TinyGLTF loader;
  // Do not load images, and do not read other files.
  loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int,
                           const unsigned char*, int, void*) { return true; },
                        nullptr);
  tinygltf::FsCallbacks files;
  files.FileExists = [](const std::string&, void*) { return false; };
  files.ExpandFilePath = [](const std::string& path, void*) { return path; };
  files.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) {
    return false;
  };
  files.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  files.user_data = nullptr;
  loader.SetFsCallbacks(files);
  std::string problem, warning;
  try {
    if (!loader.LoadBinaryFromMemory(&gltf_, &problem, &warning, bytes.data(),
                                     static_cast<unsigned>(bytes.size())))
      return Broken("invalid glTF: " + (problem.empty() ? std::string("no reason given") : problem));
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimitExceeded, name_ + ": too large for this machine's memory"};
  } catch (const std::exception& error) {
    return Broken(std::string("invalid glTF: ") + error.what());
  }
  return {};
}

Result<void> GlbReader::CheckExtensions() const {
  // Extensions that change positions or primitives are refused. Extensions that only change materials, lights
  // or images can be ignored.
  static const std::set<std::string> harmless = {
      "KHR_materials_unlit",        "KHR_texture_transform", "KHR_lights_punctual",
      "KHR_materials_variants",     "KHR_texture_basisu",    "EXT_texture_webp",
      "KHR_materials_transmission", "KHR_materials_volume",  "KHR_materials_pbrSpecularGlossiness",
      "KHR_materials_clearcoat",    "KHR_materials_sheen",   "KHR_materials_ior",
      "KHR_materials_specular",     "KHR_xmp_json_ld",       "KHR_materials_emissive_strength"};
  for (const std::string& extension : gltf_.extensionsRequired)
    if (!harmless.contains(extension))
      return Broken("requires the glTF extension " + extension + ", which is not read; export without it");
  return {};
}

double NumberOr(const tinygltf::Value& object, const char* key, double otherwise) {
  const tinygltf::Value& value = object.Get(key);
  return value.IsNumber() && std::isfinite(value.GetNumberAsDouble()) ? value.GetNumberAsDouble() : otherwise;
}

std::optional<std::uint32_t> IndexIn(const tinygltf::Value& extras, const char* key) {
  if (!extras.IsObject() || !extras.Get(key).IsNumber()) return std::nullopt;
  const double number = extras.Get(key).GetNumberAsDouble();
  if (!(number >= 0 && number < kNoIndex) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}

void GlbReader::ReadAssetExtras(Mesh& mesh) const {
  const tinygltf::Value& extras = gltf_.asset.extras;
  if (!extras.IsObject()) return;
  mesh.from_model = extras.Get("from_model").IsBool() && extras.Get("from_model").Get<bool>();
  mesh.deflection_mm = NumberOr(extras, "deflection_mm", 0);
  mesh.angular_deg = NumberOr(extras, "angular_deg", 0);
  mesh.mesh_ms = NumberOr(extras, "mesh_ms", 0);
  const tinygltf::Value& unmeshed = extras.Get("faces_unmeshed");
  for (std::size_t i = 0; unmeshed.IsArray() && i < unmeshed.ArrayLen(); ++i)
    if (unmeshed.Get(static_cast<int>(i)).IsString())
      mesh.faces_unmeshed.push_back(unmeshed.Get(static_cast<int>(i)).Get<std::string>());
}

Result<GlbReader::View> GlbReader::Elements(int index, int type, int component_type, const char* what) const {
  const std::string where = std::string(what) + " accessor " + std::to_string(index);
  if (index < 0 || static_cast<std::size_t>(index) >= gltf_.accessors.size())
    return Broken(where + " does not exist");
  const tinygltf::Accessor& accessor = gltf_.accessors[index];
  if (accessor.sparse.isSparse) return Broken(where + " is sparse, which is not read; export without it");
  if (accessor.type != type || accessor.componentType != component_type)
    return Broken(where + " has a type that is not read (quantised?)");
  if (accessor.bufferView < 0 || static_cast<std::size_t>(accessor.bufferView) >= gltf_.bufferViews.size())
    return Broken(where + " has no data (compressed?)");
  const tinygltf::BufferView& view = gltf_.bufferViews[accessor.bufferView];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= gltf_.buffers.size())
    return Broken(where + " lies in a buffer that does not exist");
  const std::vector<unsigned char>& buffer = gltf_.buffers[view.buffer].data;

  // Check everything in a form that cannot overflow, by the number of bytes that remain after each step.
  const std::size_t element = static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(component_type)) *
                              static_cast<std::size_t>(tinygltf::GetNumComponentsInType(type));
  const std::size_t stride = view.byteStride == 0 ? element : view.byteStride;
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset ||
      accessor.byteOffset > view.byteLength || stride < element)
    return Broken(where + " reaches beyond its buffer");
  const std::size_t room = view.byteLength - accessor.byteOffset;
  if (accessor.count > 0 && (room < element || (accessor.count - 1) > (room - element) / stride))
    return Broken(where + " reaches beyond its buffer");
  return View{buffer.data() + view.byteOffset + accessor.byteOffset, accessor.count, stride};
}

Result<std::vector<std::array<float, 3>>> GlbReader::ReadVectors(int accessor, const char* what) const {
  const Result<View> view = Elements(accessor, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, what);
  if (!view.ok()) return view.error();
  std::vector<std::array<float, 3>> vectors(view.value().count);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    std::memcpy(vectors[i].data(), view.value().data + i * view.value().stride, sizeof vectors[i]);
    for (float coordinate : vectors[i])
      if (!std::isfinite(coordinate))
        return Error{ErrorCode::kNotFinite, name_ + ": element " + std::to_string(i) + " of " + what +
                                                " accessor " + std::to_string(accessor) + " is not a number"};
  }
  return vectors;
}

Result<std::vector<std::uint32_t>> GlbReader::ReadIndices(int index) const {
  if (index < 0 || static_cast<std::size_t>(index) >= gltf_.accessors.size())
    return Broken("index accessor " + std::to_string(index) + " does not exist");
  const int component_type = gltf_.accessors[index].componentType;
  if (component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    return Broken("index accessor " + std::to_string(index) + " has a type that glTF does not allow");
  const Result<View> view = Elements(index, TINYGLTF_TYPE_SCALAR, component_type, "index");
  if (!view.ok()) return view.error();
  std::vector<std::uint32_t> indices(view.value().count, 0);
  const std::size_t bytes = static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(component_type));
  for (std::size_t i = 0; i < indices.size(); ++i)
    std::memcpy(&indices[i], view.value().data + i * view.value().stride,
                bytes);  // little-endian, as glTF is
  return indices;
}

// Appends the vertices of the primitive, unless another primitive of the part has added the same ones.
// Returns the index of the first vertex.
Result<std::uint32_t> GlbReader::AddVertices(const tinygltf::Primitive& primitive, MeshPart& part,
                                             bool& normals_missing) {
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end()) return Broken("a primitive has no positions (compressed?)");
  const auto normal = primitive.attributes.find("NORMAL");
  const int normal_accessor = normal == primitive.attributes.end() ? -1 : normal->second;
  const auto [block, fresh] = vertex_blocks_.try_emplace({position->second, normal_accessor},
                                                         static_cast<std::uint32_t>(part.positions.size()));
  if (!fresh) return block->second;

  Result<std::vector<std::array<float, 3>>> positions = ReadVectors(position->second, "position");
  if (!positions.ok()) return positions.error();
  const std::size_t count = positions.value().size();
  if (part.positions.size() + count >= kNoIndex || !Charge(count * kVertexBytes)) return TooLarge();
  part.positions.insert(part.positions.end(), positions.value().begin(), positions.value().end());
  if (normal_accessor < 0) {
    normals_missing = true;
    part.normals.resize(part.positions.size(), {0, 0, 0});
    return block->second;
  }
  Result<std::vector<std::array<float, 3>>> normals = ReadVectors(normal_accessor, "normal");
  if (!normals.ok()) return normals.error();
  if (normals.value().size() != count) return Broken("a primitive has as many normals as positions, or none");
  for (std::array<float, 3>& n : normals.value()) {
    const Vec3 raw{n[0], n[1], n[2]};
    if (std::fabs(Dot(raw, raw) - 1) <= kUnitSlack) continue;
    const Vec3 unit = Normalized(raw);
    n = {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z)};
  }
  part.normals.insert(part.normals.end(), normals.value().begin(), normals.value().end());
  return block->second;
}

Result<void> GlbReader::AddTriangles(const tinygltf::Primitive& primitive, std::uint32_t base,
                                     std::uint32_t face, MeshPart& part) {
  // The primitive may refer only to the vertices of its own accessor.
  const std::size_t vertices = gltf_.accessors[primitive.attributes.at("POSITION")].count;
  std::vector<std::uint32_t> indices;
  if (primitive.indices >= 0) {
    Result<std::vector<std::uint32_t>> read = ReadIndices(primitive.indices);
    if (!read.ok()) return read.error();
    indices = std::move(read).value();
  } else {
    indices.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i) indices[i] = static_cast<std::uint32_t>(i);
  }
  for (std::uint32_t index : indices)
    if (index >= vertices)
      return Broken("a triangle names vertex " + std::to_string(index) + " of " + std::to_string(vertices));

  // Convert lists, strips (in which every second triangle is reversed) and fans.
  const bool list = primitive.mode == TINYGLTF_MODE_TRIANGLES,
             strip = primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP;
  const std::size_t count = list ? indices.size() / 3 : indices.size() < 3 ? 0 : indices.size() - 2;
  if (!Charge(count * kTriangleBytes)) return TooLarge();
  for (std::size_t t = 0; t < count; ++t) {
    std::array<std::size_t, 3> corner = {3 * t, 3 * t + 1, 3 * t + 2};
    if (strip) corner = {t, t + 1 + t % 2, t + 2 - t % 2};
    if (!list && !strip) corner = {t + 1, t + 2, 0};
    part.triangles.push_back(
        {base + indices[corner[0]], base + indices[corner[1]], base + indices[corner[2]]});
  }
  part.face_of_triangle.resize(part.triangles.size(), face);
  return {};
}

Result<MeshPart> GlbReader::ReadPart(const tinygltf::Mesh& mesh, bool& faces_named) {
  MeshPart part;
  part.name = mesh.name;
  vertex_blocks_.clear();
  bool normals_missing = false;
  for (const tinygltf::Primitive& primitive : mesh.primitives) {
    // Skip points and lines.
    if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
        primitive.mode != TINYGLTF_MODE_TRIANGLE_FAN)
      continue;
    const std::optional<std::uint32_t> face = IndexIn(primitive.extras, "face");
    faces_named = faces_named && face.has_value();
    const Result<std::uint32_t> base = AddVertices(primitive, part, normals_missing);
    if (!base.ok()) return base.error();
    const Result<void> added = AddTriangles(primitive, base.value(), face.value_or(0), part);
    if (!added.ok()) return added.error();
  }
  if (normals_missing) MakeSmoothNormals(part, options_.crease_deg);
  return part;
}

Result<Placement> GlbReader::LocalPlacement(const tinygltf::Node& node) const {
  Placement local;
  if (!node.matrix.empty()) {
    // The matrix is column-major. Its last row must be (0, 0, 0, 1).
    const std::vector<double>& m = node.matrix;
    if (m.size() != 16 || m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      return Broken("node '" + node.name + "' has a matrix that is no placement");
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) local.m[row][column] = m[4 * column + row];
  } else {
    // Scale, rotate and then translate. The quaternion is (x, y, z, w) and may not be exactly normalised.
    const Vec3 t = node.translation.size() == 3
                       ? Vec3{node.translation[0], node.translation[1], node.translation[2]}
                       : Vec3{};
    const Vec3 s = node.scale.size() == 3 ? Vec3{node.scale[0], node.scale[1], node.scale[2]} : Vec3{1, 1, 1};
    double x = 0, y = 0, z = 0, w = 1;
    if (node.rotation.size() == 4) {
      const std::vector<double>& q = node.rotation;
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      if (!(length > 0)) return Broken("node '" + node.name + "' has a rotation of length zero");
      x = q[0] / length;
      y = q[1] / length;
      z = q[2] / length;
      w = q[3] / length;
    }
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                            {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                            {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    const double scale[3] = {s.x, s.y, s.z}, move[3] = {t.x, t.y, t.z};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) local.m[row][column] = r[row][column] * scale[column];
      local.m[row][3] = move[row];
    }
  }
  return local;
}

Result<void> GlbReader::ReadNodes(const Placement& root, Mesh& mesh) {
  // Start from the default scene, or else from the first scene, or else from all nodes without a parent.
  std::vector<int> roots;
  if (!gltf_.scenes.empty()) {
    const std::size_t scene = gltf_.defaultScene < 0 ? 0 : static_cast<std::size_t>(gltf_.defaultScene);
    if (scene >= gltf_.scenes.size()) return Broken("the default scene does not exist");
    roots = gltf_.scenes[scene].nodes;
  } else {
    std::vector<bool> held(gltf_.nodes.size(), false);
    for (const tinygltf::Node& node : gltf_.nodes)
      for (int child : node.children)
        if (child >= 0 && static_cast<std::size_t>(child) < held.size()) held[child] = true;
    for (std::size_t i = 0; i < held.size(); ++i)
      if (!held[i]) roots.push_back(static_cast<int>(i));
  }

  // Walk the tree in the order of the file, parents first.
  struct Visit {
    int node;
    Placement parent;
  };
  std::vector<Visit> stack;
  for (std::size_t i = roots.size(); i-- > 0;) stack.push_back({roots[i], root});
  std::vector<bool> seen(gltf_.nodes.size(), false);
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    if (visit.node < 0 || static_cast<std::size_t>(visit.node) >= gltf_.nodes.size())
      return Broken("node " + std::to_string(visit.node) + " does not exist");
    if (seen[visit.node])
      return Broken("node " + std::to_string(visit.node) + " has two parents, or holds itself");
    seen[visit.node] = true;
    const tinygltf::Node& node = gltf_.nodes[visit.node];
    const Result<Placement> local = LocalPlacement(node);
    if (!local.ok()) return local.error();
    const Placement placed = Compose(visit.parent, local.value());
    for (const auto& row : placed.m)
      for (double entry : row)
        if (!std::isfinite(entry))
          return Error{ErrorCode::kNotFinite,
                       name_ + ": the placement of node '" + node.name + "' is not a number"};
    if (node.mesh >= 0) {
      if (static_cast<std::size_t>(node.mesh) >= mesh.parts.size())
        return Broken("node '" + node.name + "' places a mesh that does not exist");
      if (mesh.nodes.size() >= options_.max_nodes)
        return Error{ErrorCode::kLimitExceeded,
                     name_ + ": more than " + std::to_string(options_.max_nodes) + " nodes"};
      const std::optional<std::uint32_t> first = IndexIn(node.extras, "first_placed_face");
      mesh.from_model = mesh.from_model && first.has_value();
      if (placed.Determinant() != 0)
        mesh.nodes.push_back({static_cast<std::uint32_t>(node.mesh), placed, first.value_or(0)});
    }
    for (std::size_t i = node.children.size(); i-- > 0;) stack.push_back({node.children[i], placed});
  }
  return {};
}

Result<Mesh> GlbReader::Read(Bytes bytes, FileAxes axes) {
  if (Result<void> sound = CheckChunks(bytes); !sound.ok()) return sound.error();
  if (Result<void> parsed = Parse(bytes); !parsed.ok()) return parsed.error();
  if (Result<void> known = CheckExtensions(); !known.ok()) return known.error();

  Mesh mesh;
  ReadAssetExtras(mesh);
  bool faces_named = true;
  for (const tinygltf::Mesh& source : gltf_.meshes) {
    Result<MeshPart> part = ReadPart(source, faces_named);
    if (!part.ok()) return part.error();
    mesh.parts.push_back(std::move(part).value());
  }
  mesh.from_model = mesh.from_model && faces_named;
  if (Result<void> placed = ReadNodes(FileToModel(axes), mesh); !placed.ok()) return placed.error();
  if (PlacedTriangleCount(mesh) == 0)
    return Error{ErrorCode::kNothingUsable, name_ + ": the mesh has no visible triangle"};
  // A mesh without face ids counts as a single face.
  if (!mesh.from_model) {
    for (MeshPart& part : mesh.parts) part.face_of_triangle.assign(part.triangles.size(), 0);
    for (MeshNode& node : mesh.nodes) node.first_placed_face = 0;
  }
  return mesh;
}

}  // namespace

bool LooksLikeGlb(Bytes bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

Result<Mesh> ReadGlb(Bytes bytes, const std::string& name, FileAxes axes, const MeshLoadOptions& options) {
  return GlbReader(name, options).Read(bytes, axes);
}

}  // namespace facetless
