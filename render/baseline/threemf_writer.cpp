// Writes 3MF (core specification 1.3), which is a zip archive of XML files.
#include <zip.h>

#include <map>
#include <memory>
#include <string_view>
#include <tuple>

#include "render/base/utf8.h"
#include "render/base/xml.h"
#include "render/baseline/mesh_encoder.h"
#include "render/baseline/mesh_topology.h"

namespace facetless {
namespace {

constexpr const char* kContentTypes =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
)";
constexpr const char* kRelationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";
// All dates in the archive are the earliest that zip can represent, so that the same mesh gives the same
// bytes.
constexpr std::uint16_t kDosDate = 1 << 5 | 1, kDosTime = 0;  // 1 January 1980, midnight
constexpr std::uint32_t kMaterials = 1;  // the resource id of the list of colours; objects follow

std::string Attribute(const std::string& text) {
  return EscapedXml(Printable(text));
}

class ModelWriter {
 public:
  explicit ModelWriter(const Model& model) : model_(model) {}

  void Add(const MeshNode& node, const MeshPart& part) {
    // Placements of one part with the same colours share an object. 3MF does not allow mirroring placements,
    // so mirrored placements share a separate, mirrored object.
    std::vector<Rgba> colors = PlacedFaceColors(node, model_);
    const bool mirrored = node.placement.Determinant() < 0;
    const auto [object, fresh] =
        objects_.try_emplace({node.part, mirrored, std::move(colors)},
                             kMaterials + 1 + static_cast<std::uint32_t>(objects_.size()));
    if (fresh)
      AddObject(object->second, part, Weld(part, SolidsOfFaces(node, model_)), std::get<2>(object->first),
                mirrored);
    AddItem(object->second, node.placement, mirrored,
            model_.instances[model_.InstanceOfPlacedFace(node.first_placed_face)].name);
  }

  std::string Text() const {
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
        "<metadata name=\"Title\">";
    text += Attribute(model_.info.file) +
            "</metadata>\n<metadata name=\"Application\">facetless</metadata>\n<resources>\n";
    text += "<basematerials id=\"" + std::to_string(kMaterials) + "\">\n";
    for (const Rgba& color : palette_)
      text += "<base name=\"color_" + HexRgba(color) + "\" displaycolor=\"#" + HexRgba(color) + "\"/>\n";
    text += "</basematerials>\n" + resources_ + "</resources>\n<build>\n" + items_ + "</build>\n</model>\n";
    return text;
  }

 private:
  void AddObject(std::uint32_t id, const MeshPart& part, const WeldedPart& welded,
                 const std::vector<Rgba>& colors, bool mirrored) {
    resources_ += "<object id=\"" + std::to_string(id) + "\" type=\"model\" pid=\"" +
                  std::to_string(kMaterials) + "\" pindex=\"" +
                  std::to_string(ColorIndex(
                      colors[part.face_of_triangle[welded.source.empty() ? 0 : welded.source[0]]])) +
                  "\" name=\"" + Attribute(part.name) + "\"><mesh><vertices>\n";
    for (const auto& p : welded.positions) {
      // Mirror the object in x; its placement is mirrored in x, too.
      const char* axis[3] = {"<vertex x=\"", "\" y=\"", "\" z=\""};
      for (int k = 0; k < 3; ++k) {
        resources_ += axis[k];
        AppendNumber(resources_, mirrored && k == 0 ? -p[0] : p[k]);
      }
      resources_ += "\"/>\n";
    }
    resources_ += "</vertices><triangles>\n";
    for (std::size_t t = 0; t < welded.triangles.size(); ++t) {
      const auto& triangle = welded.triangles[t];
      const char* corner[3] = {"<triangle v1=\"", "\" v2=\"", "\" v3=\""};
      for (int k = 0; k < 3; ++k) resources_ += corner[k] + std::to_string(triangle[mirrored ? 2 - k : k]);
      const std::uint32_t color = ColorIndex(colors[part.face_of_triangle[welded.source[t]]]);
      resources_ += "\" pid=\"" + std::to_string(kMaterials) + "\" p1=\"" + std::to_string(color) + "\"/>\n";
    }
    resources_ += "</triangles></mesh></object>\n";
  }

