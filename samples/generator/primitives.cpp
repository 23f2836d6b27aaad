#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>

#include "samples/generator/shapes.h"

namespace facetless::samples {

TopoDS_Shape Sphere() {
  return BRepPrimAPI_MakeSphere(10.0).Solid();
}

TopoDS_Shape Cone() {
  return BRepPrimAPI_MakeCone(10.0, 0.0, 20.0).Solid();
}

TopoDS_Shape Torus() {
  return BRepPrimAPI_MakeTorus(20.0, 6.0).Solid();
}

}  // namespace facetless::samples
