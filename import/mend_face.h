// Faces whose wires walk edges there and back.
//
//  1. An edge that is followed by itself in the opposite sense encloses nothing and is removed; edges that
//     become neighbours by this may be removed, too. The seam of a cylinder, a sphere or a torus stays: other
//     edges lie between its two uses.
//  2. A face of which nothing remains is the whole of its surface, if that is closed: a sphere whose bound is
//     one arc, there and back.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

namespace facetless {

struct MendedFace {
  TopoDS_Face face;  // null: nothing is walked there and back, or what remains is no face
  int left_out = 0;  // how many different edges were removed
};

// `pieces` are one face of a file, on one surface. May raise OpenCASCADE's exceptions.
MendedFace MendFace(const std::vector<TopoDS_Face>& pieces);

// The apple (`part` 1) or the lemon (−1) of a torus that meets its axis, if `face` is the whole of that
// torus, where the file means one of the two; else `face` itself. May raise OpenCASCADE's exceptions.
TopoDS_Face TorusPart(const TopoDS_Face& face, int part);

}  // namespace facetless
