#include "import/scaled_shapes.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Datum3D.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <cmath>
#include <map>

namespace facetless {
namespace {

// The rounding error of a stand-in's coefficients after a few products.
constexpr double kStandInError = 1e-9;

gp_Trsf WithLinear(const LinearMap& linear, const gp_XYZ& translation) {
  gp_Trsf out;
  out.SetValues(linear[0], linear[1], linear[2], translation.X(), linear[3], linear[4], linear[5],
                translation.Y(), linear[6], linear[7], linear[8], translation.Z());
  return out;
}

bool HasLinear(const gp_Trsf& transformation, const LinearMap& linear) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      if (!(std::fabs(transformation.Value(r + 1, c + 1) - linear[static_cast<std::size_t>(3 * r + c)]) <=
            kStandInError))
        return false;
    }
  }
  return true;
}

// Returns the map that one elementary placement represents.
gp_Trsf ResolvedOne(const gp_Trsf& transformation, const std::vector<LinearMap>& maps) {
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const LinearMap stand_in = StandIn(i);
    if (HasLinear(transformation, stand_in)) return WithLinear(maps[i], transformation.TranslationPart());
    if (HasLinear(transformation, Transposed(stand_in)))
      return WithLinear(maps[i], transformation.Inverted().TranslationPart()).Inverted();
  }
  return transformation;
}

bool IsScaled(const gp_Trsf& transformation) {
  return std::fabs(transformation.ScaleFactor() - 1) > kStandInError;
}

// Returns whether a placement within the shape is a stand-in.
bool HasStandIn(const TopoDS_Shape& shape, const std::vector<LinearMap>& maps) {
  if (!shape.Location().IsIdentity() && IsScaled(Resolved(shape.Location(), maps))) return true;
  if (shape.ShapeType() >= TopAbs_FACE) return false;
  for (TopoDS_Iterator child(shape, false, false); child.More(); child.Next()) {
    if (HasStandIn(child.Value(), maps)) return true;
  }
  return false;
}

// Returns the shape with the placements within it resolved. Scales are applied to copies of shapes.
TopoDS_Shape Rebuilt(const TopoDS_Shape& shape, CadDocument& document,
                     std::unordered_map<const void*, Color>& colors) {
  const gp_Trsf placement = Resolved(shape.Location(), document.linear_maps);
  TopoDS_Shape bare = shape.Located(TopLoc_Location());
  if (shape.ShapeType() == TopAbs_COMPOUND) {
    TopoDS_Compound compound;
    BRep_Builder builder;
    builder.MakeCompound(compound);
    for (TopoDS_Iterator child(bare, false, false); child.More(); child.Next())
      builder.Add(compound, Rebuilt(child.Value(), document, colors));
    bare = compound.Oriented(shape.Orientation());
  }
  if (IsScaled(placement)) return BakedShape(bare, placement, document, colors);
  return bare.Located(TopLoc_Location(placement));
}

}  // namespace

gp_Trsf Resolved(const TopLoc_Location& location, const std::vector<LinearMap>& maps) {
  if (maps.empty() || location.IsIdentity()) return location.Transformation();
  gp_Trsf product;
  for (TopLoc_Location rest = location; !rest.IsIdentity(); rest = rest.NextLocation()) {
    gp_Trsf one = ResolvedOne(rest.FirstDatum()->Transformation(), maps);
    one.Power(rest.FirstPower());
    product.Multiply(one);
  }
  return product;
}

TopoDS_Shape BakedShape(const TopoDS_Shape& shape, const gp_Trsf& transformation, CadDocument& document,
                        std::unordered_map<const void*, Color>& colors) {
  BRepBuilderAPI_Transform transform(shape, transformation, true);
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    const void* before = face.Current().TShape().get();
    const void* after = transform.ModifiedShape(face.Current()).TShape().get();
    if (const auto origin = document.origins.find(before); origin != document.origins.end()) {
      FaceOrigin copy = origin->second;
      // Mirroring reverses the orientation of a face.
      if (transformation.IsNegative()) copy.sense = -copy.sense;
      document.origins[after] = copy;
    }
    if (const auto color = colors.find(before); color != colors.end()) {
      const Color copy = color->second;
      colors[after] = copy;
    }
  }
  return transform.Shape();
}

void ResolvePlacements(CadDocument& document) {
  if (document.linear_maps.empty()) return;
  for (Prototype& prototype : document.prototypes) {
    if (HasStandIn(prototype.shape, document.linear_maps))
      prototype.shape = Rebuilt(prototype.shape, document, prototype.colors);
  }
  // Make one copy for each prototype and scale.
  std::map<std::pair<std::size_t, double>, std::size_t> copies;
  for (Occurrence& occurrence : document.occurrences) {
    const gp_Trsf whole = Resolved(occurrence.location, document.linear_maps);
    occurrence.placement = whole;
    if (!IsScaled(whole)) continue;
    const double scale = whole.ScaleFactor();
    gp_Trsf scaling;
    scaling.SetScale(gp_Pnt(), scale);
    const auto [copy, added] = copies.try_emplace({occurrence.prototype, scale}, document.prototypes.size());
    if (added) {
      Prototype baked = document.prototypes[occurrence.prototype];
      baked.shape = BakedShape(baked.shape, scaling, document, baked.colors);
      document.prototypes.push_back(std::move(baked));
    }
    occurrence.prototype = copy->second;
    occurrence.placement = whole.Multiplied(scaling.Inverted());
    // Remove the rounding error that remains in the scale.
    occurrence.placement.SetScaleFactor(1);
  }
  // Drop prototypes that only scaled occurrences used.
  std::vector<std::size_t> uses(document.prototypes.size());
  for (const Occurrence& occurrence : document.occurrences) ++uses[occurrence.prototype];
  std::vector<Prototype> kept;
  std::vector<std::size_t> index(document.prototypes.size());
  for (std::size_t i = 0; i < uses.size(); ++i) {
    index[i] = kept.size();
    if (uses[i] > 0) kept.push_back(std::move(document.prototypes[i]));
  }
  document.prototypes = std::move(kept);
  for (Occurrence& occurrence : document.occurrences) occurrence.prototype = index[occurrence.prototype];
}

void ScaleDocument(double scale, CadDocument& document) {
  if (document.unhealed_mm) *document.unhealed_mm *= scale;
  gp_Trsf scaling;
  scaling.SetScale(gp_Pnt(), scale);
  for (Prototype& prototype : document.prototypes)
    prototype.shape = BakedShape(prototype.shape, scaling, document, prototype.colors);
  for (Occurrence& occurrence : document.occurrences)
    occurrence.placement.SetTranslationPart(gp_Vec(occurrence.placement.TranslationPart() * scale));
}

}  // namespace facetless
