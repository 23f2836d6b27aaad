// What expected.json says about a sample: counted and measured on the shape that was written.
#pragma once

#include <TopoDS_Shape.hxx>
#include <nlohmann/json.hpp>

namespace facetless::samples {

// faces, solids, closed solids, kinds of surface, area, volume of the solids, extent. Throws Standard_Failure
// for a shape that is not valid, or that has an edge or vertex tolerance over 1e-4 mm.
nlohmann::ordered_json Measure(const TopoDS_Shape& shape);

}  // namespace facetless::samples
