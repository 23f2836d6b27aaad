#include "bench/surface_rays.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <utility>

#include "bench/statistics.h"
#include "bench/svg.h"
#include "render/base/parallel.h"
#include "render/baseline/mesh_rays.h"
#include "render/baseline/raw_rays.h"
#include "render/rays/exact_rays.h"
#include "render/shade/cast_light.h"
#include "render/shade/hemisphere.h"
#include "render/trace/direct.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr double kOcclusionRadius = 0.25;  // of the diagonal
constexpr std::size_t kFirstRays = 64;     // that say how slow a structure is

// Rays of one kind, with their starts.
struct RaySet {
  std::vector<RayStart> starts;
  std::vector<SecondaryRay> rays;
  bool any = false;  // whether anything blocks them; else the nearest hit

  void Add(const RayStart& start, Vec3 direction, double length = INFINITY) {
    rays.push_back({static_cast<std::uint32_t>(starts.size()), direction, length});
    starts.push_back(start);
  }
};

// The answers of one structure to the first rays of a set.
struct Answers {
  std::vector<RayPassage> passages;
  std::vector<SecondaryHit> hits;
};

void Ask(const SecondaryRays& rays, const RaySet& set, std::size_t count, Answers* answers) {
  const std::span<const SecondaryRay> some(set.rays.data(), count);
  if (set.any) {
    answers->passages.resize(count);
    rays.FindBlocked(set.starts, some, answers->passages);
  } else {
    answers->hits.resize(count);
    rays.FindNearest(set.starts, some, answers->hits);
  }
}

SurfaceRayCost CostOf(const RaySet& set, const Answers& answers, const Answers& usual, double ms) {
  SurfaceRayCost cost;
  cost.rays = set.any ? answers.passages.size() : answers.hits.size();
  if (cost.rays == 0) return cost;
  cost.per_second = 1000 * static_cast<double>(cost.rays) / ms;
  std::uint64_t certified = 0;
  for (std::size_t i = 0; i < cost.rays; ++i) {
    certified += set.any ? answers.passages[i].certified : answers.hits[i].certified;
    cost.unlike += set.any ? answers.passages[i].blocked != usual.passages[i].blocked
                           : answers.hits[i].distance != usual.hits[i].distance;
  }
  cost.certified = static_cast<double>(certified) / static_cast<double>(cost.rays);
  return cost;
}

// The four kinds of rays (law 1).
std::array<RaySet, 4> MakeRays(const Model& model, const DirectResult& traced, std::size_t count) {
  std::array<RaySet, 4> sets;
  RaySet &primary = sets[0], &shadow = sets[1], &ambient = sets[2], &random = sets[3];
  shadow.any = ambient.any = true;
  const SampleBuffer& samples = traced.samples;
  const Vec3 key = TowardKeyLight(traced.frame);
  const auto width = static_cast<std::size_t>(samples.width);
  std::vector<std::size_t> hits;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples.face[i] != kNoIndex) hits.push_back(i);
  const std::size_t step = std::max<std::size_t>(1, hits.size() / count);
  std::mt19937_64 engine(2004);
  const auto share = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  for (std::size_t k = 0; k < hits.size(); k += step) {
    const std::size_t i = hits[k];
    const double x = static_cast<double>(i % width) + 0.5, y = static_cast<double>(i / width) + 0.5;
    const RayStart start = StartOfSample(samples, traced.frame, i, x, y);
    const Ray ray = PixelRay(traced.frame, x, y);
    RayStart outside;
    outside.position = ray.origin + (samples.depth[i] - 2 * model.Diagonal()) * ray.direction;
    primary.Add(outside, Normalized(ray.direction));
    if (Dot(start.normal, key) > 0) shadow.Add(start, key);
    // A direction by the cosine.
    const LocalFrame axes(start.normal);
    double u = 2, v = 2;
    while (!(u * u + v * v < 1)) u = 2 * share() - 1, v = 2 * share() - 1;
    ambient.Add(start, Normalized(axes.ToWorld({u, v, std::sqrt(1 - u * u - v * v)})),
                kOcclusionRadius * model.Diagonal());
  }
  const Vec3 size = model.bounds.high - model.bounds.low;
  for (std::size_t k = 0; k < count; ++k) {
    RayStart anywhere;
    anywhere.position = model.bounds.low + Vec3{share() * size.x, share() * size.y, share() * size.z};
    Vec3 d{};
    while (!(Dot(d, d) > 1e-4 && Dot(d, d) <= 1)) d = 2 * Vec3{share(), share(), share()} - Vec3{1, 1, 1};
    random.Add(anywhere, Normalized(d));
  }
  return sets;
}

