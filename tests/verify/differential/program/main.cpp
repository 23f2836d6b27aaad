// facetless_differential FILE... [--size N] [--view NAME]... [--list N] [--one-placement] prints the table of
// docs/accuracy-results.md for any CAD files.
//
// It writes one Markdown row per file and view to standard output, and with --list the first N differences of
// each verdict to standard error. Exit status: 0 no defect of ours, 2 some, 4 a file that one of the two
// cannot read, 64 bad usage.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/verify/differential/differential.h"

namespace facetless {
namespace {

struct Options {
  std::vector<std::string> files;
  int size = 512;
  int list = 0;
  bool one_placement = false;
  std::vector<std::string> views = {"iso", "iso-back"};
};

void PrintHead() {
  std::printf(
      "| file | faces | view | rays | both hit | within 1e-7 | hit/miss | at an edge: for ours | for "
      "reference | reference lost | "
      "invented | imprecise | "
      "ours lost | invented | imprecise | largest agreeing difference, mm | ours, ms | reference, ms |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void PrintRow(const std::string& name, const ComparedFile& file, const ViewComparison& view) {
  const auto count = [&](Verdict verdict) {
    return static_cast<unsigned long long>(view.counts[static_cast<std::size_t>(verdict)]);
  };
  std::printf(
      "| %s | %zu | %s | %llu | %llu | %.4f %% | %.4f %% | %llu | %llu | %llu | %llu | %llu | %llu | %llu | "
      "%llu | "
      "%.1e | %.0f | %.0f |\n",
      name.c_str(), file.reference.face_count(), view.view.c_str(),
      static_cast<unsigned long long>(view.rays), static_cast<unsigned long long>(view.both_hit),
      100 * view.ShareWithin(), 100 * view.ShareHitMiss(), count(Verdict::kEdgeForOurs),
      count(Verdict::kEdgeForReference), count(Verdict::kReferenceLost), count(Verdict::kReferenceInvented),
      count(Verdict::kReferenceImprecise), count(Verdict::kOursLost), count(Verdict::kOursInvented),
      count(Verdict::kOursImprecise), view.max_agreeing_mm, view.ours_ms, view.reference_ms);
  std::fflush(stdout);
}

void ListDifferences(const ComparedFile& file, const ViewComparison& view, int at_most) {
  std::array<int, kVerdicts> listed{};
  for (const Difference& difference : view.differences) {
    if (listed[static_cast<std::size_t>(difference.verdict)]++ >= at_most) continue;
    std::fprintf(stderr, "  %s %s\n", view.view.c_str(), Describe(difference, file).c_str());
  }
}

// Returns whether no defect of ours was found.
Result<bool> CompareFile(const std::string& path, const Options& options) {
  Result<ComparedFile> file = LoadBoth(path, options.one_placement);
  if (!file.ok()) return file.error();
  const Scene scene(file.value().model);
  bool clean = true;
  for (std::size_t i = 0; i < options.views.size(); ++i) {
    const Projection projection = i % 2 == 0 ? Projection::kOrthographic : Projection::kPerspective;
    const Result<Camera> camera =
        NamedView(options.views[i], file.value().model.bounds, projection, options.size, options.size);
    if (!camera.ok()) return camera.error();
    const Result<ViewComparison> view = CompareView(file.value(), scene, camera.value());
    if (!view.ok()) return view.error();
    PrintRow(std::filesystem::path(path).filename().string(), file.value(), view.value());
    ListDifferences(file.value(), view.value(), options.list);
    clean = clean && view.value().Defects() == 0;
  }
  return clean;
}

}  // namespace
}  // namespace facetless

int main(int argc, char** argv) {
  facetless::Options options;
  CLI::App app("The direct renderer against OpenCASCADE's exact intersector");
  app.add_option("FILE", options.files, "STEP or IGES files")->required();
  app.add_option("--size", options.size, "Pixels of each side of the picture")->check(CLI::Range(1, 4096));
  app.add_option("--list", options.list, "List so many differences of each kind");
  app.add_flag("--one-placement", options.one_placement, "Compare one placement of each part");
  app.add_option("--view", options.views, "Names of views: orthographic and perspective by turns")
      ->allow_extra_args(false);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  int status = 0;
  facetless::PrintHead();
  for (const std::string& path : options.files) {
    const facetless::Result<bool> clean = facetless::CompareFile(path, options);
    if (!clean.ok()) std::fprintf(stderr, "%s: %s\n", path.c_str(), clean.error().message.c_str());
    if (!clean.ok())
      status = 4;
    else if (!clean.value() && status == 0)
      status = 2;
  }
  return status;
}
