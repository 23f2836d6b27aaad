#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include "import/assembly.h"
#include "import/readers.h"

namespace facetless {
namespace {

// Entities that stand for one face: trimmed and bounded surfaces, and the face of a B-rep.
bool IsFace(int type) {
  return type == 144 || type == 143 || type == 510;
}

class IgesReader {
 public:
  IgesReader(const SourceFile& source, StageProgress progress) : source_(source), progress_(progress) {}

  Result<CadDocument> Run() {
    progress_("read", 0);
    document_.info.format = "IGES";
    document_.pcurves_in_file = true;
    if (Result<void> read = Read(); !read.ok()) return read.error();
    progress_("read", 1);
    progress_("transfer", 0);
    Transfer();
    progress_("transfer", 1);
    return std::move(document_);
  }

 private:
  Result<void> Read() {
    try {
      OCC_CATCH_SIGNALS
      reader_.SetColorMode(true);
      reader_.SetNameMode(true);
      reader_.SetLayerMode(false);
      if (reader_.ReadFile(source_.path.c_str()) != IFSelect_RetDone)
        return Error{ErrorCode::kFormatBroken,
                     source_.name + " is an IGES file that cannot be parsed; export the model again."};
      const Handle(IGESData_IGESModel) model = reader_.IGESModel();
      if (!model->GlobalSection().UnitName().IsNull())
        document_.info.unit = model->GlobalSection().UnitName()->ToCString();
      document_.info.unit_mm = model->GlobalSection().UnitValue();
      return {};
    } catch (const Standard_Failure& failure) {
      return Error{ErrorCode::kFormatBroken, source_.name + " is an IGES file that cannot be parsed (" +
                                                 failure.DynamicType()->Name() +
                                                 "); export the model again."};
    }
  }

  void Transfer() {
    try {
      OCC_CATCH_SIGNALS
      Handle(TDocStd_Document) xcaf = NewXcafDocument();
      if (reader_.Transfer(xcaf)) AddAssembly(xcaf, source_.name, document_);
    } catch (const Standard_Failure& failure) {
      document_.prototypes.clear();
      document_.occurrences.clear();
    }
    NoteOrigins();
  }

  void NoteOrigins() {
    const Handle(IGESData_IGESModel) model = reader_.IGESModel();
    const Handle(Transfer_TransientProcess) process = reader_.WS()->TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const Handle(IGESData_IGESEntity) entity = model->Entity(i);
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
      const bool is_face = IsFace(entity->TypeNumber());
      if (is_face) ++document_.info.faces_declared;
      const std::string label = "D" + std::to_string(model->DNum(entity));
      if (shape.IsNull()) {
        if (is_face)
          document_.info.faces_lost.push_back({kNoIndex, "", label, "OpenCASCADE made no face of it"});
        continue;
      }
      for (TopExp_Explorer part(shape, TopAbs_FACE); part.More(); part.Next()) {
        FaceOrigin& origin = document_.origins[part.Current().TShape().get()];
        if (origin.entity.empty() || is_face) origin.entity = label;
        if (entity->HasShortLabel() && (origin.name.empty() || is_face))
          origin.name = entity->ShortLabel()->ToCString();
      }
    }
  }

  const SourceFile& source_;
  StageProgress progress_;
  IGESCAFControl_Reader reader_;
  CadDocument document_;
};

}  // namespace

Result<CadDocument> ReadIges(const SourceFile& source, StageProgress progress) {
  return IgesReader(source, progress).Run();
}

}  // namespace facetless
