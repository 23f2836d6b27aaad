#include "bench/skala.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "bench/box_scene.h"
#include "bench/statistics.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kSeed = 1996;

// The paper's figures: rows by number of objects, columns by size; 0 where the paper has none.
using Published = std::array<std::array<double, kSkalaSizes.size()>, kSkalaObjects.size()>;
constexpr Published kTable2 = {{{10.38, 9.52, 8.04, 6.13, 4.74, 4.10},
                                {11.39, 10.31, 8.55, 6.44, 4.90, 4.22},
                                {11.96, 10.72, 8.83, 6.59, 4.98, 4.28},
                                {12.65, 11.30, 9.22, 6.82, 5.15, 4.44},
                                {13.06, 11.64, 9.48, 6.99, 5.26, 4.55},
                                {13.72, 12.18, 9.86, 7.22, 5.39, 4.51},
                                {14.03, 12.43, 10.03, 7.30, 5.43, 4.65}}};
constexpr Published kTable3 = {{{26.11, 23.40, 19.10, 13.79, 9.86, 7.64},
                                {28.62, 25.30, 20.29, 14.43, 10.17, 7.82},
                                {29.95, 26.23, 20.88, 14.73, 10.32, 7.92},
                                {31.91, 27.77, 21.87, 15.24, 10.59, 8.11},
                                {33.07, 28.71, 22.53, 15.63, 10.83, 8.29},
                                {33.97, 29.40, 22.96, 15.83, 10.91, 8.35},
                                {38.94, 33.64, 26.24, 18.03, 12.39, 9.48}}};
constexpr Published kTable4 = {{{346.57, 310.27, 253.10, 183.01, 130.76, 101.18},
                                {379.94, 335.89, 269.40, 191.72, 135.10, 103.83},
                                {399.93, 350.26, 278.72, 196.73, 137.80, 105.68},
                                {423.53, 368.58, 290.28, 0, 0, 0},
                                {},
                                {},
                                {}}};
constexpr Published kTable5 = {{{33.80, 30.48, 24.76, 17.89, 12.83, 9.88},
                                {37.19, 32.76, 26.32, 18.73, 13.16, 10.15},
                                {38.74, 33.93, 27.01, 19.05, 13.35, 10.24},
                                {42.07, 36.58, 28.86, 0, 0, 0},
                                {},
                                {},
                                {}}};
constexpr Published kTable6 = {{{0.72, 1.70, 3.90, 9.44, 21.99, 50.82},
                                {1.14, 2.68, 6.15, 14.86, 34.69, 80.41},
                                {1.80, 4.25, 9.76, 23.57, 54.82, 126.74},
                                {2.89, 6.81, 15.66, 37.85, 87.94, 202.91},
                                {4.51, 10.65, 24.46, 59.08, 137.34, 317.13},
                                {7.23, 17.06, 39.23, 94.77, 220.22, 507.10},
                                {11.39, 26.89, 61.83, 149.37, 347.27, 799.03}}};
constexpr Published kTable7 = {{{6, 8, 12, 21, 38, 80},
                                {8, 11, 17, 33, 61, 121},
                                {10, 15, 23, 48, 93, 192},
                                {12, 20, 32, 65, 131, 304},
                                {14, 26, 45, 94, 196, 436},
                                {19, 36, 67, 141, 306, 689},
                                {27, 49, 98, 206, 450, 1054}}};

// Visits every candidate of the rays of every `step`-th row. Returning the sum keeps the compiler from
// removing the work.
template <typename Method>
std::uint64_t VisitImage(const Method& method, bool perspective, int step) {
  std::uint64_t sum = 0;
  for (int y = 0; y < kSceneSize; y += step)
    for (int x = 0; x < kSceneSize; ++x)
      method.Visit(ScenePixelRay(x, y, perspective), [&](std::uint32_t k) { sum += k + 1; });
  return sum;
}

// Counts are printed without decimals.
std::string FigureText(double value, bool count) {
  return count ? std::to_string(static_cast<long>(value)) : ThreeDigits(value);
}

