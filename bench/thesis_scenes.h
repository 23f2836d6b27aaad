// Scenes for tables 2 to 4 of A. Sisojevs's thesis ("3D scene rendering"). They are our own, but resemble those of the
// thesis, whose models are not published: a teapot on a plane, a column, a water lily, and a skull with a diseased zone.
// All surfaces are polynomial and bicubic, as in the thesis: table 2 has Bézier surfaces, and tables 3 and 4 have
// B-spline surfaces. The scenes of table 5 are those of patch_scene.h.
#pragma once

#include "render/model/model.h"

namespace facetless {

// A body, a lid, a spout and a handle of Bézier patches, on a square of 160 mm.
Model TeapotOnAPlane();
// A fluted shaft with a base and a capital.
Model FlutedColumn();
// Three rings of eight petals around a middle, and leaves on the water.
Model WaterLily();
// The inner surface of half a skull, and an irregular closed body within it.
Model SkullAndPathology();

}  // namespace facetless
