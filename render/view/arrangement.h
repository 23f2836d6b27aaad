// Arrangement: which occurrences of an assembly are shown, and where. The exact model and its mesh are
// arranged in the same way.
//
//     Result<Arrangement> arrangement = Arrange(model, {.parts = {"wheel"}, .explode = 0.5});
//     if (!arrangement) return arrangement.error();
//     const Model shown = Arranged(model, arrangement.value());
//
//  1. The name of an occurrence is its path as in reports ("flange/bolt 3"), or the name of the prototype if
//     the file gives the occurrence no name.
//  2. A pattern that contains * or ? must match the whole name: * matches any run of characters, including /,
//     and ? matches one character. Any other pattern matches every name that contains it. The case of ASCII
//     letters is ignored.
//  3. An occurrence is shown if it matches one of `parts` (or `parts` is empty), matches none of `hide`, and
//     is not hidden by the file, or `show_hidden` is set. A pattern that matches nothing is an error.
//  4. An explosion by f moves the centre of each occurrence's box to 1 + f times its distance from the centre
//     of everything that is shown. Occurrences therefore keep their order along every direction, boxes that
//     are apart stay apart, and gaps never shrink. Occurrences with a common centre stay together. Nothing is
//     rotated.
//  5. Prototypes do not change, and stay in the model even if no instance places them any more. Faces
//     therefore keep their numbers within the file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/model/mesh.h"
#include "render/model/model.h"

namespace facetless {

struct ArrangementRequest {
  std::vector<std::string> parts, hide;  // patterns
  double explode = 0;                    // f of law 4, >= 0
  bool show_hidden = false;              // also show occurrences that the file hides

  // Returns whether the request changes which occurrences of `model` are shown, or where they are.
  bool ChangesAnything(const Model& model) const {
    return RequestsChange() || (!show_hidden && HidesAnything(model));
  }
  bool RequestsChange() const { return !parts.empty() || !hide.empty() || explode > 0; }
  static bool HidesAnything(const Model& model);
};

struct Arrangement {
  std::vector<std::uint32_t> shown;  // indices of the model's instances, ascending
  std::vector<Vec3> shifts;          // the displacement of each shown instance, mm
  Box3 bounds;                       // bounds of the shown instances after they are moved
};

// The name of an occurrence (law 1). It is never empty.
std::string OccurrenceName(const Model& model, std::uint32_t instance);

// Returns whether the pattern matches the name (law 2).
bool NameMatches(const std::string& pattern, const std::string& name);

// Decides which instances are shown, and where. Errors: kBadUsage (a pattern matches nothing, and the message
// lists existing names; or nothing is left to show).
Result<Arrangement> Arrange(const Model& model, const ArrangementRequest& request);

// The arranged model. Placed-face ids are renumbered and dense.
Model Arranged(const Model& model, const Arrangement& arrangement);

// The mesh of `model`, arranged in the same way. Error: kBadUsage (the mesh comes from another program, and
// its parts are unknown).
Result<Mesh> Arranged(const Mesh& mesh, const Model& model, const Arrangement& arrangement);

}  // namespace facetless
