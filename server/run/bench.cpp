#include "server/run/bench.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <thread>
#include <utility>

#include "bench/aims.h"
#include "bench/growth.h"
#include "bench/leaf_boxes.h"
#include "bench/leaf_search.h"
#include "bench/model_bench.h"
#include "bench/model_tables.h"
#include "bench/patch_scene.h"
#include "bench/plot.h"
#include "bench/prochazka.h"
#include "bench/sample_cost.h"
#include "bench/sisojevs.h"
#include "bench/skala.h"
#include "bench/stages.h"
#include "bench/structure_bench.h"
#include "bench/surface_rays.h"
#include "bench/volume_check.h"
#include "render/baseline/mesh_file.h"
#include "render/model/model_file.h"
#include "render/trade/quantity_text.h"
#include "render/voxel_files/voxel_file.h"
#include "render/voxels/voxelize.h"
#include "server/base/load_average.h"
#include "server/base/version.h"
#include "server/run/bench_import.h"
#include "server/run/bench_openvdb.h"
#include "server/run/bench_stages.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// Returns the processor's name as the system gives it, such as "Intel(R) Xeon(R) Processor"; empty if
// unknown.
std::string ProcessorName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t begin = line.find(": ");
    return begin == std::string::npos ? "" : line.substr(begin + 2);
  }
  return "";
}

Json MachineJson(double load) {
  return {{"processor", ProcessorName()},
          {"cores", std::thread::hardware_concurrency()},
          {"load_at_start", load}};
}

// Runs the importer for one file, and remembers how long meshing took.
class FileImporter {
 public:
  FileImporter(const ImportRequest& request, const Model& model, const BenchSettings& settings)
      : request_(request), model_(model), settings_(settings) {}

  Result<BenchMesh> Tessellate(double deflection) {
    // A mesher that has just started waits for its memory. If meshing was quick last time, two meshes are
    // made and the second one counts.
    constexpr double kQuickMeshMs = 200;
    double& last_ms = last_mesh_ms_[deflection];
    ImportRequest request = request_;
    request.meshes.assign(last_ms > 0 && last_ms < kQuickMeshMs ? 2 : 1, {.deflection = deflection});
    // The limit applies to meshing alone; reading may take longer.
    request.limits.mesh_timeout_s = settings_.time_limit_s * static_cast<double>(request.meshes.size());
    request.model_suffices = true;
    auto files = RunImporter(request);
    if (!files) return files.error();
    BenchMesh made;
    if (const auto& failure = files.value().mesh_failure) {
      const bool late = failure->reason == "timeout";
      if (!late && failure->reason != "memory") return failure->error;
      made.mesh_ms = 1000 * settings_.time_limit_s;
      made.stopped = late ? "meshing takes longer than " + NumberText(settings_.time_limit_s) + " s"
                          : "meshing needs more memory than --import-memory allows";
      return made;
    }
    auto mesh = LoadMesh(files.value().mesh_paths.back(), {}, &model_);
    if (!mesh) return mesh.error();
    made.mesh = std::make_shared<const Mesh>(std::move(mesh).value());
    const MesherReport& report = files.value().summary.meshes.back();
    last_ms = report.mesh_ms;
    made.mesh_ms = report.mesh_ms;
    made.mesher_peak_bytes = report.peak_bytes;
    made.import_ms = files.value().wall_ms;
    return made;
  }

  Result<ExactAnswers> Intersect(const std::vector<Ray>& rays, double near) {
    ImportRequest request = request_;
    request.exact.near = near;
    request.exact.seconds = settings_.exact_s;
    for (const Ray& ray : rays)
      request.exact.rays.push_back(
          {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z});
    request.limits.timeout_s += settings_.exact_s;
    auto files = RunImporter(request);
    if (!files) return files.error();
    return ExactAnswers{std::move(files.value().exact_depths), files.value().summary.exact_ms};
  }

 private:
  const ImportRequest request_;
  const Model& model_;
  const BenchSettings& settings_;
  std::map<double, double> last_mesh_ms_;  // by deflection
};

class Bench {
 public:
  Bench(const ImportRequest& request, const RunOptions& options, const BenchSettings& settings,
        const RunContext& context)
      : request_(request), options_(options), settings_(settings), context_(context) {
    load_ = LoadAverage();
    json_ = {{"facetless", ProgramJson(context.execution.threads)},
             {"command", "bench"},
             {"machine", MachineJson(load_)},
             {"files", Json::array()}};
  }

