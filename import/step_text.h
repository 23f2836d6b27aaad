// A STEP file as text: what it declares, found without OpenCASCADE, which drops what it cannot parse without a word.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/model/result.h"

namespace facetless {

struct StepFace {
  std::uint64_t id = 0;  // #id
  std::string name;
};

struct StepFacts {
  std::string schema;           // first one of FILE_SCHEMA, without its version: "AUTOMOTIVE_DESIGN"
  std::vector<StepFace> faces;  // ADVANCED_FACE and FACE_SURFACE
  bool has_pcurves = false;
  bool has_tessellation = false;  // TESSELLATED_… or TRIANGULATED_… entities
  std::uint64_t entities = 0;
};

// Errors: kNotFinite (a coordinate that is NaN or infinite; names the entity), kFormatBroken (cut off inside the header, or a
// string that never ends).
Result<StepFacts> ScanStep(const std::string& name, std::string_view bytes);

// "STEP AP203", "STEP AP214", "STEP AP242", or "STEP" with the schema's name.
std::string StepFormatName(const std::string& schema);

}  // namespace facetless
