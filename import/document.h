// What a reader makes of a CAD file: OpenCASCADE shapes as prototypes, where they are placed, and what the
// file says about them.
#pragma once

#include <TopLoc_Location.hxx>
#include <TopoDS_Shape.hxx>
#include <cstdint>
#include <gp_Trsf.hxx>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "import/step_placements.h"
#include "render/model/model.h"

namespace facetless {

// What the file declares about a face, to be compared with what came out.
struct FaceOrigin {
  std::string entity, name;
  int bounds = 0;  // that have edges; 0: not known
  int edges = 0;   // different ones, of all bounds; 0: not known
  int sense = 0;   // 1: the face looks where its surface does, −1: the other way; 0: not known
  // Of a torus that meets its axis the face has the outer part, the apple (1), or the inner one, the lemon
  // (−1); 0: no such torus.
  int torus_part = 0;
};

struct Prototype {
  std::string name;
  TopoDS_Shape shape;
  std::unordered_map<const void*, Color> colors;  // of faces, by TShape
};

struct Occurrence {
  std::size_t prototype = 0;
  gp_Trsf placement;
  bool has_color = false;
  Color color;
  std::string name;
  TopLoc_Location location;  // what `placement` was computed from; it may hold stand-ins (step_placements.h)
  bool hidden = false;       // the file says that it is not to be shown
};

// A face that the file declares; what became of it is counted when all is converted.
struct DeclaredFace {
  std::string entity, name;
};

struct CadDocument {
  ImportInfo info;  // what reading knows; conversion adds the rest
  std::vector<DeclaredFace> declared;
  std::vector<Prototype> prototypes;
  std::vector<Occurrence> occurrences;
  std::unordered_map<const void*, FaceOrigin> origins;  // by TShape
  bool pcurves_in_file = false;
  // What the file says that its points are known to, in mm, if its shapes are as the file has them: no
  // OpenCASCADE repair has seen them, and edges may lack p-curves. Empty: they are healed.
  std::optional<double> unhealed_mm;
  std::vector<LinearMap> linear_maps;  // what stand-ins among the placements stand for (step_placements.h)
};

}  // namespace facetless
