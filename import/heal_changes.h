// What OpenCASCADE's healing changes of a body, for the truth report.
//
//     const BodyBefore before(body);
//     const TopoDS_Shape healed = …;
//     before.Describe(healed, became, entry);
//
//  1. Healing replaces faces and edges, and adds or replaces p-curves in place. BodyBefore therefore notes the p-curves
//     that the body stores before it is healed.
//  2. A new edge of a face is compared with that of the replaced edges of the face that it is nearest to.
#pragma once

#include <Geom2d_Curve.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <map>
#include <set>
#include <tuple>

#include "render/model/model.h"

namespace facetless {

class BodyBefore {
 public:
  explicit BodyBefore(const TopoDS_Shape& body);

  // Fills in the counts and the distance of `entry`. `became` returns what became of a face.
  void Describe(const TopoDS_Shape& healed,
                const std::function<TopoDS_Shape(const TopoDS_Shape& face)>& became, HealedBody& entry) const;

 private:
  // Of the edge, the surface and the use in the reversed direction.
  using Pcurves = std::map<std::tuple<const void*, const void*, bool>, Handle(Geom2d_Curve)>;
  static Pcurves StoredPcurves(const TopoDS_Shape& body);

  const TopoDS_Shape body_;
  std::set<const void*> faces_, edges_;  // TShapes
  Pcurves pcurves_;
};

}  // namespace facetless