  // Adds a build item. A 3MF matrix multiplies row vectors from the right, so the columns of the placement
  // are written one after another.
  void AddItem(std::uint32_t object, const Placement& placement, bool mirrored, const std::string& name) {
    items_ += "<item objectid=\"" + std::to_string(object) + "\" transform=\"";
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row) {
        if (column + row > 0) items_ += ' ';
        AppendNumber(items_, mirrored && column == 0 ? -placement.m[row][0] : placement.m[row][column]);
      }
    items_ += "\"";
    if (!name.empty()) items_ += " partnumber=\"" + Attribute(name) + "\"";
    items_ += "/>\n";
  }

  std::uint32_t ColorIndex(const Rgba& color) {
    const auto [place, fresh] = color_index_.try_emplace(color, static_cast<std::uint32_t>(palette_.size()));
    if (fresh) palette_.push_back(color);
    return place->second;
  }

  const Model& model_;
  std::map<std::tuple<std::uint32_t, bool, std::vector<Rgba>>, std::uint32_t> objects_;
  std::map<Rgba, std::uint32_t> color_index_;
  std::vector<Rgba> palette_;
  std::string resources_, items_;
};

struct SourceRelease {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};

// The error for any failure of the in-memory archive, which can only be lack of memory.
Error NoMemory() {
  return {ErrorCode::kLimitExceeded, "the 3MF archive is too large for this machine's memory"};
}

struct Entry {
  const char* name;
  std::string_view text;
};

// Makes a deflated archive of `entries`, in their order.
Result<std::string> Zip(std::initializer_list<Entry> entries) {
  // The buffer must outlive the archive, so each holds a reference.
  const std::unique_ptr<zip_source_t, SourceRelease> buffer(zip_source_buffer_create(nullptr, 0, 0, nullptr));
  if (!buffer) return NoMemory();
  zip_source_keep(buffer.get());
  zip_t* archive = zip_open_from_source(buffer.get(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  if (archive == nullptr) {
    zip_source_free(buffer.get());
    return NoMemory();
  }
  for (const Entry& entry : entries) {
    zip_source_t* content = zip_source_buffer(archive, entry.text.data(), entry.text.size(), 0);
    const zip_int64_t index =
        content == nullptr ? -1 : zip_file_add(archive, entry.name, content, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      if (content != nullptr) zip_source_free(content);
      zip_discard(archive);
      return NoMemory();
    }
    zip_file_set_dostime(archive, static_cast<zip_uint64_t>(index), kDosTime, kDosDate, 0);
  }
  if (zip_close(archive) != 0) {
    zip_discard(archive);
    return NoMemory();
  }
  zip_stat_t size;
  if (zip_source_stat(buffer.get(), &size) != 0 || zip_source_open(buffer.get()) != 0) return NoMemory();
  std::string bytes(size.size, '\0');
  const zip_int64_t read = zip_source_read(buffer.get(), bytes.data(), bytes.size());
  zip_source_close(buffer.get());
  if (read < 0 || static_cast<std::size_t>(read) != bytes.size()) return NoMemory();
  return bytes;
}

}  // namespace

Result<std::string> Encode3mf(const Mesh& mesh, const Model& model) {
  ModelWriter writer(model);
  for (const MeshNode& node : mesh.nodes)
    if (!mesh.parts[node.part].triangles.empty()) writer.Add(node, mesh.parts[node.part]);
  const std::string text = writer.Text();
  return Zip(
      {{"[Content_Types].xml", kContentTypes}, {"_rels/.rels", kRelationships}, {"3D/3dmodel.model", text}});
}

}  // namespace facetless
