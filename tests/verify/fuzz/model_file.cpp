// Fuzz target: the model file. A model that passes the checks is rendered in a small picture.
#include "render/model/model_file.h"
#include "render/trace/direct.h"
#include "tests/verify/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const facetless::InputFile file;
  const auto model = facetless::ReadModel(file.Write(data, size));
  if (!model.ok()) return 0;
  // Models with mutated counts would take minutes to render.
  if (model.value().PlacedFaceCount() > 100) return 0;
  facetless::Camera camera;
  const facetless::Vec3 center = model.value().bounds.center();
  const double diagonal = model.value().bounds.diagonal();
  camera.target = center;
  camera.eye = center + facetless::Vec3{diagonal, -diagonal, diagonal};
  camera.up = {0, 0, 1};
  camera.height = diagonal;
  camera.width_px = camera.height_px = 16;
  facetless::DirectOptions options;
  options.execution.threads = 1;
  options.accuracy.max_bytes = std::uint64_t{256} << 20;
  const facetless::Scene scene(model.value());
  const auto result = facetless::TraceDirect(scene, camera, options);
  if (!result.ok()) return 0;
  const facetless::DirectStats& stats = result.value().stats;
  facetless::Require(stats.certified + stats.converged + stats.unresolved == stats.rays);
  return 0;
}
