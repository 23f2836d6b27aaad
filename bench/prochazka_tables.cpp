// The tables and sentences of prochazka.h.
#include <algorithm>
#include <array>

#include "bench/prochazka.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// What the thesis measured on one of its models, on four cores of an AMD Phenom II X4 B55 at 3.3 GHz. The sizes of raw files
// and the numbers of nodes of the larger models are not legible in the copy that we have.
struct Published {
  std::string_view model, name;  // ours, and that of the thesis
  std::string_view octree;       // table 1
  std::array<double, 3> fps, fps_light;
  std::array<std::array<int, 2>, 3> extremes_ms;  // the worst and the best frame
};

constexpr Published kPublished[] = {
    {"cube",
     "simple",
     "4 KB",
     {38.18, 20.80, 20.80},
     {26.54, 16.77, 16.64},
     {{{64, 17}, {73, 34}, {81, 33}}}},
    {"terrain",
     "voxlap",
     "44 MB",
     {8.87, 8.81, 8.34},
     {5.30, 5.80, 5.56},
     {{{332, 20}, {285, 39}, {288, 40}}}},
    {"head", "myhead", "71 MB", {10.41, 9.47, 8.96}, {7.82, 7.53, 7.18}, {{{187, 20}, {187, 22}, {200, 23}}}},
};
// A map of a game, to which no model of ours corresponds.
constexpr Published kVoxelstein = {
    "", "voxelstein", "205 MB", {5.47, 5.83, 5.52}, {3.00, 3.48, 3.31}, {{{292, 28}, {281, 39}, {280, 41}}}};

const Published* PublishedOf(const VoxelBench& bench) {
  for (const Published& row : kPublished)
    if (bench.name == row.model) return &row;
  return nullptr;
}

std::string Number(double value) {
  return ThreeDigits(value);
}

std::string WithPublished(const std::string& ours, const std::string& published) {
  return published.empty() ? ours : ours + " (" + published + ")";
}

// "12.3 (38.2)" for each walk of a path.
template <typename Ours, typename Theirs>
void AppendCells(const VoxelBench& bench, const Ours& ours, const Theirs& theirs,
                 std::vector<std::string>* row) {
  const Published* published = PublishedOf(bench);
  for (std::size_t i = 0; i < bench.paths.size(); ++i)
    row->push_back(WithPublished(ours(bench.paths[i]), published == nullptr ? "" : theirs(*published, i)));
}

Table Sizes(const std::vector<VoxelBench>& models) {
  Table table;
  table.title = "Voxels (Procházka, table 1): sizes of models in memory";
  table.columns = {"model", "voxels", "filled"};
  for (const EncodingSize& size : models.front().sizes) table.columns.push_back(size.encoding);
  for (const VoxelBench& bench : models) {
    std::vector<std::string> row = {bench.name,
                                    std::to_string(bench.size.x) + "×" + std::to_string(bench.size.y) + "×" +
                                        std::to_string(bench.size.z),
                                    Number(static_cast<double>(bench.filled))};
    for (const EncodingSize& size : bench.sizes) {
      const Published* published = size.encoding == "octree" ? PublishedOf(bench) : nullptr;
      row.push_back(
          WithPublished(BytesText(size.bytes), published == nullptr ? "" : std::string(published->octree)));
    }
    table.rows.push_back(std::move(row));
  }
  table.notes.push_back(
      "Here and below, the first number was measured here, and the number in parentheses is the published "
      "one, of the "
      "model of the thesis that is most like ours: a cube, the terrain of Voxlap's demonstration, and a scan "
      "of the "
      "author's head, which are larger than ours. A map of the game Voxelstein takes " +
      std::string(kVoxelstein.octree) +
      " there. A node of the thesis takes 40 bytes, and a leaf 8; ours take 8, and counts of filled voxels 8 "
      "more for "
      "each eight nodes.");
  return table;
}