std::string Both(double ours, double published, bool count) {
  return FigureText(ours, count) + (published > 0 ? " (" + FigureText(published, count) + ")" : "");
}

Table PublishedTable(const std::string& title, const std::vector<SkalaCell>& cells, bool perspective,
                     const Published& published, const std::function<double(const SkalaCell&)>& figure,
                     bool count = false) {
  Table table;
  table.title = title;
  table.columns = {"objects"};
  for (const int size : kSkalaSizes) table.columns.push_back("size " + std::to_string(size));
  for (std::size_t row = 0; row < kSkalaObjects.size(); ++row) {
    std::vector<std::string> line = {std::to_string(kSkalaObjects[row])};
    for (std::size_t column = 0; column < kSkalaSizes.size(); ++column) {
      const auto cell = std::find_if(cells.begin(), cells.end(), [&](const SkalaCell& c) {
        return c.objects == kSkalaObjects[row] && c.size == kSkalaSizes[column] &&
               c.perspective == perspective;
      });
      line.push_back(cell == cells.end() ? "-" : Both(figure(*cell), published[row][column], count));
    }
    if (std::any_of(line.begin() + 1, line.end(), [](const std::string& text) { return text != "-"; }))
      table.rows.push_back(std::move(line));
  }
  return table;
}

Table MemoryTable(const std::vector<SkalaCell>& cells) {
  Table table;
  table.title = "BMSSM: memory, parallel rays, size 10";
  table.columns = {"objects", "boxes",          "circles",
                   "bitmaps", "(n + m)·p bits", "space subdivision, 2N³(q + 2)"};
  for (const SkalaCell& cell : cells) {
    if (cell.size != kSkalaSizes.front() || cell.perspective) continue;
    // The average number of objects per supervoxel, with one slice per pixel, is p·r³/N³.
    const double n = kSceneSize, q = cell.objects * (cell.size / n) * (cell.size / n) * (cell.size / n);
    table.rows.push_back({std::to_string(cell.objects), BytesText(static_cast<double>(cell.boxes_bytes)),
                          BytesText(static_cast<double>(cell.spheres_bytes)),
                          BytesText(static_cast<double>(cell.bitmaps_bytes)),
                          BytesText(2.0 * kSceneSize * cell.objects / 8),
                          BytesText(2 * n * n * n * (q + 2))});
  }
  table.notes.push_back(
      "The last column is the paper's formula for lists of objects in N³ supervoxels, with N = 256. Such "
      "lists "
      "are not built here.");
  return table;
}

}  // namespace

SkalaCell MeasureSkalaCell(int objects, int size, bool perspective, int repeats) {
  const std::vector<SceneBox> boxes = RandomBoxes(objects, size, perspective, kSeed);
  const BoxScan scan(boxes, perspective);
  const SphereScan spheres(boxes, perspective);
  std::optional<RowColumnBitmaps> bitmaps;
  volatile std::uint64_t sink = 0;
  std::vector<std::vector<double>> ms =
      TakeTurns(repeats, {[&] { sink = VisitImage(scan, perspective, kScanRows); },
                          [&] { sink = VisitImage(spheres, perspective, kScanRows); },
                          [&] { bitmaps.emplace(boxes, perspective); },
                          [&] { sink = VisitImage(*bitmaps, perspective, 1); }});

  SkalaCell cell;
  cell.objects = objects;
  cell.size = size;
  cell.perspective = perspective;
  constexpr double kRays = static_cast<double>(kSceneSize) * kSceneSize;
  cell.boxes_ns = 1e6 * Median(ms[0]) * kScanRows / kRays;
  cell.spheres_ns = 1e6 * Median(ms[1]) * kScanRows / kRays;
  cell.make_bitmaps_ms = Median(ms[2]);
  cell.bitmaps_ns = 1e6 * (cell.make_bitmaps_ms + Median(ms[3])) / kRays;
  cell.boxes_bytes = scan.bytes();
  cell.spheres_bytes = spheres.bytes();
  cell.bitmaps_bytes = bitmaps->bytes();
  // Count the hits for tables 6 and 7.
  std::uint64_t all = 0;
  for (int y = 0; y < kSceneSize; ++y)
    for (int x = 0; x < kSceneSize; ++x) {
      const SceneRay ray = ScenePixelRay(x, y, perspective);
      int hits = 0;
      bitmaps->Visit(ray, [&](std::uint32_t k) { hits += scan.Meets(ray, k); });
      all += static_cast<std::uint64_t>(hits);
      cell.max_hits = std::max(cell.max_hits, hits);
    }
  cell.mean_hits = static_cast<double>(all) / kRays;
  return cell;
}

