// Finds the bodies of a document that OpenCASCADE has to heal, and heals them.
//
//  1. A body is a solid, a shell that belongs to no solid, or a face that belongs to neither.
//  2. A body is sound if the edges of every face lie on its surface and form closed loops that do not cross
//     and have the right orientation, and if no two faces use an edge in the same direction. A sound solid
//     also has two faces at every edge, and its faces enclose a positive volume. A sound body stays as the
//     file has it.
//  3. The other bodies are healed in the same way as OpenCASCADE's STEP reader heals shapes. Each is listed with the
//     reason and with what changed.
//  4. OpenCASCADE's mesher and its intersector require p-curves in the shapes. Only for these two, sound
//     bodies are healed, too (HealedFaces). They receive the p-curves that law 2 has computed, so that none
//     is computed twice.
#pragma once

#include <NCollection_DataMap.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

#include "import/document.h"
#include "import/face_loops.h"

namespace facetless {

// Loops by face. The face's key includes its placement.
using LoopsByFace = NCollection_DataMap<TopoDS_Shape, FaceLoops, TopTools_ShapeMapHasher>;

struct Healing {
  std::vector<TopoDS_Shape> sound;  // bodies that were left as the file has them
  LoopsByFace loops;                // loops of the faces of sound bodies
  double precision_mm = 0;          // precision of the file
  std::vector<HealedBody> healed;   // the bodies that are not sound, and what changed of them
};

// Heals the bodies of the document's prototypes that are not sound, in place. Their faces keep their origins
// and colours. A document that is already healed does not change.
Healing HealDocument(CadDocument& document);

// Returns the faces, with those of sound bodies healed. A face that healing would split into several stays as
// it is.
std::vector<TopoDS_Face> HealedFaces(const std::vector<TopoDS_Face>& faces, const Healing& healing);

}  // namespace facetless
