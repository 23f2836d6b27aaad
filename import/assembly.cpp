#include "import/assembly.h"

#include <BRep_Builder.hxx>
#include <TDF_Label.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XCAFPrs.hxx>
#include <XCAFPrs_DocumentExplorer.hxx>
#include <XCAFPrs_IndexedDataMapOfShapeStyle.hxx>
#include <map>
#include <unordered_map>

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
  return utf8;
}

Color ToColor(const Quantity_Color& color) {
  double r, g, b;
  color.Values(r, g, b, Quantity_TOC_sRGB);
  return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
}

// Colours of faces that are the faces' own or those of a body within the prototype, innermost first.
void CollectColors(const TDF_Label& label, Prototype& prototype) {
  XCAFPrs_IndexedDataMapOfShapeStyle styles;
  XCAFPrs::CollectStyleSettings(label, TopLoc_Location(), styles);
  // Write the outer shapes' colours first and let the inner ones overwrite them.
  for (const TopAbs_ShapeEnum type :
       {TopAbs_COMPOUND, TopAbs_COMPSOLID, TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE}) {
    for (int i = 1; i <= styles.Extent(); ++i) {
      const TopoDS_Shape& shape = styles.FindKey(i);
      if (shape.ShapeType() != type || !styles.FindFromIndex(i).IsSetColorSurf()) continue;
      // The whole prototype's colour is that of its occurrences, which may override it.
      if (shape.IsPartner(prototype.shape) && type != TopAbs_FACE) continue;
      TopTools_IndexedMapOfShape faces;
      TopExp::MapShapes(shape, TopAbs_FACE, faces);
      for (int f = 1; f <= faces.Extent(); ++f)
        prototype.colors[faces(f).TShape().get()] = ToColor(styles.FindFromIndex(i).GetColorSurf());
    }
  }
}

bool HasFaces(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return faces.Extent() > 0;
}

bool IsSheet(const TopoDS_Shape& shape) {
  return shape.ShapeType() == TopAbs_FACE || shape.ShapeType() == TopAbs_SHELL;
}

}  // namespace

Handle(TDocStd_Document) NewXcafDocument() {
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  XCAFDoc_DocumentTool::Set(document->Main());
  return document;
}

void AddAssembly(const Handle(TDocStd_Document) & xcaf, const std::string& name, CadDocument& document) {
  std::map<std::string, std::size_t> prototype_of_label;
  Prototype loose;
  loose.name = name;
  BRep_Builder builder;
  TopoDS_Compound loose_shapes;
  builder.MakeCompound(loose_shapes);
  bool has_loose = false;
  for (XCAFPrs_DocumentExplorer explorer(xcaf, XCAFPrs_DocumentExplorerFlags_OnlyLeafNodes); explorer.More();
       explorer.Next()) {
    const XCAFPrs_DocumentNode& node = explorer.Current();
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(node.RefLabel);
    if (shape.IsNull() || !HasFaces(shape)) continue;
    const bool styled = node.Style.IsSetColorSurf();
    // Gather loose sheets, keeping the colour of each.
    if (explorer.CurrentDepth() == 0 && IsSheet(shape) && node.Location.IsIdentity()) {
      TopTools_IndexedMapOfShape faces;
      TopExp::MapShapes(shape, TopAbs_FACE, faces);
      if (styled) {
        for (int f = 1; f <= faces.Extent(); ++f)
          loose.colors[faces(f).TShape().get()] = ToColor(node.Style.GetColorSurf());
      }
      Prototype own;
      own.shape = shape;
      CollectColors(node.RefLabel, own);
      for (const auto& [face, color] : own.colors) loose.colors[face] = color;
      builder.Add(loose_shapes, shape);
      has_loose = true;
      continue;
    }
    // Make the prototype when it is first met.
    TCollection_AsciiString entry;
    TDF_Tool::Entry(node.RefLabel, entry);
    const auto [known, added] = prototype_of_label.try_emplace(entry.ToCString(), document.prototypes.size());
    if (added) {
      Prototype prototype;
      prototype.name = NameOf(node.RefLabel);
      prototype.shape = shape;
      CollectColors(node.RefLabel, prototype);
      document.prototypes.push_back(std::move(prototype));
    }
    // Name the occurrence by its path.
    Occurrence occurrence;
    occurrence.prototype = known->second;
    occurrence.placement = node.Location.Transformation();
    occurrence.location = node.Location;
    for (int depth = 0; depth <= explorer.CurrentDepth(); ++depth) {
      const XCAFPrs_DocumentNode& step = explorer.Current(depth);
      std::string text = NameOf(step.Label);
      // Occurrences that the file does not name are called after their prototype's label.
      if (text.empty() || text.starts_with("=>[")) text = NameOf(step.RefLabel);
      if (text.empty()) continue;
      if (!occurrence.name.empty()) occurrence.name += "/";
      occurrence.name += text;
    }
    occurrence.has_color = styled;
    if (styled) occurrence.color = ToColor(node.Style.GetColorSurf());
    document.occurrences.push_back(std::move(occurrence));
  }
  if (has_loose) {
    loose.shape = loose_shapes;
    document.occurrences.push_back({document.prototypes.size(), gp_Trsf(), false, {}, {}, {}});
    document.prototypes.push_back(std::move(loose));
  }
}

namespace {

// True if two bodies below share their geometry: then it is worth placing it twice instead of converting it twice.
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
