// Computes the entries of expected.json. They are measured on the shape that was written, so that errors of
// the readers do not become expectations. Only the kinds of surface come from the file at `path`, because a
// format may lack some.
#pragma once

#include <TopoDS_Shape.hxx>
#include <nlohmann/json.hpp>
#include <string>

namespace facetless::samples {

// Returns faces, solids, closed solids, kinds of surface, area, volume of the solids, extent. Throws Standard_Failure
// for a shape that is not valid or that has an edge or vertex tolerance over 1e-4 mm, and for a file that
// can't be read.
nlohmann::ordered_json Measure(const TopoDS_Shape& shape, const std::string& path);

}  // namespace facetless::samples
