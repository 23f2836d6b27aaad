#include "bench/model_bench.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <thread>
#include <tuple>
#include <utility>

#include "bench/model_tables.h"
#include "bench/sample_cost.h"
#include "bench/statistics.h"
#include "render/base/parallel.h"
#include "render/baseline/raw_tracer.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// A mesh that takes longer than this is made once.
constexpr double kCheapMs = 1000;
// A mesh is also made once if its importer takes longer than this, including the time of reading the file.
constexpr double kCheapImportMs = 4000;
// The angle by which the next view is turned about the target.
constexpr double kNextViewDeg = 5;
// Two depths of one ray agree if they differ by at most this share of the diagonal. An exact intersector with
// the usual tolerance of 1e-7 mm reaches this accuracy on parts of a metre; the error of any facet is much
// larger.
constexpr double kAgreeing = 1e-6;

struct FirstImage {
  double scene_ms = 0, prepare_ms = 0, trace_ms = 0, shade_ms = 0;
  std::uint64_t peak_bytes = 0;
  DirectStats stats;
  double total() const { return scene_ms + prepare_ms + trace_ms + shade_ms; }
};

struct MeshImage {
  double mesh_ms = 0, build_ms = 0, trace_ms = 0, shade_ms = 0;
  std::uint64_t peak_bytes = 0, structure_bytes = 0, mesher_peak_bytes = 0, triangles = 0, hits = 0;
  bool at_limit = false;
  double total() const { return mesh_ms + build_ms + trace_ms + shade_ms; }
};

// Returns the run with the median total.
template <typename Image>
Image MedianOf(std::vector<Image> runs) {
  std::sort(runs.begin(), runs.end(), [](const Image& a, const Image& b) { return a.total() < b.total(); });
  return runs[runs.size() / 2];
}

Json ImageJson(const FirstImage& image) {
  return {{"scene_ms", image.scene_ms},
          {"prepare_ms", image.prepare_ms},
          {"trace_ms", image.trace_ms},
          {"shade_ms", image.shade_ms},
          {"total_ms", image.total()},
          {"peak_bytes", image.peak_bytes},
          {"scene_bytes", image.stats.scene_bytes}};
}

Json ImageJson(const MeshImage& image) {
  if (image.at_limit) return {{"at_limit", true}, {"total_ms", image.total()}};
  return {{"mesh_ms", image.mesh_ms},
          {"build_ms", image.build_ms},
          {"trace_ms", image.trace_ms},
          {"shade_ms", image.shade_ms},
          {"total_ms", image.total()},
          {"peak_bytes", image.peak_bytes},
          {"structure_bytes", image.structure_bytes},
          {"mesher_peak_bytes", image.mesher_peak_bytes},
          {"triangles", image.triangles},
          {"hits", image.hits},
          {"at_limit", false}};
}

// Returns the camera turned about its target.
Camera Turned(Camera camera) {
  const Vec3 axis = Normalized(camera.up), arm = camera.eye - camera.target;
  const double angle = kNextViewDeg * std::numbers::pi / 180;
  const Vec3 along = Dot(arm, axis) * axis;
  camera.eye = camera.target + along + std::cos(angle) * (arm - along) + std::sin(angle) * Cross(axis, arm);
  return camera;
}

class Measurement {
 public:
  Measurement(const BenchCase& bench_case, const ImporterSide& importer, const BenchOptions& options)
      : case_(bench_case), importer_(importer), options_(options) {
    all_threads_ = options.execution.threads > 0
                       ? options.execution.threads
                       : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    costs_.details = {{"file", case_.file},
                      {"view", case_.camera.name},
                      {"convert_ms", case_.model->info.convert_ms},
                      {"threads", Json::object()}};
  }

