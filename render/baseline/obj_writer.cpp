// Writes Wavefront OBJ files and their material files.
#include <map>

#include "render/base/utf8.h"
#include "render/baseline/mesh_encoder.h"
#include "render/baseline/mesh_topology.h"

namespace facetless {
namespace {

// Converts a name to a single word, because names in OBJ end at a space.
std::string Word(const std::string& name, const std::string& otherwise) {
  std::string word = Printable(name);
  for (char& c : word)
    if (c == ' ') c = '_';
  return word.empty() ? otherwise : word;
}

void AppendVector(std::string& text, const char* keyword, Vec3 v) {
  text += keyword;
  for (double coordinate : {v.x, v.y, v.z}) {
    text += ' ';
    AppendNumber(text, coordinate);
  }
  text += '\n';
}

class ObjWriter {
 public:
  ObjWriter(const Model& model, const std::string& material_file) : model_(model) {
    text_ = "# facetless: millimetres, Z up\nmtllib " + Printable(material_file) + "\n";
  }

  void Add(const MeshNode& node, const MeshPart& part) {
    const WeldedPart welded = Weld(part, SolidsOfFaces(node, model_));
    const std::uint32_t instance = model_.InstanceOfPlacedFace(node.first_placed_face);
    text_ += "o " + Word(model_.instances[instance].name, Word(part.name, "part")) + "\n";
    for (const auto& p : welded.positions) AppendVector(text_, "v", node.placement.Point({p[0], p[1], p[2]}));
    for (const auto& n : part.normals)
      AppendVector(text_, "vn", PlacedNormal(node.placement, {n[0], n[1], n[2]}));

    const std::vector<Rgba> colors = PlacedFaceColors(node, model_);
    const bool mirrored = node.placement.Determinant() < 0;
    std::uint32_t face = kNoIndex;
    for (std::size_t t = 0; t < welded.triangles.size(); ++t) {
      const std::uint32_t source = welded.source[t];
      if (part.face_of_triangle[source] != face) {
        face = part.face_of_triangle[source];
        text_ += "g " + Word(model_.PlacedFaceName(node.first_placed_face + face), "face") + "\n";
        text_ += "usemtl " + MaterialName(colors[face]) + "\n";
      }
      text_ += 'f';
      for (int k = 0; k < 3; ++k) {
        const int corner = mirrored ? 2 - k : k;
        // Both indices are counted from 1.
        text_ += ' ' + std::to_string(vertices_ + welded.triangles[t][corner] + 1) + "//" +
                 std::to_string(normals_ + part.triangles[source][corner] + 1);
      }
      text_ += '\n';
    }
    vertices_ += welded.positions.size();
    normals_ += part.normals.size();
  }

  std::string Materials() const {
    std::string text = "# facetless: colours in sRGB\n";
    for (const auto& [color, name] : materials_) {
      text += "newmtl " + name + "\nKd";
      for (int k = 0; k < 3; ++k) {
        text += ' ';
        AppendNumber(text, static_cast<float>(color[k]) / 255);
      }
      text += "\nd ";
      AppendNumber(text, static_cast<float>(color[3]) / 255);
      text += "\nillum 1\n";
    }
    return text;
  }
  std::string Take() && { return std::move(text_); }

 private:
  const std::string& MaterialName(const Rgba& color) {
    return materials_.try_emplace(color, "color_" + HexRgba(color)).first->second;
  }

  const Model& model_;
  std::string text_;
  std::map<Rgba, std::string> materials_;
  std::uint64_t vertices_ = 0, normals_ = 0;  // numbers of vertices and normals of earlier placements
};

}  // namespace

std::vector<MeshOutput> EncodeObj(const Mesh& mesh, const Model& model, const std::string& stem) {
  ObjWriter writer(model, stem + ".mtl");
  for (const MeshNode& node : mesh.nodes)
    if (!mesh.parts[node.part].triangles.empty()) writer.Add(node, mesh.parts[node.part]);
  std::vector<MeshOutput> files;
  files.push_back({".mtl", writer.Materials()});
  files.push_back({"", std::move(writer).Take()});
  return files;
}

}  // namespace facetless