std::vector<SkalaCell> MeasureSkala(int repeats) {
  std::vector<SkalaCell> cells;
  for (const bool perspective : {false, true})
    for (const int objects : kSkalaObjects)
      for (const int size : kSkalaSizes)
        cells.push_back(MeasureSkalaCell(objects, size, perspective, repeats));
  return cells;
}

std::vector<Table> SkalaTables(const std::vector<SkalaCell>& cells) {
  const auto boxes = [](const SkalaCell& cell) { return cell.boxes_ns / cell.bitmaps_ns; };
  const auto spheres = [](const SkalaCell& cell) { return cell.spheres_ns / cell.bitmaps_ns; };
  std::vector<Table> tables = {
      PublishedTable("BMSSM (Skala, table 2): parallel rays, efficiency against min-max boxes", cells, false,
                     kTable2, boxes),
      PublishedTable("BMSSM (table 3): parallel rays, against bounding circles", cells, false, kTable3,
                     spheres),
      PublishedTable("BMSSM (table 4): perspective rays, against min-max boxes", cells, true, kTable4, boxes),
      PublishedTable("BMSSM (table 5): perspective rays, against bounding spheres", cells, true, kTable5,
                     spheres),
      PublishedTable("BMSSM (table 6): boxes that a ray meets, on average", cells, false, kTable6,
                     [](const SkalaCell& cell) { return cell.mean_hits; }),
      PublishedTable(
          "BMSSM (table 7): boxes that a ray meets, at most", cells, false, kTable7,
          [](const SkalaCell& cell) { return static_cast<double>(cell.max_hits); }, true),
      MemoryTable(cells)};
  tables[0].notes.push_back(
      "Here and below, the first number was measured here, and the number in parentheses is the published "
      "one. "
      "That was measured on a processor of 1989 with 32-bit words, whose floating-point comparison cost 10 "
      "integer operations.");
  tables[0].notes.push_back(
      "Words have 64 bits now, and finding the next bit of a word is one instruction, so many objects with "
      "few "
      "candidates gain more than they did in the paper. Both methods visit candidates one by one, so many "
      "candidates gain less.");
  tables[2].notes.push_back(
      "The published ratios are those of a processor on which the six divisions of a box test in space cost "
      "hundreds of cycles. Here they cost a few cycles, and they overlap.");
  tables[5].notes.push_back(
      "The scenes are our own, random and seeded. Maxima differ from the published ones because of the "
      "random "
      "content of the densest pixel.");
  return tables;
}

Json SkalaJson(const std::vector<SkalaCell>& cells) {
  Json json = Json::array();
  for (const SkalaCell& cell : cells)
    json.push_back(
        {{"objects", cell.objects},
         {"size", cell.size},
         {"perspective", cell.perspective},
         {"seed", kSeed},
         {"ns_per_ray",
          {{"boxes", cell.boxes_ns}, {"spheres", cell.spheres_ns}, {"bitmaps", cell.bitmaps_ns}}},
         {"make_bitmaps_ms", cell.make_bitmaps_ms},
         {"mean_hits", cell.mean_hits},
         {"max_hits", cell.max_hits},
         {"bytes",
          {{"boxes", cell.boxes_bytes}, {"spheres", cell.spheres_bytes}, {"bitmaps", cell.bitmaps_bytes}}}});
  return json;
}

}  // namespace facetless