Table Ratios(const std::vector<VoxelBench>& models) {
  Table table;
  table.title = "Voxels (table 2): size of each encoding as a share of raw";
  table.columns = {"model"};
  for (const EncodingSize& size : models.front().sizes)
    if (size.encoding != "raw") table.columns.push_back(size.encoding);
  for (const VoxelBench& bench : models) {
    std::vector<std::string> row = {bench.name};
    for (const EncodingSize& size : bench.sizes)
      if (size.encoding != "raw") row.push_back(Number(100 * size.bytes / bench.sizes.front().bytes) + " %");
    table.rows.push_back(std::move(row));
  }
  table.notes.push_back("The thesis reports ratios of at most 20 %; its digits are not legible in our copy.");
  return table;
}

Table Nodes(const std::vector<VoxelBench>& models) {
  Table table;
  table.title = "Voxels (table 3): nodes of the octree";
  table.columns = {"model", "nodes", "leaves", "filled leaves", "without empty leaves"};
  for (const VoxelBench& bench : models) {
    const bool cube = bench.name == kPublished[0].model;
    const std::uint64_t not_empty = bench.nodes - (bench.leaves - bench.filled_leaves);
    table.rows.push_back({bench.name, std::to_string(bench.nodes), std::to_string(bench.leaves),
                          WithPublished(std::to_string(bench.filled_leaves), cube ? "1" : ""),
                          WithPublished(std::to_string(not_empty), cube ? "3" : "")});
  }
  table.notes.push_back(
      "An empty child is a missing pointer in the thesis, and a leaf here. So its counts are those of the "
      "last two "
      "columns.");
  return table;
}

// "kd-restart is the fastest, 1.3 times as fast as kd-backtrack: it reads 40 nodes per ray, and that 15."
std::string PathSentence(const VoxelBench& bench) {
  const auto per_ray = [](const PathFigures& path, std::uint64_t count) {
    return static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(path.primary.rays, 1));
  };
  const auto [slowest, fastest] = std::minmax_element(
      bench.paths.begin(), bench.paths.end(), [](const auto& a, const auto& b) { return a.fps < b.fps; });
  const PathFigures& first = bench.paths.front();
  std::string text = bench.name + ": " + fastest->walk + " is the fastest, " +
                     ThreeDigits(fastest->fps / slowest->fps) + " times as fast as " + slowest->walk +
                     ". A ray passes " + ThreeDigits(per_ray(first, first.primary.steps)) +
                     " leaves and reads";
  for (const PathFigures& path : bench.paths)
    text += (&path == &bench.paths.front()  ? " "
             : &path == &bench.paths.back() ? " and "
                                            : ", ") +
            ThreeDigits(per_ray(path, path.primary.nodes)) + " nodes with " + path.walk;
  if (const Published* published = PublishedOf(bench)) {
    const double there = published->fps[1] / published->fps[0],
                 here = bench.paths[1].fps / bench.paths[0].fps;
    text += "; in the thesis, kd-backtrack is " + ThreeDigits(there) + " times as fast as kd-restart, here " +
            ThreeDigits(here) + " times";
  }
  return text + ".";
}

