// Shapes in placements that scale or mirror. Instances of the model are rigid: what a placement scales is
// baked into a copy of the shape, a prototype of its own, and what remains of the placement is rigid.
#pragma once

#include <TopLoc_Location.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Trsf.hxx>

#include "import/document.h"

namespace facetless {

// The location's transformation with every stand-in (step_placements.h) in it replaced by what it stands for.
gp_Trsf Resolved(const TopLoc_Location& location, const std::vector<LinearMap>& maps);

// A copy of `shape` under `transformation`. Its faces keep their origins in `document`, and their colours in
// `colors`.
TopoDS_Shape BakedShape(const TopoDS_Shape& shape, const gp_Trsf& transformation, CadDocument& document,
                        std::unordered_map<const void*, Color>& colors);

// Resolves all stand-ins: within prototypes, whose parts are then baked, and in occurrences, whose scale goes
// into a copy of the prototype.
void ResolvePlacements(CadDocument& document);

// Scales the whole document about the origin.
void ScaleDocument(double scale, CadDocument& document);

}  // namespace facetless
