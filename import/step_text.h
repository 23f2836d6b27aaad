// A STEP file as text: what it declares, found without OpenCASCADE, which drops what it cannot parse without
// a word.
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
  bool bare = false;  // no face but a surface that stands for itself in a GEOMETRIC_SET
};

// A style that holds for some occurrences only (CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM).
struct StepStyleContext {
  std::uint64_t item = 0;               // #id of the style
  std::vector<std::uint64_t> contexts;  // #ids of the placements that it is about
};

struct StepFacts {
  std::string schema;           // first one of FILE_SCHEMA, without its version: "AUTOMOTIVE_DESIGN"
  std::vector<StepFace> faces;  // all that is declared, by DeclaredFaces (step_repair.h)
  std::vector<StepStyleContext> style_contexts;
  bool has_pcurves = false;
  bool has_tessellation = false;  // TESSELLATED_… or TRIANGULATED_… entities
  std::uint64_t entities = 0;
  std::uint64_t open_strings = 0;  // texts whose closing apostrophe is missing
  bool cut_off = false;            // the end of the data section is missing
  std::uint64_t last_entity = 0;   // the last whole one
  std::size_t complete_bytes = 0;  // of a file that is cut off: up to the end of its last whole entity
};

// Errors: kNotFinite (a number that is NaN, infinite or beyond 1e150; names the entity), kFormatBroken (no
// data section; lists nested too deeply, or an oriented edge of itself: both name the entity).
Result<StepFacts> ScanStep(const std::string& name, std::string_view bytes);

// "STEP AP203", "STEP AP214", "STEP AP242", or "STEP" with the schema's name.
std::string StepFormatName(const std::string& schema);

}  // namespace facetless