  Result<ModelCosts> Run() {
    if (auto done = MeasureImages(); !done) return done.error();
    for (const int threads : ThreadCounts()) {
      if (auto done = MeasureTracing(threads); !done) return done.error();
      if (auto done = MeasureNextView(threads); !done) return done.error();
      if (auto done = MeasureSamples(threads); !done) return done.error();
    }
    if (auto done = MeasureCores(); !done) return done.error();
    if (auto done = MeasureExact(); !done) return done.error();
    return std::move(costs_);
  }

 private:
  std::vector<int> ThreadCounts() const {
    return all_threads_ > 1 ? std::vector<int>{1, all_threads_} : std::vector<int>{1};
  }

  ViewOptions ViewOptionsOf(int threads) const {
    ViewOptions view;
    view.execution = {threads, options_.execution.cancel};
    return view;
  }

  BenchValue ValueOf(const char* aim, int threads) const {
    BenchValue value;
    value.aim = aim;
    value.file = case_.file;
    value.view = case_.camera.name;
    value.threads = threads;
    return value;
  }

  // `advantage` is true for times: the ratio is other / direct. Otherwise it is direct / other.
  void Add(BenchValue value, double direct, double other, bool advantage, ValueUnit unit,
           std::size_t repetitions) {
    value.direct = direct;
    value.other = other;
    value.ratio = advantage ? other / direct : direct / other;
    value.unit = unit;
    value.repetitions = static_cast<int>(repetitions);
    costs_.values.push_back(std::move(value));
  }

  // The same for measurements that were made in turns; the ratio is the median of the ratios of the turns.
  void AddTurns(BenchValue value, const std::vector<double>& direct, const std::vector<double>& other,
                ValueUnit unit) {
    value.direct = Median(direct);
    value.other = Median(other);
    value.ratio = MedianRatio(direct, other);
    value.unit = unit;
    value.repetitions = static_cast<int>(direct.size());
    costs_.values.push_back(std::move(value));
  }

  // Renders from the model in memory to a shaded picture.
  Result<FirstImage> DirectImage(const Camera& camera, int threads) const {
    FirstImage image;
    std::optional<Scene> scene;
    image.scene_ms =
        MeasureMilliseconds([&] { RunWithThreads(threads, [&] { scene.emplace(*case_.model); }); });
    return DirectImage(*scene, camera, threads, image);
  }

  Result<FirstImage> DirectImage(const Scene& scene, const Camera& camera, int threads,
                                 FirstImage image) const {
    Result<View> view = RenderView(ExactSurfaces(scene, {}), *case_.model, camera, ViewOptionsOf(threads));
    if (!view) return view.error();
    image.stats = *std::move(view.value().direct);
    image.prepare_ms = image.stats.prepare_ms;
    image.trace_ms = image.stats.trace_ms;
    image.shade_ms = view.value().shade_ms;
    image.peak_bytes = view.value().peak_bytes;
    return image;
  }

  // Meshes once, and makes an image of the mesh for each number of threads. The mesher always has one thread.
  Result<std::map<int, MeshImage>> ImagesOfMesh(double deflection, bool* once) {
    Result<BenchMesh> made = importer_.tessellate(deflection);
    if (!made) return made.error();
    *once = !made.value().mesh || made.value().mesh_ms > kCheapMs || made.value().import_ms > kCheapImportMs;
    std::map<int, MeshImage> images;
    for (const int threads : ThreadCounts()) {
      MeshImage& image = images[threads];
      image.mesh_ms = made.value().mesh_ms;
      image.mesher_peak_bytes = made.value().mesher_peak_bytes;
      if (!made.value().mesh) {
        image.at_limit = true;
        stopped_[deflection] = made.value().stopped;
      } else if (auto done = CompleteImage(*made.value().mesh, threads, image); !done) {
        return done.error();
      }
    }
    if (made.value().mesh) meshes_[deflection] = made.value().mesh;
    return images;
  }

