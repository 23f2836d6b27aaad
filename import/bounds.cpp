#include "import/bounds.h"

#include "import/bezier_pieces.h"
#include "render/model/bounds.h"

namespace facetless {
namespace {

double ToBezier(const Span& span, double native) {
  return PieceParameter(span.begin, span.end, span.map, native);
}

}  // namespace

Box3 FaceBounds(const Model& model, std::uint32_t face) {
  return FaceBounds(model, face, ToBezier);
}

Box3 PlacedBounds(const Model& model) {
  return Union(InstanceBounds(model, ToBezier));
}

}  // namespace facetless
