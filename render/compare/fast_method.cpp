#include "render/compare/fast_method.h"

#include <memory>
#include <utility>

namespace facetless {
namespace {

Result<std::unique_ptr<const Representation>> MakeFast(const MethodInput& input, double) {
  DirectOptions options = input.direct;
  options.accuracy.precision = Precision::kFast;
  options.accuracy.newton_tolerance = 0;
  options.accuracy.check = CheckLevel::kNone;
  return std::unique_ptr<const Representation>(
      std::make_unique<ExactSurfaces>(input.scene, std::move(options), input.name, input.title));
}

}  // namespace

Method FastMethod() {
  return {.name = "fast",
          .title = "Single precision",
          .help = "The exact surfaces, traced in single precision.",
          .setting = "",
          .usual = {},
          .make = MakeFast};
}

}  // namespace facetless
