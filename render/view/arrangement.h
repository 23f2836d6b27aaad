// What of an assembly is shown, and where: one decision for the exact model and for its mesh.
//
//  1. A name is an occurrence's path as in reports ("flange/bolt 3"); the prototype's name where the file
//     gives the occurrence none.
//  2. A pattern with * or ? must match the whole name (* any run of characters, / too; ? one character); any
//     other one matches where it occurs in the name. Capitals of ASCII don't count.
//  3. Shown is what matches one of `parts` (all, if there are none) and none of `hide`, and is not hidden by
//     the file itself, unless `show_hidden` says so. A pattern that matches nothing is an error.
//  4. Exploded by f, the centre of each occurrence's box moves from the centre of all that is shown to 1 + f
//     times its distance. So no two occurrences change their order along any direction, boxes that are apart
//     stay apart, and gaps never shrink; what shares one centre stays together. Nothing is turned.
//  5. Prototypes stay as they are, those that nobody places any more too: faces keep their numbers within the
//     file.
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
  bool show_hidden = false;              // also what the file hides

  // Whether the request changes what is shown of `model`, or where.
  bool ChangesAnything(const Model& model) const {
    return IsAskedFor() || (!show_hidden && HidesAnything(model));
  }
  bool IsAskedFor() const { return !parts.empty() || !hide.empty() || explode > 0; }
  static bool HidesAnything(const Model& model);
};

struct Arrangement {
  std::vector<std::uint32_t> shown;  // indices of the model's instances, ascending
  std::vector<Vec3> shifts;          // by what each of them is moved, mm
  Box3 bounds;                       // of what is shown, where it is then
};

// Law 1. Never empty.
std::string OccurrenceName(const Model& model, std::uint32_t instance);

// Law 2.
bool NameMatches(const std::string& pattern, const std::string& name);

// Errors: kBadUsage (a pattern without a match: the message lists names that there are; nothing is left).
Result<Arrangement> Arrange(const Model& model, const ArrangementRequest& request);

// The model so arranged; placed-face ids are dense again.
Model Arranged(const Model& model, const Arrangement& arrangement);

// The mesh that stands for `model`, arranged alike. Error: kBadUsage (a mesh of another program, whose parts
// nobody knows).
Result<Mesh> Arranged(const Mesh& mesh, const Model& model, const Arrangement& arrangement);

}  // namespace facetless
