// Assemblies, names and colours: from OpenCASCADE's document (XCAF), or from bare shapes.
#pragma once

#include <Quantity_ColorRGBA.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "import/document.h"

namespace facetless {

Handle(TDocStd_Document) NewXcafDocument();

Color ToColor(const Quantity_ColorRGBA& color);

// A colour that the file gives to one occurrence of a part.
struct OccurrenceColor {
  TopoDS_Shape component;  // the occurrence, as the assembly places it
  Color color;
  std::optional<Color> of_part;  // what the part has elsewhere
};

// Appends prototypes and occurrences of all leaf nodes of the document. Loose shells and faces that stand
// unplaced at the top become one prototype, named `name`. Bodies that the file hides, by themselves or by
// their layer, become occurrences that are hidden. OpenCASCADE gives the last of several occurrence colours
// to all occurrences: `colors` puts that right.
void AddAssembly(const Handle(TDocStd_Document) & xcaf, const std::string& name,
                 const std::vector<OccurrenceColor>& colors, CadDocument& document);

// Makes hidden occurrences of the bodies all of whose faces are among `hidden` (by TShape).
void HideFaces(const std::unordered_set<const void*>& hidden, CadDocument& document);

// Appends one shape: compounds are taken apart where they place the same thing more than once.
void AddShape(const TopoDS_Shape& shape, const std::string& name, CadDocument& document);

}  // namespace facetless
