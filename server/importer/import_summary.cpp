#include "server/importer/import_summary.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// Returns the value of a key; null if there is none.
const Json& Member(const Json& object, const char* key) {
  static const Json none;
  if (!object.is_object()) return none;
  const auto found = object.find(key);
  return found == object.end() ? none : *found;
}

double Number(const Json& value) {
  return value.is_number() ? value.get<double>() : 0;
}

MesherReport ReadMesherReport(const Json& mesh) {
  MesherReport report;
  report.mesh_ms = Number(Member(mesh, "mesh_ms"));
  const Json& bytes = Member(mesh, "peak_bytes");
  if (bytes.is_number_unsigned()) report.peak_bytes = bytes.get<std::uint64_t>();
  const Json& faces = Member(mesh, "faces_unmeshed");
  if (!faces.is_array()) return report;
  for (const Json& face : faces)
    if (face.is_string()) report.faces_unmeshed.push_back(face.get<std::string>());
  return report;
}

}  // namespace

ImportSummary ReadImportSummary(const nlohmann::json& answer, std::size_t meshes) {
  ImportSummary summary;
  summary.meshes.resize(meshes);
  const Json& reports = Member(answer, "meshes");
  if (reports.is_array())
    for (std::size_t i = 0; i < meshes && i < reports.size(); ++i)
      summary.meshes[i] = ReadMesherReport(reports[i]);
  summary.exact_ms = Number(Member(Member(answer, "exact"), "trace_ms"));
  return summary;
}

}  // namespace facetless
