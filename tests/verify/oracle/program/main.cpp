// facetless_oracle FILE... renders views, and lets the oracle judge samples of them.
//
// With --rays N, rays in all directions from N hits of each view are judged instead of the view's samples.
//
// For each view, standard output gets a table per certificate, followed by the first disagreements. FILE is a
// CAD file, which facetless-import reads, or a model file (.flm). Exit status: 0 no certified sample is
// wrong, 2 some are, 4 a file that cannot be read or rendered, 64 bad usage.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "render/model/model_file.h"
#include "server/importer/import_process.h"
#include "tests/verify/oracle/aim.h"
#include "tests/verify/oracle/judge.h"
#include "tests/verify/oracle/program/ray_hunt.h"

namespace facetless::oracle {
namespace {

struct Options {
  std::vector<std::string> files;
  std::vector<std::string> views = {"iso"};
  std::string precision = "standard";
  std::size_t samples = 10000, hard = 10000;
  std::uint64_t seed = 1;
  int size = 1024, close_ups = 24, list = 20;
  std::size_t rays = 0;
  std::string structure = "blocks";
  bool perspective = false;
};

Result<Model> Load(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".flm") return ReadModel(path);
  ImportRequest request;
  request.input = path;
  const Result<ImportedFiles> imported = RunImporter(request);
  if (!imported.ok()) return imported.error();
  return ReadModel(imported.value().model_path);
}

void Print(const std::string& title, const Tally& tally, const Model& model, int list, double seconds) {
  constexpr const char* kCertificates[] = {"certified", "converged", "unresolved"};
  std::printf("%s: %llu samples, %.1f s\n", title.c_str(), static_cast<unsigned long long>(tally.samples),
              seconds);
  for (std::size_t c = 0; c < tally.counts.size(); ++c) {
    std::uint64_t total = 0;
    for (const std::uint64_t count : tally.counts[c]) total += count;
    if (total == 0) continue;
    std::printf("  %-10s", kCertificates[c]);
    for (std::size_t v = 0; v < kVerdicts; ++v)
      std::printf(" %s %llu%s", VerdictName(static_cast<Verdict>(v)),
                  static_cast<unsigned long long>(tally.counts[c][v]), v + 1 < kVerdicts ? "," : "");
    std::printf("; depth off by up to %.2g mm (%.2g ulp of the diagonal, %.2g of the bound)\n",
                tally.largest_off_mm[c], tally.largest_off_mm[c] / (0x1p-52 * model.Diagonal()),
                tally.largest_share_of_bound[c]);
  }
  if (tally.other_face > 0)
    std::printf("  at the right depth on a coincident face: %llu\n",
                static_cast<unsigned long long>(tally.other_face));
  // List the worst first: wrong and certified, wrong, then the rest.
  int listed = 0;
  for (const bool wrong : {true, false}) {
    for (const Certificate certificate :
         {Certificate::kCertified, Certificate::kConverged, Certificate::kUnresolved}) {
      for (const Judgement& judgement : tally.list) {
        if (judgement.claim.certificate != certificate || (judgement.verdict == Verdict::kWrong) != wrong)
          continue;
        if (listed++ >= list) return;
        std::printf("    %s\n", Describe(judgement, model).c_str());
      }
    }
  }
}

class Hunt {
 public:
  Hunt(const Model& model, const Options& options)
      : model_(model), options_(options), scene_(model), oracle_(model), random_(options.seed) {
    direct_.depth_error = true;
    direct_.uv = options.rays > 0;
    direct_.accuracy.precision = options.precision == "fast"        ? Precision::kFast
                                 : options.precision == "certified" ? Precision::kCertified
                                                                    : Precision::kStandard;
  }