  Result<void> MeasureFile(const std::string& path) {
    Step(std::filesystem::path(path).filename().string());
    ImportRequest request = request_;
    request.input = path;
    // The input is a model file, or the model that the importer makes of a CAD file.
    Result<Model> read = ReadModel(path);
    const bool imported = !read;
    ImportedModel from_file;
    if (imported) {
      auto import = Import(request);
      if (!import) return import.error();
      from_file = std::move(import).value();
    } else {
      from_file.model = std::make_unique<const Model>(std::move(read).value());
    }
    const Model& model = *from_file.model;
    auto cameras = ResolveCameras(options_, model.bounds);
    if (!cameras) return cameras.error();
    FileImporter importer(request, model, settings_);
    if (settings_.structures) {
      const std::string name = std::filesystem::path(path).filename().string();
      if (auto done = MeasureScene({name, LeafBoxes(model, kMostBoxes)}); !done) return done.error();
      return MeasureRaysOf(name, model, cameras.value().front(), imported ? &importer : nullptr);
    }
    Json views = Json::array();
    for (const Camera& camera : cameras.value()) {
      if (settings_.published) {
        if (auto done = MeasureLeaves(std::filesystem::path(path).filename().string(), model, camera); !done)
          return done.error();
        continue;
      }
      const auto frame = MakeFrame(camera, model.Diagonal());
      if (!frame) return frame.error();
      const double near = frame.value().near_mm;
      ImporterSide side;
      if (imported) {
        side.tessellate = [&](double deflection) { return importer.Tessellate(deflection); };
        side.intersect = [&](const std::vector<Ray>& rays) { return importer.Intersect(rays, near); };
      }
      const BenchCase bench_case{std::filesystem::path(path).filename().string(), &model, camera};
      auto costs = MeasureModel(bench_case, side, {context_.execution, settings_.repeats, options_.samples});
      if (!costs) return costs.error();
      values_.insert(values_.end(), costs.value().values.begin(), costs.value().values.end());
      details_.push_back(costs.value().details);
      views.push_back(std::move(costs.value().details));
    }
    if (settings_.published) return MeasureVoxelsOf(std::filesystem::path(path).filename().string(), model);
    if (imported)
      if (auto done = MeasurePrograms(request); !done) return done.error();
    if (settings_.growth && !growth_measured_) {
      Step("growth");
      auto growth =
          MeasureGrowth(std::filesystem::path(path).filename().string(), model, cameras.value().front(), {});
      if (!growth) return growth.error();
      growth_measured_ = true;
      for (BenchValue& value : GrowthValues(growth.value())) values_.push_back(std::move(value));
      json_["growth"] = GrowthJson(growth.value());
      tables_.push_back(GrowthTable(growth.value()));
    }
    json_["files"].push_back({{"model", ImportedModelJson(from_file)},
                              {"convert_ms", model.info.convert_ms},
                              {"views", std::move(views)}});
    return {};
  }

  // Measures what processes of their own do with a CAD file.
  Result<void> MeasurePrograms(const ImportRequest& request) {
    const std::string name = std::filesystem::path(request.input).filename().string();
    Step(name + ": import");
    auto values = MeasureImport(name, request, settings_.repeats);
    if (!values) return values.error();
    for (BenchValue& value : values.value()) values_.push_back(std::move(value));
    if (!settings_.stages) return {};
    Step(name + ": stages");
    auto runs = MeasureStages(request.input, options_, settings_.repeats, context_.execution);
    if (!runs) return runs.error();
    for (ProgramStages& run : runs.value()) stages_.push_back(std::move(run));
    return {};
  }

  Result<void> MeasurePublished() {
    Step("BMSSM");
    const std::vector<SkalaCell> skala = MeasureSkala(settings_.repeats);
    json_["published"]["skala"] = SkalaJson(skala);
    for (Table& table : SkalaTables(skala)) tables_.push_back(std::move(table));
    json_["published"]["sisojevs"] = Json::array();
    for (const ThesisTable& table : ThesisTables()) {
      std::vector<ThesisScene> scenes;
      for (const NamedScene& scene : table.scenes) {
        Step("table " + std::to_string(table.number) + ": " + scene.name);
        auto measured =
            MeasureThesisScene(table, scene, {.repeats = settings_.repeats, .execution = context_.execution});
        if (!measured) return measured.error();
        scenes.push_back(std::move(measured).value());
      }
      json_["published"]["sisojevs"].push_back(ThesisJson(table, scenes));
      for (Table& text : ThesisTexts(table, scenes)) tables_.push_back(std::move(text));
    }
    return {};
  }

  Result<void> MeasureRandomScenes() {
    for (const BoxScenery& scene : RandomBoxSceneries())
      if (auto done = MeasureScene(scene); !done) return done.error();
    return {};
  }

