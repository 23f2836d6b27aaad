// Reads a file into a document, with one reader per format. OpenCASCADE's exceptions do not leave the
// readers.
#pragma once

#include <string>

#include "import/document.h"
#include "import/source_file.h"
#include "render/base/result.h"

namespace facetless {

// Called with a stage ("read", "transfer") and the fraction of it that is done.
using StageProgress = void (*)(const char* stage, double fraction);

// Errors of all readers: kFormatBroken (OpenCASCADE cannot read the file at all), kNothingUsable (the file
// has no faces).
Result<CadDocument> ReadStep(const SourceFile& source, StageProgress progress);
Result<CadDocument> ReadIges(const SourceFile& source, StageProgress progress);
Result<CadDocument> ReadBrep(const SourceFile& source, StageProgress progress);

// Returns the usual name of a length unit of `mm` millimetres: "millimetre", "inch", …. For other lengths it
// returns `written`, the file's own name, or "N millimetres".
std::string UnitName(double mm, const std::string& written);

// Calls the reader for the source's format, and fills in the parts of ImportInfo that all formats share. If
// `unit_mm` is above 0, it is the length of the file's unit in millimetres, whatever the file says.
Result<CadDocument> ReadDocument(const SourceFile& source, StageProgress progress, double unit_mm = 0);

// Turns on OpenCASCADE's signal handler and sets its tables. Call it once per process, with a folder that
// only this process uses.
void PrepareOpenCascade(const std::string& scratch);

}  // namespace facetless
