// Converts OpenCASCADE shapes to the model: faces, loops, edges, solids, parts, instances, bounds.
#pragma once

#include <TopoDS_Face.hxx>
#include <functional>
#include <gp_Trsf.hxx>
#include <vector>

#include "import/document.h"
#include "import/heal.h"
#include "render/base/result.h"
#include "render/model/model.h"

namespace facetless {

struct Conversion {
  Model model;
  std::vector<TopoDS_Face> faces;   // the shape of each of model.faces, placed within its part
  std::vector<gp_Trsf> placements;  // of each of model.instances
  Healing healing;                  // names the bodies whose faces may lack p-curves
};

// Called with the fraction 0 … 1 of the prototypes' faces that have been converted.
using Progress = std::function<void(double)>;

// Faces that cannot be converted are listed in info.faces_lost; loops and edges that are missing are listed
// in loops_lost and edges_lost. Errors: kNothingUsable (no face is left), and the errors of Validate.
Result<Conversion> Convert(CadDocument document, const Progress& progress);

// Adds to the faces what OpenCASCADE's mesher and intersector require (heal.h, law 4). A second call does
// nothing.
void CompleteForOpenCascade(Conversion& conversion);

// Returns the completed shapes of all placed faces, in the order of placed-face ids. The shapes share their
// geometry.
std::vector<TopoDS_Face> PlacedFaces(Conversion& conversion);

}  // namespace facetless
