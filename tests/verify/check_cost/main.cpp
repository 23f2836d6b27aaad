// Traces a model file once, so that tests/verify/check_cost/table can count its instructions:
// facetless_check_cost MODEL.flm none|share|all SIZE
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "render/model/model_file.h"
#include "render/trace/direct.h"
#include "render/view/camera.h"

namespace facetless {
namespace {

int Run(const std::string& path, CheckLevel level, int size) {
  const Result<Model> model = ReadModel(path);
  if (!model) {
    std::fprintf(stderr, "facetless_check_cost: %s\n", model.error().message.c_str());
    return 1;
  }
  Result<Camera> camera = NamedView("iso", model.value().bounds, Projection::kOrthographic, size, size);
  if (!camera) {
    std::fprintf(stderr, "facetless_check_cost: %s\n", camera.error().message.c_str());
    return 1;
  }
  DirectOptions options;
  options.accuracy.precision = Precision::kCertified;
  options.accuracy.check = level;
  options.execution.threads = 1;
  const Scene scene(model.value());
  const Result<DirectResult> result = TraceDirect(scene, camera.value(), options);
  if (!result) {
    std::fprintf(stderr, "facetless_check_cost: %s\n", result.error().message.c_str());
    return 1;
  }
  const DirectStats& stats = result.value().stats;
  std::printf("%llu roots, %llu rays\n", static_cast<unsigned long long>(stats.check.roots),
              static_cast<unsigned long long>(stats.check.rays));
  return stats.check.roots_contradicted + stats.check.rays_contradicted == 0 ? 0 : 1;
}

}  // namespace
}  // namespace facetless

int main(int count, char** arguments) {
  const std::map<std::string, facetless::CheckLevel> levels = {{"none", facetless::CheckLevel::kNone},
                                                               {"share", facetless::CheckLevel::kShare},
                                                               {"all", facetless::CheckLevel::kAll}};
  if (count != 4 || !levels.contains(arguments[2])) {
    std::fprintf(stderr, "usage: facetless_check_cost MODEL.flm none|share|all SIZE\n");
    return 64;
  }
  return facetless::Run(arguments[1], levels.at(arguments[2]), std::atoi(arguments[3]));
}