// Measures one structure on one kind of rays. `usual` has the answers of the usual structure to all rays.
SurfaceRayCost MeasureKind(const SecondaryRays& rays, const RaySet& set, const Answers& usual, int repeats) {
  if (set.rays.empty()) return {};
  Answers answers;
  const std::size_t first = std::min(kFirstRays, set.rays.size());
  const double first_ms = MeasureMilliseconds([&] { Ask(rays, set, first, &answers); });
  const double all_ms = first_ms * static_cast<double>(set.rays.size()) / static_cast<double>(first);
  const std::size_t count =
      std::clamp<std::size_t>(set.rays.size() / RayStride(all_ms), first, set.rays.size());
  std::vector<double> times;
  for (int turn = 0; turn < repeats; ++turn)
    times.push_back(MeasureMilliseconds([&] { Ask(rays, set, count, &answers); }));
  return CostOf(set, answers, usual, Median(times));
}

SurfaceRayPeer MeasurePeer(const SecondaryRays& exact, const BaselineScene& scene, const RaySet& set,
                           const Answers& usual, int repeats) {
  constexpr std::array<int, 3> kWidths = {1, 8, 16};
  const RawRays raw(scene, set.starts, set.rays);
  Answers answers;
  std::vector<std::function<void()>> competitors = {[&] { Ask(exact, set, set.rays.size(), &answers); }};
  std::uint64_t blocked = 0;
  for (const int width : kWidths)
    competitors.emplace_back([&, width] { blocked += raw.CountBlocked(width); });
  const std::vector<std::vector<double>> times = TakeTurns(repeats, competitors);
  SurfaceRayPeer peer;
  double best_ms = INFINITY;
  for (std::size_t k = 0; k < kWidths.size(); ++k) {
    const double ms = Median(times[k + 1]);
    if (!(ms < best_ms)) continue;
    best_ms = ms;
    peer.width = kWidths[k];
    peer.ratio = MedianRatio(times[k + 1], times[0]);
  }
  peer.per_second = 1000 * static_cast<double>(set.rays.size()) / best_ms;
  std::vector<RayPassage> on_mesh(set.rays.size());
  MeshRays(scene).FindBlocked(set.starts, set.rays, on_mesh);
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < on_mesh.size(); ++i)
    wrong += usual.passages[i].certified && usual.passages[i].blocked != on_mesh[i].blocked;
  peer.wrong = static_cast<double>(wrong) / static_cast<double>(on_mesh.size());
  return peer;
}

}  // namespace

