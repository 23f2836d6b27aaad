// The input file as bytes: which format it is, by its content alone, and a copy that OpenCASCADE can digest.
#pragma once

#include <string>
#include <vector>

#include "import/iges_text.h"
#include "import/step_repair.h"
#include "import/step_text.h"
#include "render/base/result.h"

namespace facetless {

enum class CadFormat { kStep, kIges, kBrep };

struct SourceFile {
  CadFormat format = CadFormat::kStep;
  std::string name;                  // base name of the file that the user gave
  std::string sha256;                // of the user's bytes
  std::string path;                  // what to read: the user's file, or the repaired copy
  std::vector<std::string> repairs;  // one sentence each
  StepFacts step;                    // what a STEP file declares
  StepRepair step_repair;            // what had to be changed in it; without the bytes
  IgesFacts iges;                    // what an IGES file declares
};

// Reads the file, recognises the format and repairs what a person would expect to work: a byte-order mark,
// text in front of the header, CR line ends, NUL bytes, reals written as integers in IGES. A repaired copy is
// written into `scratch`, a folder of the caller's. Errors: kFileUnreadable; kFormatUnknown (says what it is
// instead, and what to do); kFormatBroken (cut off before any data); kNotFinite (names the entity).
Result<SourceFile> OpenSource(const std::string& path, const std::string& scratch);

}  // namespace facetless
