// Which bodies of a document OpenCASCADE has to heal, and healing them.
//
//  1. A body is a solid, a shell that belongs to none, or a face that belongs to neither.
//  2. A body is sound if the edges of every face lie on its surface and make loops that close, do not cross
//     and run the right way around; if no two faces run through an edge in the same direction; and, of a
//     solid, if every edge has two faces, and the faces enclose a positive volume. A sound body stays as the
//     file has it.
//  3. The others are healed as OpenCASCADE's reader of STEP would heal them.
//  4. OpenCASCADE's mesher and its intersector need p-curves with the shapes: for these, and for these alone,
//     sound bodies are healed, too (HealedFaces), with the p-curves of law 2, so that none is computed twice.
#pragma once

#include <NCollection_DataMap.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

#include "import/document.h"
#include "import/face_loops.h"

namespace facetless {

// By face, wherever it is placed.
using LoopsByFace = NCollection_DataMap<TopoDS_Shape, FaceLoops, TopTools_ShapeMapHasher>;

struct Healing {
  std::vector<TopoDS_Shape> sound;  // bodies that were left as the file has them
  LoopsByFace loops;                // of their faces
  double precision_mm = 0;          // of the file
};

// Heals the ill bodies of the document's prototypes in place; their faces keep their origins and colours. Does
// nothing to a document that is healed.
Healing HealDocument(CadDocument& document);

// The faces, those of sound bodies healed. One of which healing makes several stays as it is.
std::vector<TopoDS_Face> HealedFaces(const std::vector<TopoDS_Face>& faces, const Healing& healing);

}  // namespace facetless
