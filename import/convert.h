// From shapes to the model: faces, loops, edges, solids, parts, instances, bounds.
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
  Healing healing;                  // names bodies whose faces may lack p-curves
};

// Called with the share of prototypes' faces done, 0 … 1.
using Progress = std::function<void(double)>;

// Faces that cannot be converted are listed in info.faces_lost; loops and edges that are missing in
// loops_lost and edges_lost. Errors: kNothingUsable (no face is left); those of Validate.
Result<Conversion> Convert(CadDocument document, const Progress& progress);

// Gives the faces what OpenCASCADE's mesher and intersector need of them (heal.h, law 4), once.
void CompleteForOpenCascade(Conversion& conversion);

// The shapes of all placed faces, by placed-face id, completed. They share their geometry.
std::vector<TopoDS_Face> PlacedFaces(Conversion& conversion);

}  // namespace facetless
