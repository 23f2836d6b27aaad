// Shapes in placements that scale or mirror. Instances of the model are rigid. Therefore the scale or
// reflection of a placement is applied to a copy of the shape, which becomes a prototype of its own, and the
// rest of the placement is rigid.
#pragma once

#include <TopLoc_Location.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Trsf.hxx>

#include "import/document.h"

namespace facetless {

// Returns the location's transformation, with every stand-in (step_placements.h) replaced by the map that it
// represents.
gp_Trsf Resolved(const TopLoc_Location& location, const std::vector<LinearMap>& maps);

// Returns a copy of `shape` under `transformation`. Its faces keep their origins in `document` and their
// colours in `colors`.
TopoDS_Shape BakedShape(const TopoDS_Shape& shape, const gp_Trsf& transformation, CadDocument& document,
                        std::unordered_map<const void*, Color>& colors);

// Resolves all stand-ins. Prototypes that contain one are copied with the map applied. If an occurrence
// scales, the scale is applied to a copy of its prototype.
void ResolvePlacements(CadDocument& document);

// Scales the whole document about the origin.
void ScaleDocument(double scale, CadDocument& document);

}  // namespace facetless
