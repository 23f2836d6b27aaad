// Fuzz target: a model file that passes the checks is shaded, cut, measured, inspected and drawn as lines, in
// small pictures. The file's own bytes select the operations and the view.
#include "render/inspect/continuity.h"
#include "render/inspect/picture.h"
#include "render/lines/draw_lines.h"
#include "render/lines/view_lines.h"
#include "render/model/model_file.h"
#include "render/shade/shade.h"
#include "render/trace/section_area.h"
#include "tests/verify/fuzz/target.h"

namespace facetless {
namespace {

// Returns a number below `count` that depends on all bytes and on the number of the question.
std::size_t Choice(const std::uint8_t* data, std::size_t size, std::uint32_t question, std::size_t count) {
  std::uint32_t sum = 2166136261u + question;
  for (std::size_t i = 0; i < size; ++i) sum = (sum ^ data[i]) * 16777619u;
  return (sum >> 8) % count;
}

void LookAt(const Model& model, const std::uint8_t* data, std::size_t size) {
  const Vec3 center = model.bounds.center();
  const double diagonal = model.bounds.diagonal();
  Camera camera;
  camera.target = center;
  camera.eye = center + diagonal * (Choice(data, size, 0, 2) != 0 ? Vec3{1, -1, 1} : Vec3{0, 0, 0.25});
  camera.up = {0, 1, 0};
  camera.projection = Choice(data, size, 1, 2) != 0 ? Projection::kPerspective : Projection::kOrthographic;
  camera.height = diagonal;
  camera.width_px = camera.height_px = 12;
  DirectOptions options;
  options.execution.threads = 1;
  options.uv = true;
  options.accuracy.precision =
      std::array{Precision::kFast, Precision::kStandard, Precision::kCertified}[Choice(data, size, 2, 3)];
  options.accuracy.max_bytes = std::uint64_t{256} << 20;
  if (Choice(data, size, 3, 2) != 0) options.sections = {{center, {0.6, 0, 0.8}}};
  const Scene scene(model);
  const Result<DirectResult> direct = TraceDirect(scene, camera, options);
  if (!direct.ok()) return;
  const SampleBuffer& samples = direct.value().samples;
  const CameraFrame& frame = direct.value().frame;

  if (!options.sections.empty()) {
    SectionAreaOptions area;
    area.execution.threads = 1;
    area.max_bytes = options.accuracy.max_bytes;
    const Result<SectionArea> measured = MeasureSection(scene, options.sections, 0, area);
    Require(!measured.ok() || measured.value().area_mm2 >= 0);
  }

  ShadeOptions shading;
  shading.edges = true;
  shading.execution.threads = 1;
  const Result<Film> shaded = Shade(samples, frame, {}, shading);
  // It returns an error only for invalid samples, which the renderer does not produce.
  Require(shaded.ok());

  LineOptions line_options;
  line_options.sections = options.sections;
  line_options.execution.threads = 1;
  const std::vector<ViewLine> lines = FindLines(scene, camera, frame, samples, frame, line_options);
  Film film{camera.width_px, camera.height_px, {}};
  film.pixels.assign(std::size_t(film.width) * film.height, {1, 1, 1, 1});
  DrawLines(lines, &film);
  for (const auto& pixel : film.pixels) Require(pixel[0] >= 0 && pixel[1] >= 0 && pixel[2] >= 0);
  LinesSvg(lines, camera.width_px, camera.height_px, 0, "");

  Inspection inspection;
  // Skip studio, which is the first and no inspection.
  inspection.kind = static_cast<InspectionKind>(1 + Choice(data, size, 4, InspectionNames().size() - 1));
  const Result<InspectionView> view = Measure(model, &scene, samples, frame, inspection, {.threads = 1});
  if (view.ok()) {
    const Result<Film> drawn = Draw(model, &scene, samples, frame, view.value(), {});
    Require(drawn.ok() || drawn.error().code != ErrorCode::kNotFinite);
  }
  (void)MeasureContinuity(model, {.threads = 1});
}

}  // namespace
}  // namespace facetless

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const facetless::InputFile file;
  const auto model = facetless::ReadModel(file.Write(data, size));
  // Models with mutated counts would take minutes to draw.
  if (model.ok() && model.value().PlacedFaceCount() <= 1000) facetless::LookAt(model.value(), data, size);
  return 0;
}
