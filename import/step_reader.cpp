#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_GeneralLib.hxx>
#include <Interface_Graph.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <Precision.hxx>
#include <RWStepAP214_GeneralModule.hxx>
#include <STEPCAFControl_ExternFile.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPConstruct_ExternRefs.hxx>
#include <STEPConstruct_Styles.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>
#include <StepAP214.hxx>
#include <StepAP214_Protocol.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionRelationship.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepGeom_DegenerateToroidalSurface.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepGeom_Surface.hxx>
#include <StepRepr_CharacterizedDefinition.hxx>
#include <StepRepr_GlobalUncertaintyAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_EdgeCurve.hxx>
#include <StepShape_EdgeLoop.hxx>
#include <StepShape_FaceBound.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_ManifoldSolidBrep.hxx>
#include <StepShape_OrientedEdge.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_VertexPoint.hxx>
#include <StepVisual_Colour.hxx>
#include <StepVisual_OverRidingStyledItem.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <cmath>
#include <memory>
#include <set>
#include <unordered_map>
#include <vector>

#include "import/assembly.h"
#include "import/crash_note.h"
#include "import/readers.h"
#include "import/scaled_shapes.h"
#include "import/transfer_notes.h"

namespace facetless {
namespace {

// The largest precision in mm that is accepted from a file. OpenCASCADE's reader has the same limit.
constexpr double kMostUncertainty = 1;

// Counts the bounds with edges, and the different edges, that the file gives to a face.
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

// OpenCASCADE's messages may begin with blanks and end in a full stop.
std::string Tidied(const std::string& message) {
  const std::size_t first = message.find_first_not_of(" .");
  return first == std::string::npos ? message
                                    : message.substr(first, message.find_last_not_of(" .") - first + 1);
}

// OpenCASCADE's checks of a file, without the check of edge curves. That check visits all entities that share
// an edge, for a message that is not used, and takes a fifth of a large file's time.
//
// If the library fails on an entity, the entity is skipped and noted. Otherwise the whole file would be lost.
class QuickChecks : public RWStepAP214_GeneralModule {
 public:
  QuickChecks(std::vector<Handle(Standard_Transient)>& failed, Handle(Standard_Transient) & last)
      : failed_(failed), last_(last) {}

  void FillSharedCase(const Standard_Integer number, const Handle(Standard_Transient) & entity,
                      Interface_EntityIterator& iterator) const override {
    last_ = entity;
    try {
      OCC_CATCH_SIGNALS
      RWStepAP214_GeneralModule::FillSharedCase(number, entity, iterator);
    } catch (const Standard_Failure&) {
      failed_.push_back(entity);
    }
  }

  void CheckCase(const Standard_Integer number, const Handle(Standard_Transient) & entity,
                 const Interface_ShareTool& sharers, Handle(Interface_Check) & check) const override {
    if (entity->IsKind(STANDARD_TYPE(StepShape_EdgeCurve))) return;
    last_ = entity;
    try {
      OCC_CATCH_SIGNALS
      RWStepAP214_GeneralModule::CheckCase(number, entity, sharers, check);
    } catch (const Standard_Failure&) {
      failed_.push_back(entity);
    }
  }

 private:
  std::vector<Handle(Standard_Transient)>& failed_;
  Handle(Standard_Transient) & last_;
};

// While this object lives, transfers leave shapes as the file has them (readers.cpp has the sequences).
class UnhealedTransfer {
 public:
  UnhealedTransfer() : before_(Interface_Static::CVal(kParameter)) {
    Interface_Static::SetCVal(kParameter, "Unhealed");
  }
  ~UnhealedTransfer() { Interface_Static::SetCVal(kParameter, before_.c_str()); }
  UnhealedTransfer(const UnhealedTransfer&) = delete;
  UnhealedTransfer& operator=(const UnhealedTransfer&) = delete;

 private:
  static constexpr const char* kParameter = "read.step.sequence";
  const std::string before_;
};

class StepReader {
 public:
  StepReader(const SourceFile& source, StageProgress progress) : source_(source), progress_(progress) {}

