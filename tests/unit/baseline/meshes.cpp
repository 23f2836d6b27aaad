#include "tests/unit/baseline/meshes.h"

#include <cstring>

namespace facetless::testing {

MeshPart BoxMesh(Vec3 size) {
  MeshPart part;
  const double extent[3] = {size.x, size.y, size.z};
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const std::uint32_t base = static_cast<std::uint32_t>(part.positions.size());
      for (int corner = 0; corner < 4; ++corner) {
        std::array<float, 3> p{}, n{};
        p[axis] = static_cast<float>(side * extent[axis]);
        p[u] = static_cast<float>((corner == 1 || corner == 2) * extent[u]);
        p[v] = static_cast<float>((corner >= 2) * extent[v]);
        n[axis] = side == 1 ? 1.0f : -1.0f;
        part.positions.push_back(p);
        part.normals.push_back(n);
      }
      if (side == 1) {
        part.triangles.push_back({base, base + 1, base + 2});
        part.triangles.push_back({base, base + 2, base + 3});
      } else {
        part.triangles.push_back({base, base + 2, base + 1});
        part.triangles.push_back({base, base + 3, base + 2});
      }
      part.face_of_triangle.insert(part.face_of_triangle.end(), 2,
                                   static_cast<std::uint32_t>(2 * axis + side));
    }
  return part;
}

Mesh OneNode(MeshPart part, const Placement& placement) {
  Mesh mesh;
  mesh.parts.push_back(std::move(part));
  mesh.nodes.push_back({0, placement, 0});
  return mesh;
}

Placement Translation(Vec3 by) {
  Placement placement;
  placement.m[0][3] = by.x;
  placement.m[1][3] = by.y;
  placement.m[2][3] = by.z;
  return placement;
}

std::string Glb(const nlohmann::json& json, const std::string& bin) {
  std::string text = json.dump();
  while (text.size() % 4 != 0) text += ' ';
  std::string body = bin;
  while (body.size() % 4 != 0) body += '\0';
  const auto word = [](std::size_t value) {
    const std::uint32_t v = static_cast<std::uint32_t>(value);
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &v, 4);
    return bytes;
  };
  const std::size_t length = 12 + 8 + text.size() + (body.empty() ? 0 : 8 + body.size());
  std::string file = "glTF" + word(2) + word(length) + word(text.size()) + "JSON" + text;
  if (!body.empty()) file += word(body.size()) + std::string("BIN\0", 4) + body;
  return file;
}

TriangleFile::TriangleFile() {
  json = {{"asset", {{"version", "2.0"}}},
          {"scene", 0},
          {"scenes", {{{"nodes", {0}}}}},
          {"nodes", {{{"mesh", 0}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 1}}}, {"indices", 0}}}}}}},
          {"buffers", {{{"byteLength", 44}}}},
          {"bufferViews",
           {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 6}},
            {{"buffer", 0}, {"byteOffset", 8}, {"byteLength", 36}}}},
          {"accessors",
           {{{"bufferView", 0}, {"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}},
            {{"bufferView", 1},
             {"componentType", 5126},
             {"count", 3},
             {"type", "VEC3"},
             {"min", {0, 0, 0}},
             {"max", {1, 1, 0}}}}}};
  const std::uint16_t indices[4] = {0, 1, 2, 0};
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  bin.assign(reinterpret_cast<const char*>(indices), 8);
  bin.append(reinterpret_cast<const char*>(positions), 36);
}

}  // namespace facetless::testing