  Result<void> CompleteImage(const Mesh& mesh, int threads, MeshImage& image) const {
    Result<BaselineScene> tree = BaselineScene::Build(mesh, {.threads = threads});
    if (!tree) return tree.error();
    image.build_ms = tree.value().build_ms();
    image.structure_bytes = tree.value().mesh_bytes() + tree.value().bvh_peak_bytes();
    image.triangles = tree.value().triangles();
    const Triangles triangles(tree.value(), *case_.model, {}, 0);
    Result<View> view = RenderView(triangles, *case_.model, case_.camera, ViewOptionsOf(threads));
    if (!view) return view.error();
    image.trace_ms = view.value().counters.trace_ms;
    image.shade_ms = view.value().shade_ms;
    image.peak_bytes = view.value().peak_bytes;
    image.hits = view.value().counters.hits;
    return {};
  }

  // Measures rows 1, 2 and 7.
  Result<void> MeasureImages() {
    std::map<int, std::vector<FirstImage>> direct;
    std::map<double, std::map<int, std::vector<MeshImage>>> meshes;
    std::map<double, bool> once;
    for (int round = 0; round <= options_.repeats; ++round) {
      // The first round is the warm-up. A mesh that is made only once is measured in this round.
      for (const int threads : ThreadCounts()) {
        Result<FirstImage> image = DirectImage(case_.camera, threads);
        if (!image) return image.error();
        if (round > 0) direct[threads].push_back(image.value());
      }
      for (const double deflection : {kDefaultDeflection, kFineDeflection}) {
        bool& made_once = once[deflection];
        if (made_once || !importer_.tessellate) continue;
        Result<std::map<int, MeshImage>> images = ImagesOfMesh(deflection, &made_once);
        if (!images) return images.error();
        if (round == 0 && !made_once) continue;
        for (const auto& [threads, image] : images.value()) meshes[deflection][threads].push_back(image);
      }
    }
    for (const int threads : ThreadCounts()) {
      const FirstImage exact = MedianOf(direct[threads]);
      Json& details = costs_.details["threads"][std::to_string(threads)];
      details["direct"] = ImageJson(exact);
      details["counters"] = CountersJson(exact.stats);
      for (const auto& [deflection, name, aim] :
           {std::tuple{kDefaultDeflection, "mesh_1e-3", "first_image_default_mesh"},
            std::tuple{kFineDeflection, "mesh_1e-5", "first_image_fine_mesh"}}) {
        if (!importer_.tessellate) {
          Skip(aim, threads, "a model file has no B-rep to mesh");
          continue;
        }
        const std::vector<MeshImage>& runs = meshes[deflection][threads];
        const MeshImage image = MedianOf(runs);
        details[name] = ImageJson(image);
        AddImageRow(aim, threads, exact, image, runs.size());
        if (deflection == kFineDeflection) AddMemoryRow(threads, exact, image);
      }
    }
    return {};
  }

  void AddMemoryRow(int threads, const FirstImage& exact, const MeshImage& fine) {
    if (fine.at_limit) {
      Skip("memory", threads, stopped_[kFineDeflection]);
      Skip("memory_structures", threads, stopped_[kFineDeflection]);
      return;
    }
    Add(ValueOf("memory", threads), static_cast<double>(exact.peak_bytes),
        static_cast<double>(fine.peak_bytes), false, ValueUnit::kBytes, 1);
    Add(ValueOf("memory_structures", threads), static_cast<double>(exact.stats.scene_bytes),
        static_cast<double>(fine.structure_bytes), false, ValueUnit::kBytes, 1);
  }

  void Skip(const char* aim, int threads, const std::string& reason) {
    BenchValue value = ValueOf(aim, threads);
    value.skipped = reason;
    costs_.values.push_back(std::move(value));
  }

  void AddImageRow(const char* aim, int threads, const FirstImage& exact, const MeshImage& mesh,
                   std::size_t runs) {
    BenchValue value = ValueOf(aim, threads);
    value.at_limit = mesh.at_limit;
    Add(std::move(value), exact.total(), mesh.total(), true, ValueUnit::kMilliseconds, runs);
  }