  Result<CadDocument> Run() {
    progress_("read", 0);
    document_.info.format = StepFormatName(source_.step.schema);
    document_.pcurves_in_file = source_.step.has_pcurves;
    document_.unhealed_mm = Precision::Confusion();
    for (const StepFace& face : source_.step.faces) names_[Label(face.id)] = face.name;
    if (Result<void> read = Read(); !read.ok()) return read.error();
    progress_("read", 1);
    progress_("transfer", 0);
    const UnhealedTransfer unhealed;
    Transfer();
    progress_("transfer", 1);
    return std::move(document_);
  }

 private:
  Handle(XSControl_WorkSession) Session() { return reader_.Reader().WS(); }

  Result<void> Read() {
    try {
      OCC_CATCH_SIGNALS
      // The reader's own initialisation has registered the slow checks.
      Interface_GeneralLib::SetGlobal(new QuickChecks(failed_, last_), StepAP214::Protocol());
      reader_.SetColorMode(true);
      reader_.SetNameMode(true);
      reader_.SetLayerMode(true);
      reader_.SetPropsMode(false);
      reader_.SetSHUOMode(true);
      if (reader_.ReadFile(source_.path.c_str()) != IFSelect_RetDone)
        return Error{ErrorCode::kFormatBroken,
                     source_.name + " is a STEP file that cannot be parsed; export the model again."};
      NoteFailures();
      ReadUnit();
      return {};
    } catch (const Standard_Failure& failure) {
      const std::string where =
          last_.IsNull() ? std::string()
                         : ", at or after an entity of type " + std::string(last_->DynamicType()->Name());
      return Error{ErrorCode::kFormatBroken, "OpenCASCADE failed while it read " + source_.name + where +
                                                 " (" + failure.DynamicType()->Name() +
                                                 "); export the model again, or as another version of STEP."};
    }
  }

  // Reports each entity on which the library failed, once.
  void NoteFailures() {
    std::set<std::string> named;
    const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(Session()->Model());
    for (const Handle(Standard_Transient) & entity : failed_) {
      std::string type = entity->DynamicType()->Name();
      const std::string label = Label(static_cast<std::uint64_t>(model->IdentLabel(entity)));
      if (named.insert(label).second)
        document_.info.warnings.push_back("OpenCASCADE failed on entity " + label + " (" + type +
                                          "); everything that depends on it may be missing.");
    }
  }

  Handle(TransferNotes) Notes() {
    const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(Session()->Model());
    return new TransferNotes(Session(), [model](const Handle(Standard_Transient) & entity) {
      // Entities that the library creates itself have no number.
      if (const int number = model->IdentLabel(entity); number > 0)
        NoteEntity(Label(static_cast<std::uint64_t>(number)));
    });
  }

  // Reads the length unit of the first context that has one. Files that mix units are read correctly, part by
  // part; the mixture is only reported.
  void ReadUnit() {
    const Handle(Interface_InterfaceModel) model = Session()->Model();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      Handle(StepRepr_GlobalUncertaintyAssignedContext) uncertainty;
      Handle(StepRepr_GlobalUnitAssignedContext) context =
          Handle(StepRepr_GlobalUnitAssignedContext)::DownCast(model->Value(i));
      if (const auto both = Handle(
              StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext)::DownCast(model->Value(i));
          !both.IsNull()) {
        context = both->GlobalUnitAssignedContext();
      } else if (const auto three =
                     Handle(StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx)::DownCast(
                         model->Value(i));
                 !three.IsNull()) {
        context = three->GlobalUnitAssignedContext();
        uncertainty = three->GlobalUncertaintyAssignedContext();
      }
      if (context.IsNull()) continue;
      STEPConstruct_UnitContext unit;
      unit.ComputeFactors(context);
      if (!unit.LengthDone()) continue;
      document_.info.unit_mm = unit.LengthFactor();
      if (!uncertainty.IsNull() && unit.ComputeTolerance(uncertainty) == 0 && unit.HasUncertainty())
        document_.unhealed_mm =
            std::clamp(unit.Uncertainty() * unit.LengthFactor(), *document_.unhealed_mm, kMostUncertainty);
      // If a body has no unit, the report names none.
      if (!source_.step_repair.unit_missing) document_.info.unit = UnitName(document_.info.unit_mm, "");
      return;
    }
  }