  // Returns the number of certified samples that are wrong.
  Result<std::uint64_t> View(const std::string& name, const std::string& view) {
    const Projection projection = options_.perspective ? Projection::kPerspective : Projection::kOrthographic;
    const Result<Camera> camera = NamedView(view, model_.bounds, projection, options_.size, options_.size);
    if (!camera.ok()) return camera.error();
    const Result<DirectResult> direct = TraceDirect(scene_, camera.value(), direct_);
    if (!direct.ok()) return direct.error();
    if (options_.rays > 0)
      return HuntRays(name + ", " + view, scene_, oracle_, camera.value(), direct.value(),
                      {options_.rays, options_.structure, options_.list}, random_);
    const SampleBuffer& samples = direct.value().samples;
    const std::vector<Vec3> features = Features(model_, options_.hard, random_);
    const std::string title = name + ", " + view;
    std::uint64_t wrong =
        Report(title + ", random", camera.value(), samples, RandomPixels(samples, options_.samples, random_));
    wrong += Report(title + ", hard", camera.value(), samples,
                    HardPixels(direct.value(), features, options_.hard, random_));
    // Close-ups show what is one pixel in the view: from a thousandth of the model down to 1e-9 of it.
    constexpr int kCloseSize = 33;  // odd, so that a pixel centre is exactly on the point
    constexpr std::size_t kCloseSamples = 200;
    for (int i = 0; i < options_.close_ups && !features.empty(); ++i) {
      const Vec3 point = features[random_.Below(static_cast<std::uint32_t>(features.size()))];
      const double window = model_.Diagonal() * std::pow(10.0, -random_.Uniform(3, 9));
      const Camera close = CloseUp(camera.value(), direct.value().frame, point, window, kCloseSize);
      const Result<DirectResult> closer = TraceDirect(scene_, close, direct_);
      if (!closer.ok()) return closer.error();
      char numbers[200];
      std::snprintf(numbers, sizeof numbers, ", close-up of %.17g,%.17g,%.17g through %.17g mm", point.x,
                    point.y, point.z, window);
      std::vector<std::uint32_t> pixels = HardPixels(closer.value(), {point}, kCloseSamples, random_);
      for (const std::uint32_t pixel : RandomPixels(closer.value().samples, kCloseSamples / 4, random_))
        pixels.push_back(pixel);
      wrong += Report(title + numbers, close, closer.value().samples, pixels);
    }
    return wrong;
  }

 private:
  std::uint64_t Report(const std::string& title, const Camera& camera, const SampleBuffer& samples,
                       const std::vector<std::uint32_t>& pixels) {
    const auto begin = std::chrono::steady_clock::now();
    const Judge judge(oracle_, camera);
    const Tally tally = JudgePixels(judge, samples, pixels);
    Print(title, tally, model_, options_.list,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    std::fflush(stdout);
    return tally.CertifiedWrong();
  }

  const Model& model_;
  const Options& options_;
  Scene scene_;
  Oracle oracle_;
  Random random_;
  DirectOptions direct_;
};

int Run(const Options& options) {
  int status = 0;
  for (const std::string& path : options.files) {
    const Result<Model> model = Load(path);
    if (!model.ok()) {
      std::fprintf(stderr, "%s: %s\n", path.c_str(), model.error().message.c_str());
      status = 4;
      continue;
    }
    Hunt hunt(model.value(), options);
    for (const std::string& view : options.views) {
      const Result<std::uint64_t> wrong = hunt.View(std::filesystem::path(path).filename().string(), view);
      if (!wrong.ok()) std::fprintf(stderr, "%s: %s\n", path.c_str(), wrong.error().message.c_str());
      if (!wrong.ok()) status = 4;
      if (wrong.ok() && wrong.value() > 0 && status == 0) status = 2;
    }
  }
  return status;
}

}  // namespace
}  // namespace facetless::oracle

int main(int argc, char** argv) {
  facetless::oracle::Options options;
  CLI::App app("Judges the direct renderer's samples by an oracle in extended precision");
  app.add_option("FILE", options.files, "CAD files, or model files (.flm)")->required();
  app.add_option("--view", options.views, "Names of views")->allow_extra_args(false);
  app.add_flag("--perspective", options.perspective, "Perspective views");
  app.add_option("--precision", options.precision, "What to render with")
      ->check(CLI::IsMember({"fast", "standard", "certified"}));
  app.add_option("--samples", options.samples, "Random samples of each view");
  app.add_option("--hard", options.hard,
                 "Most samples of each view beside edges, silhouettes, seams, vertices");
  app.add_option("--close-ups", options.close_ups, "Close-ups of each view, 250 samples each at most");
  app.add_option("--rays", options.rays, "Judge rays from so many hits of each view, and nothing else");
  app.add_option("--structure", options.structure, "What finds the candidates of those rays");
  app.add_option("--seed", options.seed, "Of the random choice");
  app.add_option("--size", options.size, "Pixels of each side of the picture")->check(CLI::Range(1, 16384));
  app.add_option("--list", options.list, "List so many disagreements of each picture");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  return facetless::oracle::Run(options);
}
