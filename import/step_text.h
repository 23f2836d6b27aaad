// Reads a STEP file as text and finds what it declares. OpenCASCADE cannot be used for this, because it
// silently drops what it cannot parse.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "import/step_strings.h"
#include "render/base/result.h"

namespace facetless {

struct StepFace {
  std::uint64_t id = 0;  // #id
  std::string name;
  bool bare = false;  // no face, but a surface in a GEOMETRIC_SET, which represents itself
};

// A style that applies to some occurrences only (CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM).
struct StepStyleContext {
  std::uint64_t item = 0;               // #id of the style
  std::vector<std::uint64_t> contexts;  // #ids of the placements to which it applies
};

struct StepFacts {
  std::string schema;           // the first schema of FILE_SCHEMA, without its version: "AUTOMOTIVE_DESIGN"
  std::vector<StepFace> faces;  // all declared faces, from DeclaredFaces (step_repair.h)
  std::vector<StepStyleContext> style_contexts;
  bool has_pcurves = false;
  bool has_tessellation = false;  // TESSELLATED_… or TRIANGULATED_… entities
  std::uint64_t entities = 0;
  std::uint64_t open_strings = 0;  // texts whose closing apostrophe is missing
  bool cut_off = false;            // the end of the data section is missing
  std::uint64_t last_entity = 0;   // #id of the last complete entity
  // If the file is cut off: its length up to the end of the last complete entity.
  std::size_t complete_bytes = 0;
};

// Errors: kNotFinite (a number is NaN, infinite or beyond 1e150; the message names the entity), kFormatBroken
// (there is no data section; lists are nested too deeply, or an oriented edge refers to itself: both messages
// name the entity).
Result<StepFacts> ScanStep(const std::string& name, std::string_view bytes);

// "STEP AP203", "STEP AP214", "STEP AP242", or "STEP" with the schema's name.
std::string StepFormatName(const std::string& schema);

}  // namespace facetless