  void Transfer() {
    // Try the transfer with assemblies, names and colours.
    try {
      OCC_CATCH_SIGNALS
      xcaf_ = NewXcafDocument();
      const Handle(TransferNotes) notes = Notes();
      if (reader_.Transfer(xcaf_, notes->Start()))
        AddAssembly(xcaf_, source_.name, OccurrenceColors(), document_);
      whole_ = !document_.prototypes.empty();
    } catch (const Standard_Failure&) {
      Discard();
    }
    if (document_.prototypes.empty()) TransferShapes();
    if (document_.prototypes.empty()) {
      TransferPieces();
    } else {
      NoteOrigins();
    }
    document_.linear_maps = source_.step_repair.linear_maps;
    ResolvePlacements(document_);
    NoteLosses();
    if (whole_) NoteOccurrences();
    NoteExternalFiles();
  }

  // Reads the CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEMs: the colour of one occurrence that differs from the
  // colour of its part.
  std::vector<OccurrenceColor> OccurrenceColors() {
    std::vector<OccurrenceColor> colors;
    const Handle(Transfer_TransientProcess) process = Session()->TransferReader()->TransientProcess();
    const STEPConstruct_Styles styles(Session());
    const auto surface_color = [&](const Handle(StepVisual_StyledItem) & item) -> std::optional<Color> {
      Handle(StepVisual_Colour) surface, boundary, curve, rendered;
      double transparency = 0;
      bool is_component = false;
      Quantity_Color color;
      if (item.IsNull() ||
          !styles.GetColors(item, surface, boundary, curve, rendered, transparency, is_component) ||
          surface.IsNull() || !styles.DecodeColor(surface, color))
        return std::nullopt;
      return ToColor(Quantity_ColorRGBA(color, 1 - static_cast<float>(transparency)));
    };
    const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(Session()->Model());
    const auto entity = [&](std::uint64_t id) -> Handle(Standard_Transient) {
      const int number = model->NextNumberForLabel(Label(id).c_str(), 0, true);
      return number == 0 ? Handle(Standard_Transient)() : model->Value(number);
    };
    for (const StepStyleContext& style : source_.step.style_contexts) {
      const auto item = Handle(StepVisual_OverRidingStyledItem)::DownCast(entity(style.item));
      if (item.IsNull()) continue;
      const std::optional<Color> own = surface_color(item), of_part = surface_color(item->OverRiddenStyle());
      for (const std::uint64_t context : style.contexts) {
        const auto placed = Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(entity(context));
        if (!own || placed.IsNull()) continue;
        const Handle(StepRepr_ProductDefinitionShape) shape = placed->RepresentedProductRelation();
        if (shape.IsNull()) continue;
        const TopoDS_Shape component =
            TransferBRep::ShapeResult(process, shape->Definition().ProductDefinitionRelationship());
        if (!component.IsNull()) colors.push_back({component, *own, of_part});
      }
    }
    return colors;
  }

  void Discard() {
    document_.prototypes.clear();
    document_.occurrences.clear();
  }

  // Transfers shapes alone, without names and colours.
  void TransferShapes() {
    try {
      OCC_CATCH_SIGNALS
      STEPControl_Reader plain(Session(), false);
      const Handle(TransferNotes) notes = Notes();
      plain.TransferRoots(notes->Start());
      for (int i = 1; i <= plain.NbShapes(); ++i) {
        if (!plain.Shape(i).IsNull()) AddShape(plain.Shape(i), source_.name, document_);
      }
      if (!document_.prototypes.empty()) {
        document_.info.warnings.push_back(
            "The file's product structure could not be read; its shapes were read without names and "
            "colours.");
      }
    } catch (const Standard_Failure&) {
      Discard();
    }
  }

