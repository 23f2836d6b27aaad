// Does one part of a run once, on one thread, so that its instructions can be counted. callgrind cannot follow
// `facetless` itself: the sandboxed importer does not run under it. This program therefore starts from the files
// that the importer leaves.
//
//     facetless_run_cost compare|exact|mesh|lines|section MODEL.flm MESH.glb SIZE
//
// `compare` is the exact picture, the mesh's picture and their difference, with the default samples per pixel;
// `exact` is the preparation and the trace of the exact surfaces through pixel centres, and `mesh` the trace of the mesh; `lines` are the feature lines of a view whose samples are
// traced already; `section` is the area of a cut through the middle of the model.
//
// Only the function Counted is to be counted; loading and preparing are outside of it. Two builds are compared by
// the counts of their programs on the same files:
//
//     facetless-import part.step --model part.flm --mesh part.glb
//     export COUNT="valgrind --tool=callgrind --collect-atstart=no --toggle-collect=Counted"
//     $COUNT facetless_run_cost compare part.flm part.glb 1024
//
// tests/verify/run_cost/table does this for files and for all parts.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/baseline/mesh_file.h"
#include "render/baseline/tracer.h"
#include "render/compare/compare_view.h"
#include "render/lines/view_lines.h"
#include "render/model/model_file.h"
#include "render/trace/section_area.h"

namespace facetless {
namespace {

constexpr Execution kOneThread = {.threads = 1};
constexpr int kSamples = 4;

// Work returns a count of its results, which shows that it was done.
using Work = std::function<Result<std::uint64_t>()>;

struct Part {
  const Model& model;
  const Mesh& mesh;
  Camera camera;
  Scene scene;
  BaselineScene tree;
};

// Each of these prepares its work, and returns what is to be counted.
Result<Work> Compare(const Part& part) {
  return Work([&part]() -> Result<std::uint64_t> {
    const ExactSurfaces exact(part.scene, {});
    const Triangles triangles(part.tree, part.model, {}, 0);
    const Representation* const candidates[] = {&triangles};
    ViewOptions options;
    options.execution = kOneThread;
    options.samples = kSamples;
    const auto compared = CompareView(exact, candidates, part.model, part.camera, options);
    if (!compared) return compared.error();
    return compared.value().reference.counters.hits;
  });
}

Result<Work> TraceExact(const Part& part) {
  return Work([&part]() -> Result<std::uint64_t> {
    DirectOptions direct;
    direct.execution = kOneThread;
    const auto traced = TraceDirect(part.scene, part.camera, direct);
    if (!traced) return traced.error();
    return traced.value().stats.hits;
  });
}

Result<Work> TraceMesh(const Part& part) {
  return Work([&part]() -> Result<std::uint64_t> {
    const auto traced = TraceBaseline(part.tree, part.camera, {kOneThread});
    if (!traced) return traced.error();
    return traced.value().stats.hits;
  });
}

Result<Work> Lines(const Part& part) {
  DirectOptions direct;
  direct.execution = kOneThread;
  auto traced = TraceDirect(part.scene, part.camera, direct);
  if (!traced) return traced.error();
  return Work([&part, samples = std::move(traced).value()]() -> Result<std::uint64_t> {
    LineOptions options;
    options.execution = kOneThread;
    return FindLines(part.scene, part.camera, samples.frame, samples.samples, samples.frame, options).size();
  });
}

Result<Work> Section(const Part& part) {
  return Work([&part]() -> Result<std::uint64_t> {
    const SectionPlane plane{0.5 * (part.model.bounds.low + part.model.bounds.high), {1, 0, 0}};
    SectionAreaOptions options;
    options.execution = kOneThread;
    const auto measured = MeasureSection(part.scene, {&plane, 1}, 0, options);
    if (!measured) return measured.error();
    return measured.value().rows;
  });
}

const std::map<std::string, Result<Work> (*)(const Part&)> kWorks = {
    {"compare", Compare}, {"exact", TraceExact}, {"mesh", TraceMesh}, {"lines", Lines}, {"section", Section}};

}  // namespace
}  // namespace facetless

// Has C linkage, so that callgrind knows it by this name.
extern "C" [[gnu::noinline]] void Counted(const facetless::Work& work,
                                          std::optional<facetless::Result<std::uint64_t>>* result);
void Counted(const facetless::Work& work, std::optional<facetless::Result<std::uint64_t>>* result) {
  result->emplace(work());
}

namespace facetless {
namespace {

int Fail(const Error& error) {
  std::fprintf(stderr, "facetless_run_cost: %s\n", error.message.c_str());
  return 1;
}

int Run(const std::string& name, const std::string& model_path, const std::string& mesh_path, int size) {
  const Result<Model> model = ReadModel(model_path);
  if (!model) return Fail(model.error());
  const Result<Mesh> mesh = LoadMesh(mesh_path, {}, &model.value());
  if (!mesh) return Fail(mesh.error());
  const Result<Camera> camera = NamedView("iso", model.value().bounds, Projection::kOrthographic, size, size);
  if (!camera) return Fail(camera.error());
  Result<BaselineScene> tree = BaselineScene::Build(mesh.value(), kOneThread);
  if (!tree) return Fail(tree.error());
  const Part part{model.value(), mesh.value(), camera.value(), Scene(model.value()), std::move(tree).value()};
  const Result<Work> work = kWorks.at(name)(part);
  if (!work) return Fail(work.error());
  std::optional<Result<std::uint64_t>> result;
  Counted(work.value(), &result);
  if (!*result) return Fail(result->error());
  std::printf("%llu\n", static_cast<unsigned long long>(result->value()));
  return 0;
}

}  // namespace
}  // namespace facetless

int main(int count, char** arguments) {
  if (count != 5 || !facetless::kWorks.contains(arguments[1])) {
    std::fprintf(stderr,
                 "usage: facetless_run_cost compare|exact|mesh|lines|section MODEL.flm MESH.glb SIZE\n");
    return 64;
  }
  return facetless::Run(arguments[1], arguments[2], arguments[3], std::atoi(arguments[4]));
}
