#include "bench/structure_bench.h"

#include <random>

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kSeed = 2004;

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : engine_(seed) {}
  double Share() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  Vec3 Point() { return {Share(), Share(), Share()}; }
  // A unit vector, each direction as likely as any other.
  Vec3 Direction() {
    for (;;) {
      const Vec3 d = 2 * Point() - Vec3{1, 1, 1};
      const double square = Dot(d, d);
      if (square > 1e-4 && square <= 1) return Normalized(d);
    }
  }

 private:
  std::mt19937_64 engine_;
};

// Two vectors across a direction.
struct Across {
  Vec3 right, up;
};
Across AcrossOf(Vec3 direction) {
  const Vec3 right = Normalized(Cross(direction, {0, 0, 1}));
  return {right, Cross(right, direction)};
}

BoxScenery Cubes(const std::string& name, std::size_t count, double edge, int clusters, std::uint64_t seed) {
  Numbers numbers(seed);
  std::vector<Vec3> middles;
  for (int i = 0; i < clusters; ++i) middles.push_back(numbers.Point());
  BoxScenery scene{name, {}};
  for (std::size_t i = 0; i < count; ++i) {
    constexpr double kClusterSize = 0.05;
    const Vec3 middle =
        clusters == 0 ? numbers.Point() : middles[i % middles.size()] + kClusterSize * numbers.Direction();
    const Vec3 half = 0.5 * edge * Vec3{1, 1, 1};
    scene.boxes.push_back({middle - half, middle + half});
  }
  return scene;
}

double RaysPerSecond(const StructureRays& rays) {
  return rays.ns_per_ray > 0 ? 1e9 / rays.ns_per_ray : 0;
}

}  // namespace

double BoxEntry::operator()(std::uint32_t id, const RaySegment& ray) const {
  double in = ray.t_first, out = ray.t_last;
  const Box3& box = boxes[id];
  const auto slab = [&](double low, double high, double o, double d) {
    const double a = (low - o) / d, b = (high - o) / d;
    // fmin and fmax ignore the NaN of 0/0, which occurs if the ray lies in the plane of a side.
    in = std::fmax(in, std::fmin(a, b));
    out = std::fmin(out, std::fmax(a, b));
  };
  slab(box.low.x, box.high.x, ray.origin.x, ray.direction.x);
  slab(box.low.y, box.high.y, ray.origin.y, ray.direction.y);
  slab(box.low.z, box.high.z, ray.origin.z, ray.direction.z);
  return in <= out ? in : INFINITY;
}

std::vector<BoxScenery> RandomBoxSceneries() {
  // Sizes are those of Skala's scenes, whose edges have 10 and 63 of 256 pixels.
  return {Cubes("6300 random cubes, edge 10/256", 6300, 10.0 / 256, 0, kSeed),
          Cubes("6300 random cubes, edge 63/256", 6300, 63.0 / 256, 0, kSeed),
          Cubes("20000 random cubes, edge 2/256", 20000, 2.0 / 256, 0, kSeed),
          Cubes("20000 cubes in 8 clusters, edge 0.5/256", 20000, 0.5 / 256, 8, kSeed)};
}

std::vector<RaySegment> PrimaryRays(const Box3& bounds, std::size_t count) {
  // A picture of the whole scene, from two diagonals away.
  constexpr double kDistance = 2;
  const Vec3 forward = Normalized({-1, 0.7, -0.6});
  const Vec3 middle = bounds.center(), eye = middle - kDistance * bounds.diagonal() * forward;
  const Across across = AcrossOf(forward);
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
  std::vector<RaySegment> rays;
  for (std::size_t i = 0; i < side; ++i)
    for (std::size_t j = 0; j < side; ++j) {
      const double x = (static_cast<double>(j) + 0.5) / static_cast<double>(side) - 0.5,
                   y = (static_cast<double>(i) + 0.5) / static_cast<double>(side) - 0.5;
      const Vec3 target = middle + bounds.diagonal() * (x * across.right + y * across.up);
      rays.push_back({eye, target - eye});
    }
  return rays;
}

std::vector<RaySegment> RandomRays(const Box3& bounds, std::size_t count) {
  Numbers numbers(kSeed);
  const Vec3 size = bounds.high - bounds.low;
  std::vector<RaySegment> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 share = numbers.Point();
    rays.push_back(
        {bounds.low + Vec3{share.x * size.x, share.y * size.y, share.z * size.z}, numbers.Direction()});
  }
  return rays;
}

namespace {

// Calls add(point, ray) for the points where rays hit, moved towards the eye by a share of the scene.
template <typename Add>
void ForEachHit(const Box3& bounds, const std::vector<RaySegment>& primary, const std::vector<double>& hits,
                const Add& add) {
  constexpr double kLift = 1e-6;
  for (std::size_t i = 0; i < primary.size(); ++i) {
    if (!(hits[i] < INFINITY)) continue;
    const Vec3 direction = Normalized(primary[i].direction);
    const Vec3 point = primary[i].origin + hits[i] * primary[i].direction;
    add(point - kLift * bounds.diagonal() * direction, direction);
  }
}

}  // namespace

