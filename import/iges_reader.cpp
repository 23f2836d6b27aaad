#include <BRep_Builder.hxx>
#include <IGESBasic_SingularSubfigure.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESGeom_BoundedSurface.hxx>
#include <IGESGeom_TrimmedSurface.hxx>
#include <Interface_Check.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "import/assembly.h"
#include "import/crash_note.h"
#include "import/readers.h"
#include "import/transfer_notes.h"

namespace facetless {
namespace {

constexpr int kPlane = 108, kBounded = 143, kTrimmed = 144, kBrepFace = 510;
constexpr std::array kSurfaces{kPlane, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196};
// Entities that OpenCASCADE does not convert to shapes: CSG primitives, swept solids, Boolean trees, and
// entities that consist of them.
constexpr std::array kUnread{150, 152, 154, 156, 158, 160, 162, 164, 168, 180, 184, 430};
constexpr std::array kCurves{100, 102, 104, 106, 110, 112, 126, 130};
constexpr std::array kLoops{141, 142, 508};

template <std::size_t N>
bool Contains(const std::array<int, N>& types, int type) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

// Returns whether the entity represents one face: a trimmed or bounded surface, the face of a B-rep, or a
// surface that no other entity uses.
bool IsFace(const IGESData_IGESEntity& entity) {
  const int type = entity.TypeNumber();
  if (type == kTrimmed || type == kBounded || type == kBrepFace) return true;
  return entity.SubordinateStatus() == 0 && Contains(kSurfaces, type);
}

// IGES files identify an entity by the number of its first line in the directory.
std::string Label(int directory_number) {
  std::string label = "D";
  return label.append(std::to_string(directory_number));
}

// Labels are padded to eight columns.
std::string Trimmed(const std::string& label) {
  const std::size_t first = label.find_first_not_of(' ');
  return first == std::string::npos ? std::string()
                                    : label.substr(first, label.find_last_not_of(' ') - first + 1);
}

void CountBounds(const Handle(IGESData_IGESEntity) & entity, FaceOrigin& origin) {
  if (const auto trimmed = Handle(IGESGeom_TrimmedSurface)::DownCast(entity); !trimmed.IsNull())
    origin.bounds = (trimmed->HasOuterContour() ? 1 : 0) + trimmed->NbInnerContours();
  if (const auto bounded = Handle(IGESGeom_BoundedSurface)::DownCast(entity); !bounded.IsNull())
    origin.bounds = bounded->NbBoundaries();
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
      reader_.SetLayerMode(true);
      if (reader_.ReadFile(source_.path.c_str()) != IFSelect_RetDone)
        return Error{ErrorCode::kFormatBroken,
                     source_.name + " is an IGES file that cannot be parsed; export the model again."};
      const Handle(IGESData_IGESModel) model = reader_.IGESModel();
      const auto written = model->GlobalSection().UnitName();
      document_.info.unit_mm = model->GlobalSection().UnitValue();
      document_.info.unit = UnitName(document_.info.unit_mm, written.IsNull() ? "" : written->ToCString());
      return {};
    } catch (const Standard_Failure& failure) {
      return Error{ErrorCode::kFormatBroken, source_.name + " is an IGES file that cannot be parsed (" +
                                                 failure.DynamicType()->Name() +
                                                 "); export the model again."};
    }
  }

  Handle(TransferNotes) Notes() {
    const Handle(IGESData_IGESModel) model = reader_.IGESModel();
    return new TransferNotes(reader_.WS(), [model](const Handle(Standard_Transient) & entity) {
      const Handle(IGESData_IGESEntity) known = Handle(IGESData_IGESEntity)::DownCast(entity);
      if (!known.IsNull() && model->Number(known) > 0) NoteEntity(Label(model->DNum(known)));
    });
  }

  void Transfer() {
    // Try the transfer with names and colours, then the transfer of shapes alone.
    try {
      OCC_CATCH_SIGNALS
      Handle(TDocStd_Document) xcaf = NewXcafDocument();
      const Handle(TransferNotes) notes = Notes();
      if (reader_.Transfer(xcaf, notes->Start())) AddAssembly(xcaf, source_.name, {}, document_);
    } catch (const Standard_Failure&) {
      document_.prototypes.clear();
      document_.occurrences.clear();
    }
    if (document_.prototypes.empty()) TransferShapes();
    if (document_.prototypes.empty()) {
      TransferFaces();
    } else {
      NoteOrigins();
    }
    NoteLosses();
    HideFaces(BlankedFaces(), document_);
  }

