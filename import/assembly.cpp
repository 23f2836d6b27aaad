#include "import/assembly.h"

#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <TDF_Label.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XCAFPrs.hxx>
#include <XCAFPrs_DocumentExplorer.hxx>
#include <XCAFPrs_IndexedDataMapOfShapeStyle.hxx>
#include <map>
#include <unordered_map>

#include "render/base/utf8.h"

namespace facetless {
namespace {

std::string NameOf(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (label.IsNull() || !label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  const TCollection_ExtendedString& text = name->Get();
  std::string utf8(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter buffer = utf8.data();
  utf8.resize(static_cast<std::size_t>(text.ToUTF8CString(buffer)));
  while (!utf8.empty() && utf8.back() == '\0') utf8.pop_back();
  return Printable(utf8);
}

// Collects the colours of faces: those of faces themselves and those of bodies within the prototype. Inner
// colours take precedence.
void CollectColors(const TDF_Label& label, Prototype& prototype) {
  XCAFPrs_IndexedDataMapOfShapeStyle styles;
  XCAFPrs::CollectStyleSettings(label, TopLoc_Location(), styles);
  // Write the outer shapes' colours first, and let the inner ones overwrite them.
  for (const TopAbs_ShapeEnum type :
       {TopAbs_COMPOUND, TopAbs_COMPSOLID, TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE}) {
    for (int i = 1; i <= styles.Extent(); ++i) {
      const TopoDS_Shape& shape = styles.FindKey(i);
      if (shape.ShapeType() != type || !styles.FindFromIndex(i).IsSetColorSurf()) continue;
      // The whole prototype's colour belongs to its occurrences, which may override it.
      if (shape.IsPartner(prototype.shape) && type != TopAbs_FACE) continue;
      TopTools_IndexedMapOfShape faces;
      TopExp::MapShapes(shape, TopAbs_FACE, faces);
      for (int f = 1; f <= faces.Extent(); ++f)
        prototype.colors[faces(f).TShape().get()] = ToColor(styles.FindFromIndex(i).GetColorSurfRGBA());
    }
  }
}

bool HasFaces(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return faces.Extent() > 0;
}

// Returns whether the file hides the shape of a label, or one of the label's layers.
bool IsHidden(const TDF_Label& label) {
  if (label.IsNull()) return false;
  if (!XCAFDoc_DocumentTool::ColorTool(label)->IsVisible(label)) return true;
  const Handle(XCAFDoc_LayerTool) layers = XCAFDoc_DocumentTool::LayerTool(label);
  TDF_LabelSequence of_label;
  layers->GetLayers(label, of_label);
  for (int i = 1; i <= of_label.Length(); ++i) {
    if (!layers->IsVisible(of_label.Value(i))) return true;
  }
  return false;
}

// Moves the hidden bodies and faces of a prototype into a prototype of their own; returns null if there are
// none. Faces keep their TShape.
TopoDS_Shape TakeOutHidden(const TDF_Label& label, Prototype& prototype) {
  TDF_LabelSequence parts;
  XCAFDoc_ShapeTool::GetSubShapes(label, parts);
  BRepTools_ReShape reshape;
  BRep_Builder builder;
  TopoDS_Compound hidden;
  builder.MakeCompound(hidden);
  bool any = false;
  for (int i = 1; i <= parts.Length(); ++i) {
    const TopoDS_Shape part = XCAFDoc_ShapeTool::GetShape(parts.Value(i));
    if (!IsHidden(parts.Value(i)) || !HasFaces(part)) continue;
    builder.Add(hidden, part);
    reshape.Remove(part);
    any = true;
  }
  if (!any) return {};
  prototype.shape = reshape.Apply(prototype.shape);
  return hidden;
}

bool IsSheet(const TopoDS_Shape& shape) {
  return shape.ShapeType() == TopAbs_FACE || shape.ShapeType() == TopAbs_SHELL;
}

}  // namespace

Color ToColor(const Quantity_ColorRGBA& color) {
  double r, g, b;
  color.GetRGB().Values(r, g, b, Quantity_TOC_sRGB);
  return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b), color.Alpha()};
}

Handle(TDocStd_Document) NewXcafDocument() {
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  XCAFDoc_DocumentTool::Set(document->Main());
  return document;
}

namespace {

// Collects the prototypes and occurrences of an XCAF document.
class AssemblyWalk {
 public:
  AssemblyWalk(const std::string& name, const std::vector<OccurrenceColor>& colors, CadDocument& document)
      : name_(name), colors_(colors), document_(document) {}

