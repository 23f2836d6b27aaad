// Reads assemblies, names and colours from OpenCASCADE's document (XCAF) or from bare shapes.
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
  std::optional<Color> of_part;  // the colour of the part's other occurrences
};

// Appends prototypes and occurrences of all leaf nodes of the document. Loose shells and faces that lie
// unplaced at the top level become one prototype with the name `name`. Bodies that the file hides, directly
// or through their layer, become hidden occurrences. If a part has several occurrence colours, OpenCASCADE
// gives the last of them to all occurrences; `colors` corrects this.
void AddAssembly(const Handle(TDocStd_Document) & xcaf, const std::string& name,
                 const std::vector<OccurrenceColor>& colors, CadDocument& document);

// Turns the bodies all of whose faces are in `hidden` (by TShape) into hidden occurrences.
void HideFaces(const std::unordered_set<const void*>& hidden, CadDocument& document);

// Appends one shape. A compound that places the same shape more than once is split into its components.
void AddShape(const TopoDS_Shape& shape, const std::string& name, CadDocument& document);

}  // namespace facetless
