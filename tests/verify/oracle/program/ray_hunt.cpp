#include "tests/verify/oracle/program/ray_hunt.h"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "render/base/parallel.h"
#include "render/rays/exact_rays.h"
#include "tests/verify/oracle/ray_judge.h"

namespace facetless::oracle {
namespace {

// Towards the light: over the shoulder of the eye of an isometric view.
const Vec3 kLight = facetless::Normalized(Vec3{0.4, -0.7, 0.9});

Vec3 RandomDirection(Random& random) {
  for (;;) {
    const Vec3 v{random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
    const double square = Dot(v, v);
    if (square > 0.01 && square <= 1) return facetless::Normalized(v);
  }
}

std::vector<RayStart> StartsOf(const Camera& camera, const DirectResult& direct, std::size_t count,
                               Random& random) {
  const SampleBuffer& samples = direct.samples;
  std::vector<RayStart> starts;
  for (std::size_t tries = 0; starts.size() < count && tries < 100 * count; ++tries) {
    const std::uint32_t pixel = random.Below(static_cast<std::uint32_t>(samples.size()));
    if (samples.face[pixel] == kNoIndex) continue;
    const Ray ray = PixelRay(direct.frame, pixel % camera.width_px + 0.5, pixel / camera.width_px + 0.5);
    RayStart start;
    start.position = ray.origin + samples.depth[pixel] * ray.direction;
    const auto& n = samples.normal[pixel];
    start.normal = {n[0], n[1], n[2]};
    if (Dot(start.normal, ray.direction) > 0) start.normal = -start.normal;
    start.placed_face = samples.face[pixel];
    start.u = samples.uv[pixel][0];
    start.v = samples.uv[pixel][1];
    starts.push_back(start);
  }
  return starts;
}

struct Counts {
  std::array<std::uint64_t, kVerdicts> certified{}, open{};
  std::array<std::uint64_t, kDoubtNames.size()> doubts{};
  std::uint64_t positive = 0;

  void Add(Verdict verdict, bool is_certified, std::uint8_t doubt, bool is_positive) {
    ++(is_certified ? certified : open)[static_cast<std::size_t>(verdict)];
    for (std::size_t bit = 0; bit < doubts.size(); ++bit) doubts[bit] += doubt >> bit & 1;
    positive += is_positive;
  }
  void Print(const char* name) const {
    std::uint64_t of_certified = 0, of_open = 0;
    for (std::size_t v = 0; v < kVerdicts; ++v) of_certified += certified[v], of_open += open[v];
    std::printf("  %-18s %llu rays, %.2f %% blocked, %.3f %% certified:", name,
                static_cast<unsigned long long>(of_certified + of_open),
                100.0 * positive / std::max<double>(1, of_certified + of_open),
                100.0 * of_certified / std::max<double>(1, of_certified + of_open));
    for (std::size_t v = 0; v < kVerdicts; ++v)
      if (certified[v] > 0)
        std::printf(" %s %llu", VerdictName(static_cast<Verdict>(v)),
                    static_cast<unsigned long long>(certified[v]));
    std::printf("; not certified:");
    for (std::size_t v = 0; v < kVerdicts; ++v)
      if (open[v] > 0)
        std::printf(" %s %llu", VerdictName(static_cast<Verdict>(v)),
                    static_cast<unsigned long long>(open[v]));
    for (std::size_t bit = 0; bit < doubts.size(); ++bit)
      if (doubts[bit] > 0)
        std::printf(", %s %llu", kDoubtNames[bit], static_cast<unsigned long long>(doubts[bit]));
    std::printf("\n");
  }
  std::uint64_t wrong() const { return certified[static_cast<std::size_t>(Verdict::kWrong)]; }
};

}  // namespace

Result<std::uint64_t> HuntRays(const std::string& title, const Scene& scene, const Oracle& oracle,
                               const Camera& camera, const DirectResult& direct,
                               const RayHuntOptions& options, Random& random) {
  Result<std::unique_ptr<ExactRays>> built = ExactRays::Build(scene, {.structure = options.structure}, {});
  if (!built) return built.error();
  const ExactRays& exact = *built.value();
  const std::vector<RayStart> starts = StartsOf(camera, direct, options.starts, random);
  std::printf("%s, rays from %zu hits: %zu pieces, %.1f MB, built in %.1f ms\n", title.c_str(), starts.size(),
              exact.pieces(), 1e-6 * exact.bytes(), exact.build_ms());

  std::uint64_t wrong = 0;
  int listed = 0;
  for (const char* kind : {"shadow", "occlusion", "inwards"}) {
    std::vector<SecondaryRay> rays;
    for (std::uint32_t i = 0; i < starts.size(); ++i) {
      Vec3 direction = kLight;
      if (kind[0] != 's') {
        direction = RandomDirection(random);
        if ((Dot(direction, starts[i].normal) > 0) != (kind[0] == 'o')) direction = -direction;
      }
      rays.push_back({i, direction, INFINITY});
    }
    std::vector<RayPassage> passages(rays.size());
    std::vector<SecondaryHit> hits(rays.size());
    const auto begin = std::chrono::steady_clock::now();
    exact.FindBlocked(starts, rays, passages);
    const double us =
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
    exact.FindNearest(starts, rays, hits);

    const RayJudge judge(oracle);
    std::vector<Verdict> of_passage(rays.size()), of_hit(rays.size());
    ParallelFor(std::size_t{0}, rays.size(), [&](std::size_t i) {
      of_passage[i] = judge.Passage(starts[rays[i].start], rays[i], passages[i]);
      of_hit[i] = judge.Hit(starts[rays[i].start], rays[i], hits[i]);
    });
    Counts blocked, nearest;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      blocked.Add(of_passage[i], passages[i].certified, passages[i].doubt, passages[i].blocked);
      nearest.Add(of_hit[i], hits[i].certified, hits[i].doubt, std::isfinite(hits[i].distance));
      const bool bad = (passages[i].certified && of_passage[i] == Verdict::kWrong) ||
                       (hits[i].certified && of_hit[i] == Verdict::kWrong);
      if (bad && listed++ < options.list)
        std::printf("    blocked %d (certified %d), nearest %.17g ± %.2g on %u (certified %d) %s\n",
                    passages[i].blocked, passages[i].certified, hits[i].distance, hits[i].error,
                    hits[i].placed_face, hits[i].certified,
                    judge.Describe(starts[rays[i].start], rays[i]).c_str());
    }
    blocked.Print(kind);
    nearest.Print(" nearest");
    std::printf("  %.3f us per %s ray\n", us / std::max<std::size_t>(1, rays.size()), kind);
    if (const ExactRays::Paths paths = exact.CountPaths(starts, rays); paths.rays > 0)
      std::printf(
          "  blocks decide %.1f %% as blocked and %.1f %% as clear; per ray %.2f pieces open, %.2f of them "
          "own, "
          "%.3f solved\n",
          100.0 * paths.blocked / paths.rays, 100.0 * paths.clear / paths.rays,
          double(paths.pieces_open) / paths.rays, double(paths.pieces_own) / paths.rays,
          double(paths.pieces_solved) / paths.rays);
    wrong += blocked.wrong() + nearest.wrong();
  }
  std::fflush(stdout);
  return wrong;
}

}  // namespace facetless::oracle