  void Visit(const XCAFPrs_DocumentExplorer& explorer) {
    const XCAFPrs_DocumentNode& node = explorer.Current();
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(node.RefLabel);
    if (shape.IsNull() || !HasFaces(shape)) return;
    bool hidden = false;
    for (int depth = 0; depth <= explorer.CurrentDepth(); ++depth) {
      const XCAFPrs_DocumentNode& step = explorer.Current(depth);
      hidden = hidden || IsHidden(step.Label) || IsHidden(step.RefLabel);
    }
    // Collect loose sheets, and keep the colour of each.
    if (explorer.CurrentDepth() == 0 && IsSheet(shape) && node.Location.IsIdentity()) {
      AddSheet(node, shape, loose_[hidden]);
      return;
    }
    // Create the prototype when it is first met, and a second one from its hidden parts.
    TCollection_AsciiString entry;
    TDF_Tool::Entry(node.RefLabel, entry);
    const auto [known, added] = prototypes_.try_emplace(entry.ToCString());
    if (added) known->second = AddPrototype(node.RefLabel, shape);
    Occurrence occurrence = OccurrenceAt(explorer);
    for (const bool hidden_part : {false, true}) {
      const std::optional<std::size_t> prototype = known->second.of[hidden_part];
      if (!prototype) continue;
      occurrence.prototype = *prototype;
      occurrence.hidden = hidden || hidden_part;
      document_.occurrences.push_back(occurrence);
    }
  }

  void Finish() {
    for (const bool hidden : {false, true}) {
      Loose& loose = loose_[hidden];
      if (!loose.any) continue;
      Occurrence occurrence;
      occurrence.prototype = document_.prototypes.size();
      occurrence.hidden = hidden;
      document_.occurrences.push_back(occurrence);
      document_.prototypes.push_back({name_, loose.shapes, std::move(loose.colors)});
    }
  }

 private:
  // The prototypes that one label of the document becomes: one of its visible shapes, one of its hidden
  // shapes.
  struct Prototypes {
    std::optional<std::size_t> of[2];
  };
  struct Loose {
    Loose() { BRep_Builder().MakeCompound(shapes); }
    TopoDS_Compound shapes;
    std::unordered_map<const void*, Color> colors;
    bool any = false;
  };

  void AddSheet(const XCAFPrs_DocumentNode& node, const TopoDS_Shape& shape, Loose& loose) {
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    if (node.Style.IsSetColorSurf()) {
      for (int f = 1; f <= faces.Extent(); ++f)
        loose.colors[faces(f).TShape().get()] = ToColor(node.Style.GetColorSurfRGBA());
    }
    Prototype own;
    own.shape = shape;
    CollectColors(node.RefLabel, own);
    for (const auto& [face, color] : own.colors) loose.colors[face] = color;
    BRep_Builder().Add(loose.shapes, shape);
    loose.any = true;
  }

  Prototypes AddPrototype(const TDF_Label& label, const TopoDS_Shape& shape) {
    Prototype prototype;
    prototype.name = NameOf(label);
    prototype.shape = shape;
    CollectColors(label, prototype);
    Prototype hidden = prototype;
    hidden.shape = TakeOutHidden(label, prototype);
    Prototypes added;
    for (Prototype* each : {&prototype, &hidden}) {
      if (each->shape.IsNull() || !HasFaces(each->shape)) continue;
      added.of[each == &hidden] = document_.prototypes.size();
      document_.prototypes.push_back(std::move(*each));
    }
    return added;
  }

  // Returns the occurrence with its placement, its colour, and its name, which is its path.
  Occurrence OccurrenceAt(const XCAFPrs_DocumentExplorer& explorer) const {
    const XCAFPrs_DocumentNode& node = explorer.Current();
    Occurrence occurrence;
    occurrence.placement = node.Location.Transformation();
    occurrence.location = node.Location;
    for (int depth = 0; depth <= explorer.CurrentDepth(); ++depth) {
      const XCAFPrs_DocumentNode& step = explorer.Current(depth);
      std::string text = NameOf(step.Label);
      // Occurrences without a name in the file take the name of their prototype's label.
      if (text.empty() || text.starts_with("=>[")) text = NameOf(step.RefLabel);
      if (text.empty()) continue;
      if (!occurrence.name.empty()) occurrence.name += "/";
      occurrence.name += text;
    }
    occurrence.has_color = node.Style.IsSetColorSurf();
    if (occurrence.has_color) occurrence.color = ToColor(node.Style.GetColorSurfRGBA());
    for (int depth = explorer.CurrentDepth(); depth >= 0; --depth) {
      if (const std::optional<Color> own = ColorOf(explorer.Current(depth))) {
        occurrence.has_color = true;
        occurrence.color = *own;
        break;
      }
    }
    return occurrence;
  }

  // Returns the colour that the file gives to one step of a path; nothing if it is the part's own colour.
  std::optional<Color> ColorOf(const XCAFPrs_DocumentNode& step) const {
    const TopoDS_Shape component = XCAFDoc_ShapeTool::GetShape(step.Label);
    std::optional<Color> of_part;
    for (const OccurrenceColor& given : colors_) {
      if (given.component.IsSame(component)) return given.color;
      if (given.component.IsPartner(component)) of_part = given.of_part;
    }
    return of_part;
  }