std::vector<RaySegment> ShadowRays(const Box3& bounds, const std::vector<RaySegment>& primary,
                                   const std::vector<double>& hits) {
  const Vec3 light = bounds.center() + 2 * bounds.diagonal() * Normalized({0.3, -0.5, 1});
  std::vector<RaySegment> rays;
  ForEachHit(bounds, primary, hits, [&](Vec3 point, Vec3) { rays.push_back({point, light - point, 0, 1}); });
  return rays;
}

std::vector<RaySegment> AmbientRays(const Box3& bounds, const std::vector<RaySegment>& primary,
                                    const std::vector<double>& hits) {
  constexpr double kRadius = 0.25;  // of the diagonal
  Numbers numbers(kSeed);
  std::vector<RaySegment> rays;
  ForEachHit(bounds, primary, hits, [&](Vec3 point, Vec3 direction) {
    Vec3 to = numbers.Direction();
    if (Dot(to, direction) > 0) to = -1 * to;
    rays.push_back({point, to, 0, kRadius * bounds.diagonal()});
  });
  return rays;
}

double SourceEstimate(const StructureRow& row, std::size_t boxes) {
  const double d = row.kinds[static_cast<int>(BenchRays::kRandom)].regions;
  const auto is = [&](const char* prefix) { return row.name.starts_with(prefix); };
  if (is("grid") || is("lattice") || is("octree") || is("bsp") || is("ssm"))
    return EstimatedShare(d, row.figures, static_cast<double>(boxes));
  if (is("direction-tree")) return EstimatedShare(1, row.figures, static_cast<double>(boxes));
  return 0;
}

std::vector<Table> StructureTables(const StructureBench& bench) {
  const auto share = [&](const StructureRow& row) {
    return row.kinds[3].ns_per_ray / bench.rows.front().kinds[3].ns_per_ray;
  };
  Table speed, work;
  speed.title =
      "Structures for rays in any direction: " + bench.scene + ", " + std::to_string(bench.boxes) + " boxes";
  speed.columns = {"structure", "build",           "memory",         "k",     "primary", "shadow", "ambient",
                   "random",    "estimated share", "measured share", "unlike"};
  work.title = "Work per ray: " + bench.scene;
  work.columns = {"structure",    "primary d",         "primary tests", "shadow d",
                  "shadow tests", "ambient d",         "ambient tests", "random d",
                  "random tests", "random candidates", "random repeats"};
  for (const StructureRow& row : bench.rows) {
    std::uint64_t unlike = 0;
    std::vector<std::string> cells = {row.name, MillisecondsText(row.build_ms),
                                      BytesText(static_cast<double>(row.bytes)),
                                      ThreeDigits(row.figures.references / static_cast<double>(bench.boxes))};
    std::vector<std::string> counts = {row.name};
    for (const StructureRays& rays : row.kinds) {
      unlike += rays.unlike;
      cells.push_back(RateText(RaysPerSecond(rays)));
      counts.push_back(ThreeDigits(rays.regions));
      counts.push_back(ThreeDigits(rays.tests));
    }
    cells.push_back(row.estimated_share > 0 ? ThreeDigits(row.estimated_share) : "");
    cells.push_back(ThreeDigits(share(row)));
    cells.push_back(std::to_string(unlike));
    counts.push_back(ThreeDigits(row.kinds[3].candidates));
    counts.push_back(ThreeDigits(row.kinds[3].repeats));
    speed.rows.push_back(std::move(cells));
    work.rows.push_back(std::move(counts));
  }
  speed.notes = {
      "Rays per second on one thread; a hit is the entry into a box. Shadow and ambient rays end at the "
      "first hit. k: references to objects, over objects.",
      "Estimated share: d·k over the number of regions, for random rays, as the sources estimate it. "
      "Measured share: the time of random rays over that of the plain list of boxes.",
      "A test of a box takes " + ThreeDigits(bench.costs.box_ns) + " ns, and one of a sphere " +
          ThreeDigits(bench.costs.sphere_ns) + " ns."};
  work.notes = {
      "d: regions (voxels, nodes) that a ray visits. Tests: bounding volumes of objects. Repeats: objects "
      "that were left out because the ray had asked them before."};
  return {speed, work};
}

Json StructureJson(const StructureBench& bench) {
  Json rows = Json::array();
  for (const StructureRow& row : bench.rows) {
    Json kinds = Json::object();
    for (std::size_t kind = 0; kind < row.kinds.size(); ++kind) {
      const StructureRays& rays = row.kinds[kind];
      kinds[kBenchRayNames[kind]] = {{"rays", rays.rays},
                                     {"ns_per_ray", rays.ns_per_ray},
                                     {"rays_per_second", RaysPerSecond(rays)},
                                     {"regions", rays.regions},
                                     {"tests", rays.tests},
                                     {"candidates", rays.candidates},
                                     {"repeats", rays.repeats},
                                     {"hits", rays.hits},
                                     {"unlike", rays.unlike}};
    }
    rows.push_back({{"name", row.name},
                    {"build_ms", row.build_ms},
                    {"bytes", row.bytes},
                    {"regions", row.figures.regions},
                    {"references", row.figures.references},
                    {"depth", row.figures.depth},
                    {"estimated_share", row.estimated_share},
                    {"rays", std::move(kinds)}});
  }
  return {{"scene", bench.scene},
          {"boxes", bench.boxes},
          {"box_test_ns", bench.costs.box_ns},
          {"sphere_test_ns", bench.costs.sphere_ns},
          {"structures", std::move(rows)}};
}

}  // namespace facetless
