// Reads the input file as bytes, recognises its format by the content alone, and makes a copy that
// OpenCASCADE can read.
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
  std::string path;                  // the file to read: the user's file, or the repaired copy
  std::vector<std::string> repairs;  // one sentence each
  StepFacts step;                    // what a STEP file declares
  StepRepair step_repair;            // what was changed in a STEP file, without the bytes
  IgesFacts iges;                    // what an IGES file declares
};

// Reads the file, recognises the format and repairs common defects: a byte-order mark, text in front of the
// header, CR line ends, NUL bytes, reals that are written as integers in IGES. A repaired copy is written
// into `scratch`, a folder of the caller. Errors: kFileUnreadable; kFormatUnknown (the message says what the
// file is and what to do); kFormatBroken (the file is cut off before any data); kNotFinite (the message names
// the entity).
Result<SourceFile> OpenSource(const std::string& path, const std::string& scratch);

}  // namespace facetless
