// Mends faces whose wires follow edges forwards and backwards.
//
//  1. If an edge is immediately followed by the same edge in the opposite sense, the pair encloses nothing
//     and is removed. Edges that become neighbours through this may be removed, too. The seam of a cylinder,
//     a sphere or a torus stays, because other edges lie between its two uses.
//  2. If no edge of a face remains, the face is its whole surface, provided that the surface is closed. An
//     example is a sphere whose bound is one arc, forwards and backwards.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

namespace facetless {

struct MendedFace {
  TopoDS_Face face;  // null: no edge is followed forwards and backwards, or what remains is no face
  int left_out = 0;  // number of different edges that were removed
};

// `pieces` together are one face of a file, on one surface. The call may raise OpenCASCADE's exceptions.
MendedFace MendFace(const std::vector<TopoDS_Face>& pieces);

// If `face` is the whole of a torus that meets its axis, returns the part that the file means: the apple
// (`part` 1) or the lemon (−1). Otherwise returns `face` itself. The call may raise OpenCASCADE's exceptions.
TopoDS_Face TorusPart(const TopoDS_Face& face, int part);

}  // namespace facetless