Result<SurfaceRayBench> MeasureSurfaceRays(const SurfaceRayCase& subject,
                                           const StructureBenchSettings& settings,
                                           const Execution& execution) {
  const Execution one{1, execution.cancel};
  const Scene scene(*subject.model);
  DirectOptions options;
  options.execution = execution;
  options.uv = options.depth_error = true;
  const Result<DirectResult> traced = TraceDirect(scene, subject.camera, options);
  if (!traced.ok()) return traced.error();
  const std::array<RaySet, 4> sets = MakeRays(*subject.model, traced.value(), settings.rays);
  SurfaceRayBench bench{subject.name, sets[0].rays.size(), 0, {}, {}};
  if (bench.starts == 0)
    return Error{ErrorCode::kNothingUsable, subject.name + ": no ray of the view hits the model"};

  std::vector<std::string> names = {kUsualStructure};
  for (const StructureName& structure : StructureNames()) names.emplace_back(structure.name);
  std::array<Answers, 4> usual;
  std::optional<BaselineScene> tree;
  if (subject.mesh != nullptr) {
    Result<BaselineScene> built = BaselineScene::Build(*subject.mesh, execution);
    if (!built.ok()) return built.error();
    tree.emplace(std::move(built).value());
    bench.deflection = subject.deflection;
  }
  for (const std::string& name : names) {
    if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
    const Result<std::unique_ptr<ExactRays>> made =
        ExactRays::Build(scene, {.structure = name, .leave_out = nullptr}, one);
    if (!made.ok()) return made.error();
    const ExactRays& rays = *made.value();
    SurfaceRayRow row{name, rays.build_ms(), rays.bytes(), {}};
    for (std::size_t kind = 0; kind < sets.size(); ++kind) {
      if (name == kUsualStructure) Ask(rays, sets[kind], sets[kind].rays.size(), &usual[kind]);
      row.kinds[kind] = MeasureKind(rays, sets[kind], usual[kind], settings.repeats);
      if (name == kUsualStructure && tree && sets[kind].any && !sets[kind].rays.empty())
        bench.peers[kind] = MeasurePeer(rays, *tree, sets[kind], usual[kind], settings.repeats);
    }
    bench.rows.push_back(std::move(row));
  }
  return bench;
}

Table SurfaceRayTable(const SurfaceRayBench& bench) {
  Table table;
  table.title = "Rays on exact surfaces: " + bench.name + ", " + std::to_string(bench.starts) + " starts";
  table.columns = {"structure", "build",  "memory",    "primary", "shadow",
                   "ambient",   "random", "certified", "unlike"};
  for (const SurfaceRayRow& row : bench.rows) {
    std::vector<std::string> cells = {row.name, MillisecondsText(row.build_ms),
                                      BytesText(static_cast<double>(row.bytes))};
    double certified = 1;
    std::uint64_t unlike = 0;
    for (const SurfaceRayCost& cost : row.kinds) {
      cells.push_back(cost.rays > 0 ? RateText(cost.per_second) : "");
      if (cost.rays > 0) certified = std::min(certified, cost.certified);
      unlike += cost.unlike;
    }
    cells.push_back(ThreeDigits(100 * certified) + " %");
    cells.push_back(std::to_string(unlike));
    table.rows.push_back(std::move(cells));
  }
  if (bench.deflection > 0) {
    char deflection[24];
    std::snprintf(deflection, sizeof deflection, "%g", bench.deflection);
    std::vector<std::string> cells = {std::string("Embree, mesh at ") + deflection, "", ""};
    for (const SurfaceRayPeer& peer : bench.peers)
      cells.push_back(peer.per_second > 0 ? RateText(peer.per_second) : "");
    cells.insert(cells.end(), {"", ""});
    table.rows.push_back(std::move(cells));
    for (const BenchRays kind : {BenchRays::kShadow, BenchRays::kAmbient}) {
      const SurfaceRayPeer& peer = bench.peers[static_cast<std::size_t>(kind)];
      if (peer.per_second > 0)
        table.notes.push_back(std::string(kBenchRayNames[static_cast<std::size_t>(kind)]) +
                              " rays: " + kUsualStructure + " trace " + ThreeDigits(peer.ratio) +
                              " times as many as Embree's fastest way (packets of " +
                              std::to_string(peer.width) + "); the mesh answers " +
                              ThreeDigits(100 * peer.wrong) + " % of them wrongly.");
    }
  }
  table.notes.push_back(
      "Rays per second on one thread, from starts exactly on the surface, trimmed. Shadow and ambient rays "
      "ask whether "
      "anything blocks them, the others for the nearest hit. Certified: the least share of the four kinds.");
  return table;
}

