// The shapes of the sample files, as OpenCASCADE B-reps in millimetres, Z up.
//
//  1. Every function gives the same shape each time, and a valid one (BRepCheck_Analyzer); what is called
//  solid is closed.
//  2. Control points are short decimal numbers, so that the files are short and the same on every machine.
//  3. OpenCASCADE's exceptions are not caught, because this is a tool for the developers of the samples.
#pragma once

#include <TopoDS_Shape.hxx>

namespace facetless::samples {

// An angle bracket: rounded corners, a filleted inner edge, rolled outer edges (tori), two countersunk holes,
// and a slanted hole that breaks through the inner fillet.
TopoDS_Shape Bracket();

// One polynomial bicubic face of 37×37 spans over 100×100 mm: two crossing waves. Trimmed by its natural
// border only.
TopoDS_Shape WavySheet();

// Newell's teapot: 32 bicubic Bézier patches, sewn into four open shells (body, lid, handle, spout). 20 mm
// per unit of the published table.
TopoDS_Shape Teapot();

TopoDS_Shape Sphere();  // radius 10 about the origin: one face with a seam and two poles
TopoDS_Shape Cone();    // radius 10 at z = 0, apex at z = 20
TopoDS_Shape Torus();   // radii 20 and 6 about the z axis: two seams

// A twisted, tapered blade: two B-spline sides that meet at a rounded leading and a sharp trailing edge, and
// two flat ends.
TopoDS_Shape Blade();

// One rational B-spline face of degree 4×3 with weights from 0.25 to 4, trimmed by a free outer loop and two
// holes.
TopoDS_Shape Freeform();

// A closed body of revolution, 60 mm wide. From the foot up its faces meet in a corner, G1 (radii 25 and 12,
// height 20), G0 (a groove of 8 degrees), G2, and a corner.
TopoDS_Shape Vase();

// The content of the IGES file: a curved sheet with a round hole, a trimmed part of a cylinder, a plate with
// holes. Loose faces.
TopoDS_Shape TrimmedFaces();

}  // namespace facetless::samples