  Result<void> MeasureLeaves(const std::string& name, const Model& model, const Camera& camera) {
    auto searches = MeasureLeafSearches(name, model, camera, settings_.repeats);
    if (!searches) return searches.error();
    json_["published"]["leaf_searches"].push_back(LeafSearchJson(searches.value()));
    tables_.push_back(LeafSearchTable(searches.value()));
    return {};
  }

  // The tables of voxels: the cube, and after the files those that they hold.
  Result<void> MeasureCube() { return AddVoxels(CubeOfThesis()); }
  Result<void> MeasureVoxelFile(const std::string& path) {
    Result<VoxelFile> file = ReadVoxels(path, options_.accuracy.max_bytes);
    if (!file) return file.error();
    const VoxelModel& voxels = *file.value().model;
    const VoxelGrid grid = file.value().grid.value_or(VoxelGrid{{0, 0, 0}, 1, voxels.size()});
    return AddVoxels({std::filesystem::path(path).stem().string(), RunsOf(voxels), grid});
  }
  Result<void> MeasureVoxelsOf(const std::string& name, const Model& model) {
    const Scene scene(model);
    for (const int resolution : {128, 256, 512}) {
      const Result<VoxelGrid> grid = GridOfResolution(model.bounds, resolution);
      if (!grid) return grid.error();
      std::string title = name + " " + std::to_string(resolution);
      Result<Voxels> voxels =
          Voxelize(scene, grid.value(), {.accuracy = options_.accuracy}, context_.execution);
      if (voxels.ok() && voxels.value().model.Count() == 0) {
        // Without a closed solid, the surface is shown.
        title += ", surface";
        voxels = Voxelize(scene, grid.value(), {.fill = VoxelFill::kSurface, .accuracy = options_.accuracy},
                          context_.execution);
      }
      if (!voxels) return voxels.error();
      auto done = AddVoxels({title, std::move(voxels.value().model), grid.value()});
      if (!done) return done.error();
    }
    return {};
  }

  BenchReport Take() && {
    json_["rows"] = Json::array();
    for (const AimSummary& summary : Summarise(values_)) json_["rows"].push_back(SummaryJson(summary));
    json_["values"] = Json::array();
    for (const BenchValue& value : values_) json_["values"].push_back(ValueJson(value));
    const TableStyle style = settings_.markdown ? TableStyle::kMarkdown : TableStyle::kText;
    if (!values_.empty()) {
      tables_.insert(tables_.begin(), {AimTable(values_), ValueTable(values_), CostTable(details_),
                                       CounterTable(details_), SampleTable(details_)});
    }
    for (Table& table : StageTables(stages_)) tables_.push_back(std::move(table));
    for (Table& table : VoxelTables(voxels_)) tables_.push_back(std::move(table));
    for (const ProgramStages& run : stages_) json_["stages"].push_back(StagesJson(run));
    BenchReport report;
    report.text = Heading();
    for (const Table& table : tables_) report.text += TableText(table, style);
    report.plot = settings_.structures ? SurfaceRayPlot(surface_rays_) : FirstImagePlot(values_, 1);
    report.stage_plot = StagePlot(stages_);
    report.json = std::move(json_);
    return report;
  }

 private:
  // The load average, in processes, above which the machine is called busy: the bench itself counts as one,
  // and half a process is tolerated.
  static constexpr double kQuiet = 1.5;
  // The largest number of boxes that a file's surfaces are divided into.
  static constexpr std::size_t kMostBoxes = 200'000;

  Result<void> MeasureScene(const BoxScenery& scene) {
    Step(scene.name);
    auto bench = MeasureStructures(scene.name, scene.boxes, BoxEntry{scene.boxes}, {settings_.repeats});
    if (!bench) return bench.error();
    Box3 bounds;
    for (const Box3& box : scene.boxes) bounds.Add(box.low), bounds.Add(box.high);
    const std::vector<VolumeCheck> volumes =
        CheckVolumeModel(scene.boxes, RandomRays(bounds, StructureBenchSettings().rays));
    Json json = StructureJson(bench.value());
    json["volumes"] = VolumeJson(volumes);
    json_["structures"].push_back(std::move(json));
    for (Table& table : StructureTables(bench.value())) tables_.push_back(std::move(table));
    tables_.push_back(VolumeTable(scene.name, volumes));
    return {};
  }

