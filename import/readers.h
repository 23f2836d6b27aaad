// From a file to a document, one reader per format. OpenCASCADE's exceptions end here.
#pragma once

#include <string>

#include "import/document.h"
#include "import/source_file.h"
#include "render/base/result.h"

namespace facetless {

// Called with a stage ("read", "transfer") and the share of it that is done.
using StageProgress = void (*)(const char* stage, double fraction);

// Errors of all: kFormatBroken (OpenCASCADE cannot read it at all), kNothingUsable (it holds no faces).
Result<CadDocument> ReadStep(const SourceFile& source, StageProgress progress);
Result<CadDocument> ReadIges(const SourceFile& source, StageProgress progress);
Result<CadDocument> ReadBrep(const SourceFile& source, StageProgress progress);

// The usual name of a length unit of `mm` millimetres: "millimetre", "inch", …; else `written`, the file's
// own name for it, or "N millimetres".
std::string UnitName(double mm, const std::string& written);

// The reader for the source's format; fills the parts of ImportInfo that all share. `unit_mm` above 0 is one
// unit of the file in millimetres, whatever the file says.
Result<CadDocument> ReadDocument(const SourceFile& source, StageProgress progress, double unit_mm = 0);

// Turns on OpenCASCADE's signal handler and sets its tables: call once per process, with a folder of the
// process's own.
void PrepareOpenCascade(const std::string& scratch);

}  // namespace facetless
