// Small shapes with known answers, and the conversion of a shape to a model without a file.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>

#include "import/convert.h"
#include "import/face_loops.h"
#include "render/base/result.h"

namespace facetless {

Result<Conversion> ConvertShape(const TopoDS_Shape& shape);
// Reads the file through the readers, as the command does.
Result<Conversion> ConvertFile(const std::string& path);

// Returns twice the signed area that all loops enclose in (u, v), measured with fine polygons.
double SignedArea(const FaceLoops& loops);

// Returns the trimmed area of a face of the model: by Gauss-Legendre quadrature along v between loop
// crossings, and along u between the ends of segments. The relative error is about 1e-4.
double TrimmedArea(const Model& model, std::uint32_t face);

}  // namespace facetless
