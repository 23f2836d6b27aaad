// Writes shapes as CAD files that depend only on the shape: fixed time stamps, no names of persons or
// machines. Each call throws Standard_Failure when the file cannot be written.
#pragma once

#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <string>

namespace facetless::samples {

// STEP AP214, with p-curves. `name` becomes the product's name.
void WriteStep(const TopoDS_Shape& shape, const std::string& name, const std::string& path);
// STEP AP214 with the document's assembly structure, names and colours.
void WriteStep(const Handle(TDocStd_Document) & document, const std::string& name, const std::string& path);
// IGES 5.3 with faces as trimmed surfaces (entity type 144).
void WriteIges(const TopoDS_Shape& shape, const std::string& name, const std::string& path);

}  // namespace facetless::samples
