// The result of reading a CAD file: OpenCASCADE shapes as prototypes, their placements, and what the file
// says about them.
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

// What the file declares about a face. The importer compares it with the converted face.
struct FaceOrigin {
  std::string entity, name;
  int bounds = 0;  // number of bounds that have edges; 0: unknown
  int edges = 0;   // number of different edges in all bounds; 0: unknown
  int sense = 0;   // 1: the face has the orientation of its surface, −1: the opposite one; 0: unknown
  // Of a torus that meets its axis, the face is the outer part, called apple (1), or the inner part, called
  // lemon (−1). 0: the surface is no such torus.
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
  TopLoc_Location location;  // the source of `placement`; it may contain stand-ins (step_placements.h)
  bool hidden = false;       // the file says that this occurrence is not to be shown
};

// A face that the file declares. Faces that were lost are counted after the conversion.
struct DeclaredFace {
  std::string entity, name;
};

struct CadDocument {
  ImportInfo info;  // filled in part by the reader; the conversion adds the rest
  std::vector<DeclaredFace> declared;
  std::vector<Prototype> prototypes;
  std::vector<Occurrence> occurrences;
  std::unordered_map<const void*, FaceOrigin> origins;  // by TShape
  bool pcurves_in_file = false;
  // The precision of the file's points in mm, as the file states it. It is set if no OpenCASCADE repair has
  // changed the shapes, so that edges may lack p-curves. It is empty if the shapes are healed.
  std::optional<double> unhealed_mm;
  // The maps that stand-ins among the placements represent (step_placements.h).
  std::vector<LinearMap> linear_maps;
};

}  // namespace facetless
