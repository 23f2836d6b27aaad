// Repairs a STEP file's text, so that one malformed entity does not cost the whole file, and lists what the
// file declares that cannot be shown. OpenCASCADE reads the repaired copy.
//
//  1. An entity with an empty list where something is needed is taken out, with every entity that cannot
//     exist without it; where a list can do without an element, only the element goes. A curve that needs
//     nothing of its list (a surface curve without p-curves, a trimmed curve without trims) is replaced by
//     its basis curve.
//  2. Every repair is a sentence with the entity's #id. What is taken out and would have been seen is in
//     `lost`, or, if it is a face, in `faces_out` with the reason.
//  3. Placements that scale or mirror become stand-ins (step_placements.h), replicas of solids become mapped
//     items.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "import/step_placements.h"
#include "import/step_text.h"

namespace facetless {

struct StepLostItem {
  std::string entity, name, reason;  // entity: "#12", with an addition where the number alone is ambiguous
};

struct StepRepair {
  std::string bytes;  // of the repaired copy, if `changed`
  bool changed = false;
  std::vector<std::string> warnings;
  std::vector<StepLostItem>
      lost;  // bodies, occurrences, and faces of further STEP files behind the first one
  std::unordered_map<std::uint64_t, std::string> faces_out;  // declared faces that were taken out, and why
  std::vector<LinearMap> linear_maps;                        // what each stand-in stands for
  std::string
      refusal;  // why the file must not be read, as a predicate after the file's name; empty: it may be read
  bool unit_missing = false;  // a representation of bodies has no length unit
};

StepRepair RepairStep(std::string_view bytes);

// Takes the entities of scopes out of them: "#1=&SCOPE #2=A(); ENDSCOPE/#2/ B(#2);" becomes "#2=A();
// #1=B(#2);". Returns the number of scopes.
std::size_t FlattenScopes(std::string& bytes);

// Faces that the file declares: ADVANCED_FACE, FACE_SURFACE and FACE, whatever their names, of all exchange
// structures; and the surfaces that stand for themselves in a GEOMETRIC_SET.
std::vector<StepFace> DeclaredFaces(std::string_view bytes);

}  // namespace facetless
