// What expected.json says about a sample: measured on the shape that was written, so that a reader's mistakes
// don't become the expectation; only the kinds of surface are those of the file at `path`, for a format may
// lack some.
#pragma once

#include <TopoDS_Shape.hxx>
#include <nlohmann/json.hpp>
#include <string>

namespace facetless::samples {

// faces, solids, closed solids, kinds of surface, area, volume of the solids, extent. Throws Standard_Failure
// for a shape that is not valid or that has an edge or vertex tolerance over 1e-4 mm, and for a file that
// can't be read.
nlohmann::ordered_json Measure(const TopoDS_Shape& shape, const std::string& path);

}  // namespace facetless::samples