  // Measures rows 3 and 4: the same rays through leaves and through triangles, both prepared.
  Result<void> MeasureTracing(int threads) {
    const Scene scene(*case_.model);
    std::map<double, BaselineScene> trees;
    for (const auto& [deflection, mesh] : meshes_) {
      Result<BaselineScene> tree = BaselineScene::Build(*mesh, {.threads = threads});
      if (!tree) return tree.error();
      trees.emplace(deflection, std::move(tree).value());
    }
    std::vector<double> standard, fast;
    std::map<double, std::vector<double>> baseline, raw;
    for (int round = 0; round <= options_.repeats; ++round) {
      for (const auto& [precision, rates] :
           {std::pair{Precision::kStandard, &standard}, {Precision::kFast, &fast}}) {
        DirectOptions direct;
        direct.accuracy.precision = precision;
        direct.execution = {threads, options_.execution.cancel};
        Result<DirectResult> traced = TraceDirect(scene, case_.camera, direct);
        if (!traced) return traced.error();
        if (round > 0) rates->push_back(Rate(traced.value().stats.rays, traced.value().stats.trace_ms));
        if (precision == Precision::kStandard && threads == 1)
          one_thread_samples_ = std::move(traced.value().samples);
      }
      for (const auto& [deflection, tree] : trees) {
        Result<BaselineResult> traced =
            TraceBaseline(tree, case_.camera, {{threads, options_.execution.cancel}});
        if (!traced) return traced.error();
        if (round > 0)
          baseline[deflection].push_back(Rate(traced.value().stats.rays, traced.value().stats.trace_ms));
        Result<RawResult> found = TraceRaw(tree, case_.camera, {threads, options_.execution.cancel});
        if (!found) return found.error();
        if (round > 0) raw[deflection].push_back(Rate(found.value().distance.size(), found.value().trace_ms));
      }
    }

    if (threads == 1) one_thread_rate_ = Median(standard);
    const auto add = [&](const char* aim, const std::vector<double>& rates,
                         const std::map<double, std::vector<double>>& others, double deflection) {
      if (const auto other = others.find(deflection); other != others.end())
        AddTurns(ValueOf(aim, threads), rates, other->second, ValueUnit::kRaysPerSecond);
      else if (importer_.tessellate)
        Skip(aim, threads, stopped_[deflection]);
    };
    add("trace_fine_mesh", standard, baseline, kFineDeflection);
    add("trace_default_mesh", standard, baseline, kDefaultDeflection);
    add("trace_fine_mesh_raw", standard, raw, kFineDeflection);
    add("trace_default_mesh_raw", standard, raw, kDefaultDeflection);
    add("trace_default_mesh_fast", fast, baseline, kDefaultDeflection);
    return {};
  }

  static double Rate(std::uint64_t rays, double ms) { return 1000 * static_cast<double>(rays) / ms; }

  // Measures row 6: the same view as the first view, and as the next view of a model that has already been
  // rendered.
  Result<void> MeasureNextView(int threads) {
    const Scene seen(*case_.model);
    if (Result<FirstImage> before = DirectImage(seen, case_.camera, threads, {}); !before)
      return before.error();
    const Camera camera = Turned(case_.camera);
    std::vector<double> first, next;
    for (int round = 0; round <= options_.repeats; ++round) {
      Result<FirstImage> as_first = DirectImage(camera, threads);
      if (!as_first) return as_first.error();
      Result<FirstImage> as_next = DirectImage(seen, camera, threads, {});
      if (!as_next) return as_next.error();
      if (round == 0) continue;
      first.push_back(as_first.value().total());
      next.push_back(as_next.value().total());
    }
    Add(ValueOf("next_view", threads), Median(next), Median(first), false, ValueUnit::kMilliseconds,
        next.size());
    return {};
  }

