// Repairs a STEP file's text, so that one malformed entity does not make the whole file unreadable, and lists
// what the file declares but cannot be shown. OpenCASCADE reads the repaired copy.
//
//  1. An entity with an empty list where an element is required is removed, together with every entity that
//     cannot exist without it. Where a list can do without an element, only the element is removed. A curve
//     that does not need its list (a surface curve without p-curves, a trimmed curve without trims) is
//     replaced by its basis curve.
//  2. Every repair is reported in a sentence with the entity's #id. Removed entities that would have been
//     visible are listed in `lost`, or, if they are faces, in `faces_out` with the reason.
//  3. Placements that scale or mirror become stand-ins (step_placements.h), and replicas of solids become
//     mapped items.
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
  std::string bytes;  // the repaired copy, if `changed`
  bool changed = false;
  std::vector<std::string> warnings;
  // Bodies, occurrences, and faces of further STEP files behind the first one.
  std::vector<StepLostItem> lost;
  std::unordered_map<std::uint64_t, std::string> faces_out;  // removed faces, with the reason
  std::vector<LinearMap> linear_maps;                        // the map that each stand-in represents
  // The reason why the file must not be read, as a predicate after the file's name; empty if it may be read.
  std::string refusal;
  bool unit_missing = false;  // a representation of bodies has no length unit
};

StepRepair RepairStep(std::string_view bytes);

// Moves the entities of scopes out of them: "#1=&SCOPE #2=A(); ENDSCOPE/#2/ B(#2);" becomes "#2=A();
// #1=B(#2);". Returns the number of scopes.
std::size_t FlattenScopes(std::string& bytes);

// Returns the faces that the file declares: ADVANCED_FACE, FACE_SURFACE and FACE in all exchange structures,
// with any name, and surfaces that are elements of a GEOMETRIC_SET and so represent themselves.
std::vector<StepFace> DeclaredFaces(std::string_view bytes);

}  // namespace facetless
