#include "render/compare/exact_methods.h"

#include <memory>
#include <utility>

namespace facetless {
namespace {

Result<std::unique_ptr<const Representation>> MakeExact(const MethodInput& input, double) {
  DirectOptions options = input.direct;
  options.accuracy.max_bytes = input.max_bytes;
  return std::unique_ptr<const Representation>(
      std::make_unique<ExactSurfaces>(input.scene, std::move(options), input.name, input.title));
}

Result<std::unique_ptr<const Representation>> MakeFast(const MethodInput& input, double) {
  DirectOptions options = input.direct;
  options.accuracy.precision = Precision::kFast;
  options.accuracy.newton_tolerance = 0;
  options.accuracy.check = CheckLevel::kNone;
  return std::unique_ptr<const Representation>(
      std::make_unique<ExactSurfaces>(input.scene, std::move(options), input.name, input.title));
}

}  // namespace

Method ExactMethod() {
  return {
      .name = "certified",
      .title = "Certified",
      .help =
          "Newton–Cramer on leaves with a proven bound, found by BMSSM bitmaps, interval subdivision where "
          "no "
          "bound holds, and the edges of the model where faces meet.",
      .source = "Facetless (docs/methods.md); Skala's BMSSM; Sisojevs 2011, equations 10 to 13",
      .does_not = "A sample beside an edge, a silhouette or a pole may remain without a proof, and says so.",
      .make = MakeExact};
}

Method FastMethod() {
  return {.name = "fast",
          .title = "Single precision",
          .help = "The tracer of certified, in single precision.",
          .source = "Facetless (docs/methods.md)",
          .does_not =
              "Depths are exact to about 1e-6 of the model's size, and more samples remain without a proof.",
          .make = MakeFast};
}

}  // namespace facetless
