// facetless_audit FILE... [--size N] [--edges N [--seed N]] [--threads N] [--list N] looks for light through
// the seams of CAD files, and prints the table of docs/accuracy-results.md.
//
// It writes one Markdown row per file to standard output, and the first N leaking rays to standard error.
// With --edges, it uses N views that aim at edges instead of the 26 directions. Model files (.flm) are used
// as they are. Exit status: 0 no odd ray and no mismatch, 2 some, 4 a file that cannot be read, 64 bad usage.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "render/base/parallel.h"
#include "render/model/model_file.h"
#include "tests/verify/seams/sweep.h"

namespace facetless {
namespace {

struct Options {
  std::vector<std::string> files;
  int size = 512, edges = 0, threads = 0, list = 20;
  std::uint64_t seed = 1;
};

// Returns whether no ray leaks.
Result<bool> AuditFile(const std::string& path, const Options& options) {
  const bool is_model = std::filesystem::path(path).extension() == ".flm";
  const Result<Model> model = is_model ? ReadModel(path) : ImportedModel(path);
  if (!model.ok()) return model.error();
  const Scene scene(model.value());
  const Result<SweepResult> swept =
      Sweep(scene, options.edges > 0 ? AtEdges(model.value(), options.edges, options.size, options.seed)
                                     : Around(model.value(), options.size));
  if (!swept.ok()) return swept.error();
  const SweepResult& result = swept.value();
  std::size_t closed = 0;
  for (const Solid& solid : model.value().solids) closed += solid.closed;
  std::printf("| %s | %zu | %zu of %zu | %llu | %llu | %llu | %llu | %s | %llu |\n",
              std::filesystem::path(path).filename().c_str(), model.value().faces.size(), closed,
              model.value().solids.size(), static_cast<unsigned long long>(result.rays),
              static_cast<unsigned long long>(result.crossings),
              static_cast<unsigned long long>(result.seam_samples),
              static_cast<unsigned long long>(result.odd), closed > 0 ? "" : "no closed solid",
              static_cast<unsigned long long>(result.mismatched));
  std::fflush(stdout);
  for (std::size_t i = 0; i < result.leaking.size() && i < static_cast<std::size_t>(options.list); ++i) {
    const LeakingRay& ray = result.leaking[i];
    std::fprintf(stderr, "  %s, column %d, row %d%s%s: %s; %.3g px from edge %u, gap %.3g mm\n",
                 ray.view.c_str(), ray.column, ray.row, ray.odd ? ", odd" : "",
                 ray.mismatched ? ", mismatch" : "", ray.crossings.c_str(), ray.edge_px, ray.edge,
                 ray.gap_mm);
  }
  return result.odd + result.mismatched == 0;
}

}  // namespace
}  // namespace facetless

int main(int argc, char** argv) {
  facetless::Options options;
  CLI::App app(
      "Counts the rays that cross a closed solid an odd number of times, or meet something else backwards");
  app.add_option("FILE", options.files, "CAD files, or model files")->required();
  app.add_option("--size", options.size, "rays along each side of a view")->check(CLI::Range(1, 8192));
  app.add_option("--edges", options.edges, "views that aim at edges, instead of 26 directions")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--seed", options.seed, "of those views");
  app.add_option("--threads", options.threads, "0: all cores")->check(CLI::NonNegativeNumber);
  app.add_option("--list", options.list, "leaking rays to describe, per file")->check(CLI::NonNegativeNumber);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  std::printf(
      "| file | faces | closed solids | rays | crossings | seam samples | odd rays | | mismatches |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  int status = 0;
  facetless::RunWithThreads(options.threads, [&] {
    for (const std::string& file : options.files) {
      const facetless::Result<bool> clean = facetless::AuditFile(file, options);
      if (!clean.ok()) {
        std::fprintf(stderr, "facetless_audit: %s: %s\n", file.c_str(), clean.error().message.c_str());
        status = 4;
      } else if (!clean.value() && status == 0) {
        status = 2;
      }
    }
  });
  return status;
}