  // Returns the faces of entities that the file blanks. The surface under a trimmed one is often blanked, but
  // it is no face.
  std::unordered_set<const void*> BlankedFaces() {
    std::unordered_set<const void*> blanked;
    const Handle(IGESData_IGESModel) model = reader_.IGESModel();
    const Handle(Transfer_TransientProcess) process = reader_.WS()->TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const Handle(IGESData_IGESEntity) entity = model->Entity(i);
      constexpr int kSolid = 186, kShell = 514, kGroup = 402, kSubfigure = 408;
      const int type = entity->TypeNumber();
      const bool has_faces =
          IsFace(*entity) || type == kSolid || type == kShell || type == kGroup || type == kSubfigure;
      if (entity->BlankStatus() != 1 || !has_faces) continue;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
      if (shape.IsNull()) continue;
      for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next())
        blanked.insert(face.Current().TShape().get());
    }
    return blanked;
  }

  // Transfers each face separately. This is the last attempt.
  void TransferFaces() {
    const Handle(IGESData_IGESModel) model = reader_.IGESModel();
    BRep_Builder builder;
    TopoDS_Compound faces;
    builder.MakeCompound(faces);
    bool any = false;
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const Handle(IGESData_IGESEntity) entity = model->Entity(i);
      if (!IsFace(*entity)) continue;
      NoteEntity(Label(model->DNum(entity)));
      const TopoDS_Shape shape = TransferFace(entity);
      if (shape.IsNull()) continue;
      // The next transfer discards the results of this one.
      NoteOrigins();
      builder.Add(faces, shape);
      any = true;
    }
    if (!any) return;
    AddShape(faces, source_.name, document_);
    document_.info.warnings.push_back(
        "The file's shapes could not be read as a whole; its faces were read one by one.");
  }

  TopoDS_Shape TransferFace(const Handle(IGESData_IGESEntity) & entity) {
    try {
      OCC_CATCH_SIGNALS
      IGESControl_Reader plain(reader_.WS(), false);
      return plain.TransferEntity(entity) ? plain.OneShape() : TopoDS_Shape();
    } catch (const Standard_Failure&) {
      return {};
    }
  }

  void TransferShapes() {
    try {
      OCC_CATCH_SIGNALS
      IGESControl_Reader plain(reader_.WS(), false);
      const Handle(TransferNotes) notes = Notes();
      plain.TransferRoots(notes->Start());
      for (int i = 1; i <= plain.NbShapes(); ++i) {
        if (!plain.Shape(i).IsNull()) AddShape(plain.Shape(i), source_.name, document_);
      }
    } catch (const Standard_Failure&) {
      document_.prototypes.clear();
      document_.occurrences.clear();
    }
  }

  FaceOrigin OriginOf(const Handle(IGESData_IGESEntity) & entity) {
    FaceOrigin origin;
    origin.entity = Label(reader_.IGESModel()->DNum(entity));
    if (entity->HasShortLabel()) origin.name = Trimmed(entity->ShortLabel()->ToCString());
    CountBounds(entity, origin);
    return origin;
  }

  // Finds the entity of each face.
  void NoteOrigins() {
    const Handle(IGESData_IGESModel) model = reader_.IGESModel();
    const Handle(Transfer_TransientProcess) process = reader_.WS()->TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const Handle(IGESData_IGESEntity) entity = model->Entity(i);
      if (!IsFace(*entity)) continue;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
      if (shape.IsNull()) continue;
      const FaceOrigin origin = OriginOf(entity);
      for (TopExp_Explorer part(shape, TopAbs_FACE); part.More(); part.Next())
        document_.origins[part.Current().TShape().get()] = origin;
      arrived_.insert(origin.entity);
    }
  }

  // Lists what the file declares and OpenCASCADE did not transfer.
  void NoteLosses() {
    const Handle(IGESData_IGESModel) model = reader_.IGESModel();
    const Handle(Transfer_TransientProcess) process = reader_.WS()->TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const Handle(IGESData_IGESEntity) entity = model->Entity(i);
      if (Contains(kUnread, entity->TypeNumber()) && entity->SubordinateStatus() == 0) {
        const FaceOrigin body = OriginOf(entity);
        document_.info.faces_lost.push_back(
            {kNoIndex, body.name, body.entity,
             "it is a CSG or swept solid (type " + std::to_string(entity->TypeNumber()) +
                 "), and only boundary representations are read; export it as one"});
      }
      if (const auto instance = Handle(IGESBasic_SingularSubfigure)::DownCast(entity);
          !instance.IsNull() && TransferBRep::ShapeResult(process, entity).IsNull()) {
        const FaceOrigin body = OriginOf(entity);
        const bool scaled = instance->ScaleFactor() != 1;
        document_.info.faces_lost.push_back(
            {kNoIndex, body.name, body.entity,
             scaled ? "OpenCASCADE does not place subfigures that are scaled; export their geometry instead"
                    : "OpenCASCADE could not place this instance of a subfigure"});
      }
      if (!IsFace(*entity)) continue;
      const FaceOrigin origin = OriginOf(entity);
      document_.declared.push_back({origin.entity, origin.name});
      if (!arrived_.contains(origin.entity))
        document_.info.faces_lost.push_back(
            {kNoIndex, origin.name, origin.entity, ReasonFor(process, entity)});
    }
    // A curve or a loop without data is lost even if OpenCASCADE makes a face without it.
    for (const IgesEntity& entity : source_.iges.without_data) {
      const Loss loss{kNoIndex, "", Label(entity.directory), "its data are missing or cut off"};
      if (Contains(kLoops, entity.type)) document_.info.loops_lost.push_back(loss);
      if (Contains(kCurves, entity.type)) document_.info.edges_lost.push_back(loss);
    }
  }

  static std::string ReasonFor(const Handle(Transfer_TransientProcess) & process,
                               const Handle(IGESData_IGESEntity) & entity) {
    if (entity->TypeNumber() == kPlane && entity->FormNumber() == 0)
      return "a plane without bounds is no face";
    const Handle(Interface_Check) check = process->Check(entity);
    if (!check.IsNull() && check->NbFails() > 0) return std::string("OpenCASCADE: ") + check->CFail(1);
    return "OpenCASCADE did not convert it to a face and gave no reason";
  }

  const SourceFile& source_;
  StageProgress progress_;
  IGESCAFControl_Reader reader_;
  CadDocument document_;
  std::set<std::string> arrived_;  // entities of faces that OpenCASCADE made shapes of
};

}  // namespace

Result<CadDocument> ReadIges(const SourceFile& source, StageProgress progress) {
  return IgesReader(source, progress).Run();
}

}  // namespace facetless