  // Measures row 11.
  Result<void> MeasureSamples(int threads) {
    const auto costs = MeasureSampleCosts(*case_.model, case_.camera, ViewOptionsOf(threads),
                                          {options_.samples, options_.repeats});
    if (!costs) return costs.error();
    AddTurns(ValueOf("samples", threads), costs.value().back().total_ms, costs.value().front().total_ms,
             ValueUnit::kMilliseconds);
    costs_.details["threads"][std::to_string(threads)]["samples"] = SampleCostsJson(costs.value());
    return {};
  }

  // Measures row 8.
  Result<void> MeasureCores() {
    if (std::thread::hardware_concurrency() < 2) {
      Skip("two_cores", 2, "the machine has one core");
      return {};
    }
    std::vector<double> one, two;
    for (int round = 0; round <= options_.repeats; ++round) {
      for (const auto& [threads, times] : {std::pair{1, &one}, {2, &two}}) {
        Result<FirstImage> image = DirectImage(case_.camera, threads);
        if (!image) return image.error();
        if (round > 0) times->push_back(image.value().total());
      }
    }
    Add(ValueOf("two_cores", 2), Median(two), Median(one), true, ValueUnit::kMilliseconds, two.size());
    return {};
  }

  // Measures row 5, and counts the rays on which both sides agree.
  Result<void> MeasureExact() {
    if (!importer_.intersect) return {};
    const Result<CameraFrame> frame = MakeFrame(case_.camera, case_.model->Diagonal());
    if (!frame) return frame.error();
    constexpr std::uint64_t kSeed = 20261122;
    std::mt19937_64 engine(kSeed);
    const std::size_t pixels = one_thread_samples_.size();
    std::vector<Ray> rays;
    std::vector<std::size_t> pixel_of_ray;
    for (int i = 0; i < kExactRays; ++i) {
      const std::size_t pixel = engine() % pixels;
      pixel_of_ray.push_back(pixel);
      const std::size_t width = static_cast<std::size_t>(case_.camera.width_px);
      const std::size_t column = pixel % width, row = pixel / width;
      rays.push_back(
          PixelRay(frame.value(), static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5));
    }
    Result<ExactAnswers> answers = importer_.intersect(rays);
    if (!answers) return answers.error();
    const std::vector<double>& depths = answers.value().depths;
    if (depths.empty()) {
      Skip("trace_exact_intersector", 1, "OpenCASCADE answered no ray within the time limit");
      return {};
    }
    Add(ValueOf("trace_exact_intersector", 1), one_thread_rate_,
        Rate(depths.size(), answers.value().trace_ms), false, ValueUnit::kRaysPerSecond, 1);

    std::uint64_t same = 0, hit_or_miss = 0;
    const double tolerance = kAgreeing * case_.model->Diagonal();
    for (std::size_t i = 0; i < depths.size(); ++i) {
      const double ours = one_thread_samples_.depth[pixel_of_ray[i]];
      const bool both_miss = std::isinf(ours) && std::isinf(depths[i]);
      same += both_miss || std::fabs(ours - depths[i]) <= tolerance;
      hit_or_miss += std::isinf(ours) != std::isinf(depths[i]);
    }
    costs_.details["exact_intersector"] = {
        {"rays", depths.size()}, {"trace_ms", answers.value().trace_ms}, {"seed", kSeed},
        {"same", same},          {"hit_or_miss_differs", hit_or_miss},   {"tolerance_mm", tolerance}};
    return {};
  }

  const BenchCase& case_;
  const ImporterSide& importer_;
  const BenchOptions& options_;
  int all_threads_ = 1;
  ModelCosts costs_;
  std::map<double, std::shared_ptr<const Mesh>> meshes_;  // by deflection, the last mesh that was made
  std::map<double, std::string> stopped_;                 // by deflection, the reason why there is no mesh
  double one_thread_rate_ = 0;
  SampleBuffer one_thread_samples_;
};

}  // namespace

Result<ModelCosts> MeasureModel(const BenchCase& bench_case, const ImporterSide& importer,
                                const BenchOptions& options) {
  return Measurement(bench_case, importer, options).Run();
}

}  // namespace facetless
