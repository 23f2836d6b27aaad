// The sample assembly: two levels, three parts, eleven placements, colours of whole parts and of single
// faces.
//
//   stack
//   ├── lower: flange          (plate + bolt 1 … bolt 4)
//   ├── spacer
//   └── upper: flange          (the same flange, upside down)
#pragma once

#include <TDocStd_Document.hxx>

namespace facetless::samples {

Handle(TDocStd_Document) Assembly();

}  // namespace facetless::samples