  const std::string& name_;
  const std::vector<OccurrenceColor>& colors_;
  CadDocument& document_;
  std::map<std::string, Prototypes> prototypes_;  // by label
  Loose loose_[2];                                // visible sheets, and hidden sheets
};

}  // namespace

void AddAssembly(const Handle(TDocStd_Document) & xcaf, const std::string& name,
                 const std::vector<OccurrenceColor>& colors, CadDocument& document) {
  AssemblyWalk walk(name, colors, document);
  for (XCAFPrs_DocumentExplorer explorer(xcaf, XCAFPrs_DocumentExplorerFlags_OnlyLeafNodes); explorer.More();
       explorer.Next())
    walk.Visit(explorer);
  walk.Finish();
}

namespace {

// Collects the largest parts of a shape all of whose faces are hidden.
void CollectHidden(const TopoDS_Shape& shape, const std::unordered_set<const void*>& hidden,
                   std::vector<TopoDS_Shape>& pieces) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  int count = 0;
  for (int f = 1; f <= faces.Extent(); ++f) count += hidden.contains(faces(f).TShape().get());
  if (count == 0) return;
  if (count == faces.Extent()) {
    pieces.push_back(shape);
    return;
  }
  for (TopoDS_Iterator child(shape); child.More(); child.Next()) CollectHidden(child.Value(), hidden, pieces);
}

}  // namespace

void HideFaces(const std::unordered_set<const void*>& hidden, CadDocument& document) {
  const std::size_t prototypes = document.prototypes.size();
  for (std::size_t p = 0; p < prototypes && !hidden.empty(); ++p) {
    std::vector<TopoDS_Shape> pieces;
    CollectHidden(document.prototypes[p].shape, hidden, pieces);
    if (pieces.empty()) continue;
    const bool all = pieces.size() == 1 && pieces[0].IsSame(document.prototypes[p].shape);
    if (!all) {
      Prototype apart = document.prototypes[p];
      TopoDS_Compound compound;
      BRep_Builder builder;
      builder.MakeCompound(compound);
      BRepTools_ReShape reshape;
      for (const TopoDS_Shape& piece : pieces) {
        builder.Add(compound, piece);
        reshape.Remove(piece);
      }
      apart.shape = compound;
      document.prototypes[p].shape = reshape.Apply(document.prototypes[p].shape);
      document.prototypes.push_back(std::move(apart));
    }
    const std::size_t occurrences = document.occurrences.size();
    for (std::size_t i = 0; i < occurrences; ++i) {
      if (document.occurrences[i].prototype != p) continue;
      if (all) {
        document.occurrences[i].hidden = true;
        continue;
      }
      Occurrence copy = document.occurrences[i];
      copy.prototype = document.prototypes.size() - 1;
      copy.hidden = true;
      document.occurrences.push_back(std::move(copy));
    }
  }
}

namespace {

// Counts how often each body below the shape is used. A body with two uses is placed twice instead of being
// converted twice.
void CountBodies(const TopoDS_Shape& shape, std::unordered_map<const void*, int>& uses) {
  if (shape.ShapeType() > TopAbs_SHELL) return;
  if (shape.ShapeType() != TopAbs_COMPOUND) {
    ++uses[shape.TShape().get()];
    return;
  }
  for (TopoDS_Iterator child(shape); child.More(); child.Next()) CountBodies(child.Value(), uses);
}

struct Placing {
  const std::unordered_map<const void*, int>& uses;
  std::unordered_map<const void*, std::size_t> prototypes;
  TopoDS_Compound rest;
  bool has_rest = false;
};

void Place(const TopoDS_Shape& shape, Placing& placing, const std::string& name, CadDocument& document) {
  BRep_Builder builder;
  if (shape.ShapeType() == TopAbs_COMPOUND) {
    for (TopoDS_Iterator child(shape); child.More(); child.Next())
      Place(child.Value(), placing, name, document);
    return;
  }
  const auto uses = placing.uses.find(shape.TShape().get());
  if (uses == placing.uses.end() || uses->second == 1 || !HasFaces(shape)) {
    builder.Add(placing.rest, shape);
    placing.has_rest = placing.has_rest || HasFaces(shape);
    return;
  }
  const auto [known, added] =
      placing.prototypes.try_emplace(shape.TShape().get(), document.prototypes.size());
  if (added) document.prototypes.push_back({name, shape.Located(TopLoc_Location()), {}});
  document.occurrences.push_back(
      {known->second, shape.Location().Transformation(), false, {}, {}, shape.Location()});
}

}  // namespace

void AddShape(const TopoDS_Shape& shape, const std::string& name, CadDocument& document) {
  std::unordered_map<const void*, int> uses;
  CountBodies(shape, uses);
  Placing placing{uses, {}, {}, false};
  BRep_Builder().MakeCompound(placing.rest);
  Place(shape, placing, name, document);
  if (!placing.has_rest) return;
  document.occurrences.push_back({document.prototypes.size(), gp_Trsf(), false, {}, {}, {}});
  document.prototypes.push_back({name, placing.rest, {}});
}

}  // namespace facetless
