// What a run shows of an import: all of it, or what --parts, --hide and --explode make of it.
#pragma once

#include <optional>
#include <string>

#include "server/run/run.h"

namespace facetless {

class ShownModel {
 public:
  // `mesh` may be null; both must outlive the result. Errors: those of Arrange, and of Arranged for the mesh.
  static Result<ShownModel> Of(const ImportedModel& imported, const Mesh* mesh,
                               const ArrangementRequest& request);

  const ImportedModel& imported() const { return arranged_ ? *arranged_ : *imported_; }
  const Mesh& mesh() const { return mesh_ ? *mesh_ : *original_mesh_; }
  // The report's "arrangement"; null where everything is as in the file.
  const nlohmann::json& report() const { return report_; }

 private:
  const ImportedModel* imported_ = nullptr;
  const Mesh* original_mesh_ = nullptr;
  std::optional<ImportedModel> arranged_;
  std::optional<Mesh> mesh_;
  nlohmann::json report_;
};

}  // namespace facetless