  // Measures rays that start on the surfaces of a model. `importer` makes the mesh; null: there is none.
  Result<void> MeasureRaysOf(const std::string& name, const Model& model, const Camera& camera,
                             FileImporter* importer) {
    constexpr double kDeflection = 1e-3;
    BenchMesh made;
    if (importer != nullptr) {
      auto mesh = importer->Tessellate(kDeflection);
      if (!mesh) return mesh.error();
      made = std::move(mesh).value();
    }
    Step(name + ": rays");
    auto bench = MeasureSurfaceRays({name, &model, camera, made.mesh.get(), kDeflection}, {settings_.repeats},
                                    context_.execution);
    if (!bench) return bench.error();
    json_["surface_rays"].push_back(SurfaceRayJson(bench.value()));
    tables_.push_back(SurfaceRayTable(bench.value()));
    surface_rays_.push_back(std::move(bench).value());
    return {};
  }

  Result<void> AddVoxels(const VoxelBenchModel& model) {
    Step("voxels: " + model.name);
    auto bench = MeasureVoxels(model, {.repeats = settings_.repeats, .execution = context_.execution});
    if (!bench) return bench.error();
    json_["published"]["prochazka"].push_back(VoxelBenchJson(bench.value()));
    voxels_.push_back(std::move(bench).value());
    return {};
  }

  // Returns the heading, which names the machine and the program.
  std::string Heading() const {
    const Json& machine = json_.at("machine");
    const Json& program = json_.at("facetless");
    const std::string title = !settings_.markdown ? ""
                              : settings_.structures
                                  ? "# Performance: structures for rays in any direction\n\n"
                              : settings_.published ? "# Performance: the papers' tables\n\n"
                                                    : "# Performance: files\n\n";
    std::string text = "Measured by Facetless " + program.at("version").get<std::string>() + " (" +
                       program.at("build").get<std::string>() + ", " + program.at("isa").get<std::string>() +
                       ") on " + machine.at("processor").get<std::string>() + ", " +
                       std::to_string(machine.at("cores").get<unsigned>()) + " cores; " +
                       std::to_string(settings_.repeats) + " runs each.";
    if (load_ > kQuiet)
      text += " The machine had other work (load " + NumberText(load_) +
              "): ratios are rough, and those of several threads worthless.";
    return title + (settings_.markdown ? Wrapped(text) : text) + "\n\n";
  }

  void Step(const std::string& what) const {
    if (context_.progress) context_.progress(what, 0);
  }

  const ImportRequest& request_;
  const RunOptions& options_;
  const BenchSettings& settings_;
  const RunContext& context_;
  Json json_;
  double load_ = 0;
  std::vector<BenchValue> values_;
  std::vector<Json> details_;
  std::vector<ProgramStages> stages_;
  std::vector<SurfaceRayBench> surface_rays_;
  std::vector<VoxelBench> voxels_;
  std::vector<Table> tables_;
  bool growth_measured_ = false;
};

Result<BenchReport> CompareWithOpenVdb(const std::vector<std::string>& files, const ImportRequest& request,
                                       const RunOptions& options, const BenchSettings& settings,
                                       const RunContext& context) {
  BenchReport report;
  report.json = {{"facetless", ProgramJson(context.execution.threads)}, {"openvdb", Json::array()}};
  for (const std::string& file : files) {
    auto measured = MeasureOpenVdb(file, request, options, settings.repeats, context);
    if (!measured) return measured.error();
    report.json["openvdb"].push_back(std::move(measured.value().json));
    for (const Table& table : measured.value().tables)
      report.text += TableText(table, settings.markdown ? TableStyle::kMarkdown : TableStyle::kText);
  }
  return report;
}

}  // namespace

Result<BenchReport> RunBench(const std::vector<std::string>& files, const ImportRequest& request,
                             const RunOptions& options, const BenchSettings& settings,
                             const RunContext& context) {
  if (files.empty() && !settings.published && !settings.structures)
    return Error{ErrorCode::kBadUsage, "bench needs a file, --published or --structures"};
  if (settings.published && settings.structures)
    return Error{ErrorCode::kBadUsage, "--published and --structures exclude each other"};
  if (settings.openvdb && (settings.published || settings.structures || files.empty()))
    return Error{ErrorCode::kBadUsage, "--openvdb needs a file, and excludes --published and --structures"};
  if (settings.openvdb) return CompareWithOpenVdb(files, request, options, settings, context);
  Bench bench(request, options, settings, context);
  if (settings.published) {
    if (auto done = bench.MeasurePublished(); !done) return done.error();
    if (auto done = bench.MeasureCube(); !done) return done.error();
  }
  if (settings.structures)
    if (auto done = bench.MeasureRandomScenes(); !done) return done.error();
  for (const std::string& file : files) {
    const bool voxels = settings.published && VoxelFormatOf(file).ok();
    if (auto done = voxels ? bench.MeasureVoxelFile(file) : bench.MeasureFile(file); !done)
      return done.error();
  }
  return std::move(bench).Take();
}

}  // namespace facetless
