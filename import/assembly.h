// Assemblies, names and colours: from OpenCASCADE's document (XCAF), or from bare shapes.
#pragma once

#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <string>

#include "import/document.h"

namespace facetless {

Handle(TDocStd_Document) NewXcafDocument();

// Appends prototypes and occurrences of all leaf nodes of the document. Loose shells and faces that stand unplaced at the top become one
// prototype, named `name`.
void AddAssembly(const Handle(TDocStd_Document) & xcaf, const std::string& name, CadDocument& document);

// Appends one shape: compounds are taken apart where they place the same thing more than once.
void AddShape(const TopoDS_Shape& shape, const std::string& name, CadDocument& document);

}  // namespace facetless
