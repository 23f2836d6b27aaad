// Small shapes with known answers, and the way from a shape to a model without a file.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>

#include "import/convert.h"
#include "import/face_loops.h"
#include "render/base/result.h"

namespace facetless {

Result<Conversion> ConvertShape(const TopoDS_Shape& shape);
// Through the readers, as the command does.
Result<Conversion> ConvertFile(const std::string& path);

// Twice the signed area that all loops enclose in (u, v), by fine polygons.
double SignedArea(const FaceLoops& loops);

// The trimmed area of a face of the model: Gauss-Legendre in v between loop crossings, in u between ends of
// segments. Good to about 1e-4 of the area.
double TrimmedArea(const Model& model, std::uint32_t face);

}  // namespace facetless