  // Transfers each body separately, and each face that belongs to none of them. This is the last attempt.
  void TransferPieces() {
    const Handle(Interface_InterfaceModel) model = Session()->Model();
    BRep_Builder builder;
    TopoDS_Compound pieces;
    builder.MakeCompound(pieces);
    bool any = false;
    for (const bool bodies : {true, false}) {
      for (int i = 1; i <= model->NbEntities(); ++i) {
        const Handle(Standard_Transient) entity = model->Value(i);
        const Handle(StepShape_FaceSurface) face = Handle(StepShape_FaceSurface)::DownCast(entity);
        const bool is_body = entity->IsKind(STANDARD_TYPE(StepShape_ManifoldSolidBrep)) ||
                             entity->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel));
        if (bodies ? !is_body : face.IsNull() || arrived_.contains(EntityOf(face))) continue;
        NoteEntity(Label(static_cast<std::uint64_t>(
            Handle(StepData_StepModel)::DownCast(Session()->Model())->IdentLabel(entity))));
        TopoDS_Shape shape = TransferPiece(entity);
        if (shape.IsNull()) continue;
        // The next transfer discards the results of this one, so note now what became of each face.
        NoteOrigins();
        if (document_.info.unit_mm != 1 && KeptFileUnits(entity, shape)) shape = InMillimetres(shape);
        builder.Add(pieces, shape);
        any = true;
      }
    }
    if (!any) return;
    AddShape(pieces, source_.name, document_);
    document_.info.warnings.push_back(
        "The file's shapes could not be read as a whole; its bodies and faces were read one by one.");
  }

  TopoDS_Shape TransferPiece(const Handle(Standard_Transient) & entity) {
    try {
      OCC_CATCH_SIGNALS
      STEPControl_Reader plain(Session(), false);
      return plain.TransferEntity(entity) ? plain.OneShape() : TopoDS_Shape();
    } catch (const Standard_Failure&) {
      return {};
    }
  }

  // Outside of its representation, OpenCASCADE may or may not find the unit of a shape. Compares the shape's
  // vertices with the numbers in the file: returns true if they are nearer to the numbers than to the numbers
  // in millimetres.
  bool KeptFileUnits(const Handle(Standard_Transient) & entity, const TopoDS_Shape& shape) {
    double in_file = 0, in_shape = 0;
    std::set<const void*> seen;
    std::vector<Handle(Standard_Transient)> open{entity};
    while (!open.empty()) {
      const Handle(Standard_Transient) next = open.back();
      open.pop_back();
      if (!seen.insert(next.get()).second) continue;
      if (const auto vertex = Handle(StepShape_VertexPoint)::DownCast(next); !vertex.IsNull()) {
        const auto point = Handle(StepGeom_CartesianPoint)::DownCast(vertex->VertexGeometry());
        for (int i = 1; !point.IsNull() && i <= point->NbCoordinates(); ++i)
          in_file = std::fmax(in_file, std::fabs(point->CoordinatesValue(i)));
        continue;
      }
      for (Interface_EntityIterator shared = Session()->Graph().Shareds(next); shared.More(); shared.Next())
        open.push_back(shared.Value());
    }
    for (TopExp_Explorer vertex(shape, TopAbs_VERTEX); vertex.More(); vertex.Next()) {
      const gp_Pnt p = BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current()));
      in_shape =
          std::fmax(in_shape, std::fmax(std::fabs(p.X()), std::fmax(std::fabs(p.Y()), std::fabs(p.Z()))));
    }
    if (!(in_file > 0) || !(in_shape > 0)) return false;
    const double scale = std::log(in_shape / in_file);
    return std::fabs(scale) < std::fabs(scale - std::log(document_.info.unit_mm));
  }

  TopoDS_Shape InMillimetres(const TopoDS_Shape& piece) {
    gp_Trsf scale;
    scale.SetScaleFactor(document_.info.unit_mm);
    std::unordered_map<const void*, Color> none;
    return BakedShape(piece, scale, document_, none);
  }

  std::string EntityOf(const Handle(StepShape_FaceSurface) & face) {
    return Label(static_cast<std::uint64_t>(
        Handle(StepData_StepModel)::DownCast(Session()->Model())->IdentLabel(face)));
  }

  // Notes the surfaces in a GEOMETRIC_SET, which represent themselves.
  void NoteSurfaces() {
    const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(Session()->Model());
    const Handle(Transfer_TransientProcess) process = Session()->TransferReader()->TransientProcess();
    for (const StepFace& face : source_.step.faces) {
      if (!face.bare) continue;
      const int number = model->NextNumberForLabel(Label(face.id).c_str(), 0, true);
      if (number == 0) continue;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process, model->Value(number));
      if (shape.IsNull()) continue;
      FaceOrigin origin;
      origin.entity = Label(face.id);
      origin.name = face.name;
      for (TopExp_Explorer part(shape, TopAbs_FACE); part.More(); part.Next()) {
        document_.origins[part.Current().TShape().get()] = origin;
        arrived_.insert(origin.entity);
      }
    }
  }

  FaceOrigin OriginOf(const Handle(StepShape_FaceSurface) & face) {
    FaceOrigin origin;
    origin.entity = EntityOf(face);
    if (const auto name = names_.find(origin.entity); name != names_.end()) origin.name = name->second;
    CountBounds(face, origin);
    origin.sense = face->SameSense() ? 1 : -1;
    if (const auto torus = Handle(StepGeom_DegenerateToroidalSurface)::DownCast(face->FaceGeometry());
        !torus.IsNull())
      origin.torus_part = torus->SelectOuter() ? 1 : -1;
    return origin;
  }

  // Finds the entity of each face, and what the file declares about it.
  void NoteOrigins() {
    const Handle(Interface_InterfaceModel) model = Session()->Model();
    const Handle(Transfer_TransientProcess) process = Session()->TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const Handle(StepShape_FaceSurface) face = Handle(StepShape_FaceSurface)::DownCast(model->Value(i));
      if (face.IsNull()) continue;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process, face);
      if (shape.IsNull()) continue;
      const FaceOrigin origin = OriginOf(face);
      for (TopExp_Explorer part(shape, TopAbs_FACE); part.More(); part.Next())
        document_.origins[part.Current().TShape().get()] = origin;
      arrived_.insert(origin.entity);
    }
    NoteSurfaces();
  }

  // Lists what the text declares and OpenCASCADE did not transfer.
  void NoteLosses() {
    const StepRepair& repair = source_.step_repair;
    for (const StepFace& face : source_.step.faces) {
      const std::string entity = Label(face.id);
      document_.declared.push_back({entity, face.name});
      if (const auto out = repair.faces_out.find(face.id); out != repair.faces_out.end()) {
        document_.info.faces_lost.push_back({kNoIndex, face.name, entity, out->second});
      } else if (!arrived_.contains(entity)) {
        document_.info.faces_lost.push_back({kNoIndex, face.name, entity, ReasonFor(entity)});
      }
    }
    for (const StepLostItem& item : repair.lost)
      document_.info.faces_lost.push_back({kNoIndex, item.name, item.entity, item.reason});
  }

  // Lists occurrences that have a placement but whose shape OpenCASCADE did not place.
  void NoteOccurrences() {
    const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(Session()->Model());
    const Handle(Transfer_TransientProcess) process = Session()->TransferReader()->TransientProcess();
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const auto placed = Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(model->Value(i));
      if (placed.IsNull() || !TransferBRep::ShapeResult(process, placed).IsNull()) continue;
      const Handle(StepRepr_ProductDefinitionShape) shape = placed->RepresentedProductRelation();
      if (shape.IsNull()) continue;
      const auto usage = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(
          shape->Definition().ProductDefinitionRelationship());
      if (usage.IsNull() || !TransferBRep::ShapeResult(process, usage).IsNull()) continue;
      // A part without a shape has no occurrence to place.
      const Handle(StepBasic_ProductDefinition) part = usage->RelatedProductDefinition();
      if (part.IsNull() || TransferBRep::ShapeResult(process, part).IsNull()) continue;
      const Handle(TCollection_HAsciiString) name = usage->Name();
      document_.info.faces_lost.push_back({kNoIndex,
                                           name.IsNull() ? std::string() : DecodeStepText(name->ToCString()),
                                           Label(static_cast<std::uint64_t>(model->IdentLabel(usage))),
                                           "OpenCASCADE could not place this occurrence of a part"});
    }
  }

  // Lists parts whose shape is in another file as lost. The importer receives one file, and its sandbox does
  // not allow it to open others.
  void NoteExternalFiles() {
    STEPConstruct_ExternRefs references(Session());
    references.LoadExternRefs();
    std::set<std::string> missing;
    for (int i = 1; i <= references.NbExternRefs(); ++i) {
      const Standard_CString file = references.FileName(i);
      if (file == nullptr || *file == '\0') continue;
      Handle(STEPCAFControl_ExternFile) read;
      if (reader_.ExternFile(file, read) && read->GetTransferStatus()) continue;
      // Several documents may refer to the same file.
      if (!missing.insert(file).second) continue;
      const Handle(StepBasic_ProductDefinition) part = references.ProdDef(i);
      const std::string entity =
          part.IsNull() ? std::string()
                        : Label(static_cast<std::uint64_t>(
                              Handle(StepData_StepModel)::DownCast(Session()->Model())->IdentLabel(part)));
      document_.info.faces_lost.push_back({kNoIndex, file, entity,
                                           "the shape of this part is in another file, '" +
                                               std::string(file) +
                                               "', which is not read; export the assembly as one file"});
      document_.info.warnings.push_back("The file refers to '" + std::string(file) +
                                        "' for the shape of a part; export the assembly as one file.");
    }
  }

  std::string ReasonFor(const std::string& entity) {
    const Handle(StepData_StepModel) model = Handle(StepData_StepModel)::DownCast(Session()->Model());
    const int number = model->NextNumberForLabel(entity.c_str(), 0, true);
    if (number == 0) return "OpenCASCADE could not parse its entity";
    const Handle(StepShape_FaceSurface) face = Handle(StepShape_FaceSurface)::DownCast(model->Value(number));
    if (face.IsNull()) return ReasonOf(model->Value(number));
    // The surface's own message is more precise than the face's.
    const Handle(Transfer_TransientProcess) process = Session()->TransferReader()->TransientProcess();
    std::string reason;
    if (face->FaceGeometry().IsNull()) return "its surface is missing";
    if (const Handle(Transfer_Binder) binder = process->Find(face->FaceGeometry()); !binder.IsNull())
      reason = FirstMessage(binder->CCheck());
    if (reason.empty()) reason = FirstMessage(process->Check(face->FaceGeometry()));
    if (reason.empty()) reason = FirstMessage(process->Check(face));
    if (!reason.empty()) reason = "OpenCASCADE: " + Tidied(reason);
    if (reason.empty() && !Session()->Graph().Sharings(face).More()) return "no entity of the file uses it";
    return reason.empty() ? "OpenCASCADE did not convert it to a face and gave no reason" : reason;
  }

  // Returns the reason for the loss of a surface that represents itself, or of an entity that OpenCASCADE
  // does not treat as a face.
  std::string ReasonOf(const Handle(Standard_Transient) & entity) {
    if (!entity->IsKind(STANDARD_TYPE(StepGeom_Surface))) return "OpenCASCADE could not parse its entity";
    const Handle(Transfer_TransientProcess) process = Session()->TransferReader()->TransientProcess();
    std::string reason;
    if (const Handle(Transfer_Binder) binder = process->Find(entity); !binder.IsNull())
      reason = FirstMessage(binder->CCheck());
    if (reason.empty()) reason = FirstMessage(process->Check(entity));
    return reason.empty() ? "OpenCASCADE did not convert this surface to a face and gave no reason"
                          : "OpenCASCADE: " + Tidied(reason);
  }

  const SourceFile source_;
  StageProgress progress_;
  std::vector<Handle(Standard_Transient)> failed_;  // entities on which OpenCASCADE fails
  Handle(Standard_Transient) last_;                 // the entity that it looked at last
  STEPCAFControl_Reader reader_;
  Handle(TDocStd_Document) xcaf_;
  CadDocument document_;
  bool whole_ = false;                                  // the file was read with its product structure
  std::unordered_map<std::string, std::string> names_;  // names of faces, by entity
  std::set<std::string> arrived_;                       // entities of faces that OpenCASCADE made shapes of
};

}  // namespace

Result<CadDocument> ReadStep(const SourceFile& source, StageProgress progress) {
  // The reader lives as long as the process. Destroying its hundred thousand entities would take a second
  // without any use.
  static auto& readers = *new std::vector<std::unique_ptr<StepReader>>;
  readers.push_back(std::make_unique<StepReader>(source, progress));
  return readers.back()->Run();
}

}  // namespace facetless