template <typename Ours, typename Theirs>
Table PathTable(const std::string& title, const std::vector<VoxelBench>& models, const Ours& ours,
                const Theirs& theirs) {
  Table table;
  table.title = title;
  table.columns = {"model", "kd-restart", "kd-backtrack", "kd-shortstack"};
  for (const VoxelBench& bench : models) {
    std::vector<std::string> row = {bench.name};
    AppendCells(bench, ours, theirs, &row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table Walks(const std::vector<VoxelBench>& models) {
  Table table;
  table.title = "Voxels: all walks, primary rays of one picture, one thread";
  table.columns = {"model",         "walk",           "rays",       "steps per ray",
                   "nodes per ray", "memory besides", "other voxel"};
  for (const VoxelBench& bench : models)
    for (const WalkFigures& walk : bench.walks) {
      const double rays = static_cast<double>(std::max<std::uint64_t>(walk.counters.rays, 1));
      table.rows.push_back({bench.name, walk.walk, RateText(walk.rays_per_second),
                            Number(static_cast<double>(walk.counters.steps) / rays),
                            Number(static_cast<double>(walk.counters.nodes) / rays),
                            BytesText(walk.side_bytes),
                            walk.distortion ? Number(100 * walk.distortion->other_voxel) + " %" : "none"});
    }
  table.notes.push_back(
      "A step is a voxel, a leaf or a column. Rays that miss the model's box, or whose tile lists no cube, "
      "take no "
      "steps, and are not counted in the means. Tests compare the hits of all exact walks bit for bit.");
  for (const VoxelBench& bench : models)
    for (const WalkFigures& walk : bench.walks)
      if (walk.distortion)
        table.notes.push_back(
            bench.name + ": with " + walk.walk + ", " + ThreeDigits(100 * walk.distortion->other_voxel) +
            " % of the pixels that show the model show another voxel, at a depth that differs by " +
            ThreeDigits(walk.distortion->mean_depth) + " voxels on average over all hits, and by " +
            ThreeDigits(walk.distortion->most_depth) + " at most.");
  return table;
}

}  // namespace

std::vector<Table> VoxelTables(const std::vector<VoxelBench>& models) {
  if (models.empty()) return {};
  Table fps = PathTable(
      "Voxels (table 4): frames per second with ambient light", models,
      [](const PathFigures& path) { return Number(path.fps); },
      [](const Published& row, std::size_t i) { return Number(row.fps[i]); });
  fps.notes.push_back(
      "Frames have " + std::to_string(kFrameWidth) + "×" + std::to_string(kFrameHeight) +
      " pixels. The resolution of the thesis is not legible in our copy, and its machine had four cores of "
      "3.3 GHz of 2010; so only the ratios of a row compare.");
  for (const VoxelBench& bench : models) fps.notes.push_back(PathSentence(bench));
  Table light = PathTable(
      "Voxels (table 5): frames per second with one light", models,
      [](const PathFigures& path) { return Number(path.fps_light); },
      [](const Published& row, std::size_t i) { return Number(row.fps_light[i]); });
  light.notes.push_back(
      "A shadow ray starts beside a side that faces the light. The thesis casts one for every hit, and ours "
      "are cast only "
      "where the side faces the light.");
  Table extremes = PathTable(
      "Voxels (table 6): the slowest and the fastest frame in ms, ambient light", models,
      [](const PathFigures& path) { return Number(path.worst_ms) + " / " + Number(path.best_ms); },
      [](const Published& row, std::size_t i) {
        return std::to_string(row.extremes_ms[i][0]) + " / " + std::to_string(row.extremes_ms[i][1]);
      });
  return {Sizes(models),    Ratios(models),      Nodes(models), std::move(fps),
          std::move(light), std::move(extremes), Walks(models)};
}

Json VoxelBenchJson(const VoxelBench& bench) {
  const auto counters = [](const WalkCounters& c) {
    return Json{{"rays", c.rays}, {"steps", c.steps}, {"nodes", c.nodes}};
  };
  Json json = {{"model", bench.name},     {"size", {bench.size.x, bench.size.y, bench.size.z}},
               {"filled", bench.filled},  {"nodes", bench.nodes},
               {"leaves", bench.leaves},  {"filled_leaves", bench.filled_leaves},
               {"bytes", Json::object()}, {"walks", Json::array()},
               {"paths", Json::array()}};
  for (const EncodingSize& size : bench.sizes) json["bytes"][size.encoding] = size.bytes;
  for (const WalkFigures& walk : bench.walks) {
    json["walks"].push_back({{"walk", walk.walk},
                             {"rays_per_second", walk.rays_per_second},
                             {"side_bytes", walk.side_bytes},
                             {"pixels_hit", walk.pixels_hit},
                             {"counters", counters(walk.counters)}});
    if (walk.distortion)
      json["walks"].back()["distortion"] = {{"other_voxel", walk.distortion->other_voxel},
                                            {"mean_depth_voxels", walk.distortion->mean_depth},
                                            {"most_depth_voxels", walk.distortion->most_depth}};
  }
  for (const PathFigures& path : bench.paths)
    json["paths"].push_back({{"walk", path.walk},
                             {"fps", path.fps},
                             {"fps_light", path.fps_light},
                             {"worst_ms", path.worst_ms},
                             {"best_ms", path.best_ms},
                             {"primary", counters(path.primary)},
                             {"shadow", counters(path.shadow)}});
  return json;
}

}  // namespace facetless
