// The model that a run shows: the whole import, or the arrangement that --parts, --hide and --explode select.
#pragma once

#include <optional>
#include <string>

#include "server/run/run.h"

namespace facetless {

class ShownModel {
 public:
  // Arranges the model and its mesh. `mesh` may be null; both must outlive the result. Errors: the errors of
  // Arrange, and of Arranged for the mesh.
  static Result<ShownModel> Of(const ImportedModel& imported, const Mesh* mesh,
                               const ArrangementRequest& request);

  const ImportedModel& imported() const { return arranged_ ? *arranged_ : *imported_; }
  const Mesh& mesh() const { return mesh_ ? *mesh_ : *original_mesh_; }
  // The report's "arrangement"; null if everything is shown as in the file.
  const nlohmann::json& report() const { return report_; }

 private:
  const ImportedModel* imported_ = nullptr;
  const Mesh* original_mesh_ = nullptr;
  std::optional<ImportedModel> arranged_;
  std::optional<Mesh> mesh_;
  nlohmann::json report_;
};

}  // namespace facetless