Json SurfaceRayJson(const SurfaceRayBench& bench) {
  Json rows = Json::array(), embree = Json::object();
  for (const SurfaceRayRow& row : bench.rows) {
    Json kinds = Json::object();
    for (std::size_t kind = 0; kind < row.kinds.size(); ++kind)
      kinds[kBenchRayNames[kind]] = {{"rays", row.kinds[kind].rays},
                                     {"rays_per_second", row.kinds[kind].per_second},
                                     {"certified", row.kinds[kind].certified},
                                     {"unlike", row.kinds[kind].unlike}};
    rows.push_back(
        {{"name", row.name}, {"build_ms", row.build_ms}, {"bytes", row.bytes}, {"rays", std::move(kinds)}});
  }
  for (std::size_t kind = 0; kind < bench.peers.size(); ++kind)
    if (const SurfaceRayPeer& peer = bench.peers[kind]; peer.per_second > 0)
      embree[kBenchRayNames[kind]] = {{"rays_per_second", peer.per_second},
                                      {"packet", peer.width},
                                      {"ratio", peer.ratio},
                                      {"wrong", peer.wrong}};
  return {{"scene", bench.name},
          {"starts", bench.starts},
          {"structures", std::move(rows)},
          {"deflection", bench.deflection > 0 ? Json(bench.deflection) : Json()},
          {"embree", std::move(embree)}};
}

std::string SurfaceRayPlot(const std::vector<SurfaceRayBench>& benches) {
  constexpr double kWidth = 960, kLeft = 220, kRight = 40, kTop = 86, kRow = 22, kGap = 44, kFoot = 40,
                   kDot = 9;
  constexpr const char* kColors[] = {"#126690", "#cc5c0d", "#3f8f5b", "#b59a2c"};
  constexpr double kLow = 2, kHigh = 8;  // powers of ten of rays per second
  const auto at = [&](double rate) {
    return kLeft +
           (std::clamp(std::log10(rate), kLow, kHigh) - kLow) / (kHigh - kLow) * (kWidth - kLeft - kRight);
  };
  std::string svg;
  double x = 24;
  for (std::size_t kind = 0; kind < kBenchRayNames.size(); ++kind, x += 120)
    svg += SvgBox(x, 50, 12, 12, kColors[kind]) + SvgText(x + 18, 61, "start", 13, kBenchRayNames[kind]);
  svg += SvgText(x + 10, 61, "start", 13, "rays per second; the lines are Embree's on the mesh");
  double y = kTop;
  for (const SurfaceRayBench& bench : benches) {
    svg += SvgText(24, y + 14, "start", 13, bench.name);
    y += kRow;
    const double height = kRow * static_cast<double>(bench.rows.size());
    for (double power = kLow; power <= kHigh; ++power)
      svg += SvgBox(at(std::pow(10, power)), y, 1, height, "#dddddb");
    for (std::size_t kind = 0; kind < bench.peers.size(); ++kind)
      if (bench.peers[kind].per_second > 0)
        svg += SvgBox(at(bench.peers[kind].per_second), y, 2, height, kColors[kind]);
    for (const SurfaceRayRow& row : bench.rows) {
      svg += SvgText(kLeft - 10, y + 15, "end", 12, row.name);
      for (std::size_t kind = 0; kind < row.kinds.size(); ++kind)
        if (row.kinds[kind].per_second > 0)
          svg += SvgBox(at(row.kinds[kind].per_second) - kDot / 2, y + 6, kDot, kDot, kColors[kind]);
      y += kRow;
    }
    for (double power = kLow; power <= kHigh; ++power)
      svg += SvgText(at(std::pow(10, power)), y + 14, "middle", 12, RateText(std::pow(10, power)));
    y += kGap;
  }
  if (benches.empty()) svg += SvgText(24, kTop + 24, "start", 13, "No file was measured.");
  return SvgPicture(kWidth, std::max(y, kTop + kRow) + kFoot - kGap / 2,
                    "Rays that start on exact surfaces, one thread", svg);
}

}  // namespace facetless
