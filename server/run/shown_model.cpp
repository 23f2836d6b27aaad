#include "server/run/shown_model.h"

#include <memory>
#include <utility>

namespace facetless {
namespace {

using Json = nlohmann::json;

// The number of hidden occurrences that the report lists by name.
constexpr std::size_t kMostListed = 100;

Json ArrangementJson(const Model& model, const ArrangementRequest& request, const Arrangement& arrangement) {
  Json names = Json::array();
  std::uint64_t count = 0, faces = 0, hidden = 0;
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    if (next < arrangement.shown.size() && arrangement.shown[next] == i) {
      ++next;
      continue;
    }
    ++count;
    hidden += model.instances[i].hidden;
    faces += model.parts[model.instances[i].part].faces.count;
    if (names.size() < kMostListed) names.push_back(OccurrenceName(model, i));
  }
  return {
      {"parts", request.parts},
      {"hide", request.hide},
      {"explode", request.explode},
      {"shown", arrangement.shown.size()},
      {"show_hidden", request.show_hidden},
      {"left_out",
       {{"placements", count}, {"hidden_by_file", hidden}, {"faces", faces}, {"names", std::move(names)}}}};
}

}  // namespace

Result<ShownModel> ShownModel::Of(const ImportedModel& imported, const Mesh* mesh,
                                  const ArrangementRequest& request) {
  ShownModel shown;
  shown.imported_ = &imported;
  shown.original_mesh_ = mesh;
  const Model& model = *imported.model;
  if (!request.ChangesAnything(model)) return shown;
  auto arrangement = Arrange(model, request);
  if (!arrangement) return arrangement.error();
  // A mesh of another program is shown whole: which of its parts the file hides is not known.
  if (mesh != nullptr && (mesh->from_model || request.RequestsChange())) {
    auto arranged = Arranged(*mesh, model, arrangement.value());
    if (!arranged) return arranged.error();
    shown.mesh_ = std::move(arranged).value();
  }
  ImportedModel& arranged = shown.arranged_.emplace();
  arranged.model = std::make_unique<const Model>(Arranged(model, arrangement.value()));
  arranged.import_ms = imported.import_ms;
  arranged.import_kept = imported.import_kept;
  arranged.load_ms = imported.load_ms;
  arranged.import_peak_bytes = imported.import_peak_bytes;
  arranged.import_peak_address_bytes = imported.import_peak_address_bytes;
  shown.report_ = ArrangementJson(model, request, arrangement.value());
  return shown;
}

}  // namespace facetless
