#include "tests/verify/extremes/catalogue.h"

namespace facetless::extremes {

const std::vector<Extreme>& Catalogue() {
  static const Rows rows = [] {
    Rows all;
    AddSizes(all);
    AddNets(all);
    AddSingularities(all);
    AddCoincidences(all);
    AddTrims(all);
    AddViews(all);
    AddRanges(all);
    return all;
  }();
  return rows;
}

}  // namespace facetless::extremes
