// The sample assembly: two levels, three parts, eleven placements; colours of whole parts and of single
// faces.
//
//   stack
//   ├── lower flange: flange     (base plate: plate; bolt 1 … bolt 4: bolt M8)
//   ├── middle spacer: spacer
//   └── upper flange: flange
#pragma once

#include <TDocStd_Document.hxx>

namespace facetless::samples {

Handle(TDocStd_Document) Assembly();

}  // namespace facetless::samples
