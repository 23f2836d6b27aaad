#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Check.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_Surface.hxx>
#include <StepShape_EdgeLoop.hxx>
#include <StepShape_FaceBound.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_OrientedEdge.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <set>

#include "import/assembly.h"
#include "import/readers.h"

namespace facetless {
namespace {

// Bounds with edges, and their different edges, that the file gives a face.
void CountBounds(const Handle(StepShape_FaceSurface) & face, FaceOrigin& origin) {
  std::set<const void*> edges;
  for (int i = 1; i <= face->NbBounds(); ++i) {
    if (face->BoundsValue(i).IsNull()) continue;
    const Handle(StepShape_EdgeLoop) loop =
        Handle(StepShape_EdgeLoop)::DownCast(face->BoundsValue(i)->Bound());
    if (loop.IsNull()) continue;
    ++origin.bounds;
    for (int e = 1; e <= loop->NbEdgeList(); ++e) {
      const Handle(StepShape_OrientedEdge) edge = loop->EdgeListValue(e);
      if (!edge.IsNull()) edges.insert(edge->EdgeElement().get());
    }
  }
  origin.edges = static_cast<int>(edges.size());
}

std::string Label(std::uint64_t id) {
  std::string label = "#";
  return label.append(std::to_string(id));
}

std::string FirstMessage(const Handle(Interface_Check) & check) {
  if (check.IsNull()) return {};
  if (check->NbFails() > 0) return check->CFail(1);
  if (check->NbWarnings() > 0) return check->CWarning(1);
  return {};
}

class StepReader {
 public:
  StepReader(const SourceFile& source, StageProgress progress) : source_(source), progress_(progress) {}

  Result<CadDocument> Run() {
    progress_("read", 0);
    document_.info.format = StepFormatName(source_.step.schema);
    document_.pcurves_in_file = source_.step.has_pcurves;
    if (Result<void> read = Read(); !read.ok()) return read.error();
    progress_("read", 1);
    progress_("transfer", 0);
    Transfer();
    progress_("transfer", 1);
    return std::move(document_);
  }

 private:
  Handle(XSControl_WorkSession) Session() { return reader_.Reader().WS(); }

  Result<void> Read() {
    try {
      OCC_CATCH_SIGNALS
      reader_.SetColorMode(true);
      reader_.SetNameMode(true);
      reader_.SetLayerMode(false);
      reader_.SetPropsMode(false);
      reader_.SetSHUOMode(true);
      if (reader_.ReadFile(source_.path.c_str()) != IFSelect_RetDone)
        return Error{ErrorCode::kFormatBroken,
                     source_.name + " is a STEP file that cannot be parsed; export the model again."};
      ReadUnit();
      return {};
    } catch (const Standard_Failure& failure) {
      return Error{ErrorCode::kFormatBroken, source_.name + " is a STEP file that cannot be parsed (" +
                                                 failure.DynamicType()->Name() +
                                                 "); export the model again."};
    }
  }

  void ReadUnit() {
    TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
    reader_.ChangeReader().FileUnits(lengths, angles, solid_angles);
    if (lengths.Length() > 0) document_.info.unit = lengths.First().ToCString();
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

  // Finds the entity of each face, and what the file says of it.
  void NoteOrigins() {
    const Handle(Interface_InterfaceModel) model = Session()->Model();
    const Handle(Transfer_TransientProcess) process = Session()->TransferReader()->TransientProcess();
    std::set<std::string> arrived;
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const Handle(StepShape_FaceSurface) face = Handle(StepShape_FaceSurface)::DownCast(model->Value(i));
      if (face.IsNull()) continue;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process, face);
      if (shape.IsNull()) continue;
      FaceOrigin origin;
      origin.entity =
          Label(static_cast<std::uint64_t>(Handle(StepData_StepModel)::DownCast(model)->IdentLabel(face)));
      if (!face->Name().IsNull()) origin.name = face->Name()->ToCString();
      CountBounds(face, origin);
      for (TopExp_Explorer part(shape, TopAbs_FACE); part.More(); part.Next())
        document_.origins[part.Current().TShape().get()] = origin;
      arrived.insert(origin.entity);
    }
    // What the text declares and did not arrive is lost.
    document_.info.faces_declared = source_.step.faces.size();
    for (const StepFace& face : source_.step.faces) {
      const std::string entity = Label(face.id);
      if (arrived.contains(entity)) continue;
      document_.info.faces_lost.push_back({kNoIndex, face.name, entity, ReasonFor(entity)});
    }
  }

  std::string ReasonFor(const std::string& entity) {
    const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(Session()->Model());
    const int number = model->NextNumberForLabel(entity.c_str(), 0, true);
    if (number == 0) return "OpenCASCADE could not parse its entity";
    const Handle(StepShape_FaceSurface) face = Handle(StepShape_FaceSurface)::DownCast(model->Value(number));
    if (face.IsNull()) return "OpenCASCADE could not parse its entity";
    std::string reason = FirstMessage(Session()->TransferReader()->TransientProcess()->Check(face));
    if (reason.empty() && !face->FaceGeometry().IsNull()) {
      const Handle(Transfer_Binder) binder =
          Session()->TransferReader()->TransientProcess()->Find(face->FaceGeometry());
      if (!binder.IsNull()) reason = FirstMessage(binder->CCheck());
    }
    return reason.empty() ? "OpenCASCADE made no face of it and gave no reason" : reason;
  }

  const SourceFile& source_;
  StageProgress progress_;
  STEPCAFControl_Reader reader_;
  CadDocument document_;
};

}  // namespace

Result<CadDocument> ReadStep(const SourceFile& source, StageProgress progress) {
  return StepReader(source, progress).Run();
}

}  // namespace facetless
