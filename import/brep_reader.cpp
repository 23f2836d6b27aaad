#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>

#include "import/assembly.h"
#include "import/readers.h"

namespace facetless {

Result<CadDocument> ReadBrep(const SourceFile& source, StageProgress progress) {
  CadDocument document;
  progress("read", 0);
  document.info.format = "BREP";
  document.info.unit = "millimetre";  // the format has no unit; OpenCASCADE's unit is the millimetre
  document.pcurves_in_file = true;
  try {
    OCC_CATCH_SIGNALS
    TopoDS_Shape shape;
    if (!BRepTools::Read(shape, source.path.c_str(), BRep_Builder()) || shape.IsNull())
      return Error{ErrorCode::kFormatBroken,
                   source.name + " is a BREP file that cannot be parsed; export the model again."};
    progress("read", 1);
    AddShape(shape, source.name, document);
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    for (int i = 1; i <= faces.Extent(); ++i) {
      // A face in two places counts as one face.
      std::string& entity = document.origins[faces(i).TShape().get()].entity;
      if (!entity.empty()) continue;
      entity = "face " + std::to_string(i);
      document.declared.push_back({entity, {}});
    }
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::kFormatBroken, source.name + " is a BREP file that cannot be parsed (" +
                                               failure.DynamicType()->Name() + "); export the model again."};
  }
  progress("transfer", 1);
  return document;
}

}  // namespace facetless
