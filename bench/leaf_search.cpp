#include "bench/leaf_search.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "bench/leaf_tree.h"
#include "bench/statistics.h"
#include "render/accel/bmssm.h"
#include "render/baseline/box_tree.h"
#include "render/kernels/tile_kernel.h"
#include "render/trace/prepare.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// A scan tests at most this many boxes.
constexpr double kMostScanTests = 4e8;

struct Pixel {
  int column, row;
};

// The known result of a ray. It is used when the search alone is measured.
struct Winner {
  std::uint32_t leaf = kNoIndex;
  double depth = INFINITY;
};

// The search of one ray. It keeps the nearest root so far.
class Query {
 public:
  // Without a `winner`, the query calls the solver. With one, it uses the known result.
  Query(std::span<const CertifiedLeaf> leaves, const Camera& camera, Pixel pixel, const Winner* winner)
      : leaves_(leaves),
        x_(pixel.column + 0.5 - 0.5 * camera.width_px),
        y_(pixel.row + 0.5 - 0.5 * camera.height_px),
        winner_(winner) {}

  // Returns the nearest depth so far.
  double TestLeaf(std::uint32_t index) {
    ++candidates;
    if (winner_ != nullptr) {
      if (index == winner_->leaf) nearest = *winner_;
      return nearest.depth;
    }
    TileHit hit;
    if (SolveSample(leaves_[index], kDoubleArithmetic, x_, y_, &hit) == SampleRoot::kHit &&
        hit.depth < nearest.depth)
      nearest = {index, hit.depth};
    return nearest.depth;
  }

  Winner nearest;
  std::uint64_t candidates = 0;

 private:
  std::span<const CertifiedLeaf> leaves_;
  const double x_, y_;
  const Winner* winner_;
};

class Comparison {
 public:
  Comparison(const Camera& camera, const LeafSpans& leaves, int repeats)
      : camera_(camera), repeats_(repeats) {
    const std::vector<LeafSpans> one_part{leaves};
    build_bitmaps_ms_ = MeasureMilliseconds(
        [&] { tiles_ = std::make_unique<TileLeaves>(one_part, camera.width_px, camera.height_px); });
  }

  Result<void> Run(LeafSearches& searches) {
    // Add the bitmaps.
    ChooseRays();
    Add("bitmaps (BMSSM)", build_bitmaps_ms_, BitmapBytes(), 1, &Comparison::TraceBitmaps);
    // Add the plain scans, which go through the leaves from front to back, as the bitmaps do.
    SortByDepth();
    const std::size_t stride = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::ceil(static_cast<double>(rays_.size()) *
                                              static_cast<double>(leaves().size()) / kMostScanTests)));
    Add("scan of boxes", 0, leaves().size() * sizeof(ScreenBox), stride, &Comparison::TraceScan);
    circles_ms_ = MeasureMilliseconds([&] { MakeCircles(); });
    Add("scan of circles", circles_ms_, circles_.size() * sizeof(Circle), stride, &Comparison::TraceCircles);
    // Add the trees.
    const double tree_ms = MeasureMilliseconds([&] { tree_.emplace(leaves()); });
    Add("bounding volume hierarchy", tree_ms, tree_->bytes(), 1, &Comparison::TraceTree);
    std::vector<ScreenBox> boxes;
    for (const CertifiedLeaf& leaf : leaves())
      boxes.push_back({leaf.box.col_begin(), leaf.box.col_end(), leaf.box.row_begin(), leaf.box.row_end(),
                       leaf.near_depth});
    std::optional<Result<BoxTree>> embree;
    const double embree_ms = MeasureMilliseconds([&] { embree = BoxTree::Build(boxes); });
    if (!embree->ok()) return embree->error();
    embree_ = &embree->value();
    Add("Embree, user geometry", embree_ms, embree_->bytes(), 1, &Comparison::TraceEmbree);
    Measure(searches);
    return {};
  }

 private:
  struct Circle {
    float x, y, radius2, near_depth;
  };
  struct Tally {
    std::uint64_t candidates = 0;
  };
  // If `known` is not null, it has the results of the same rays, and the solver is not called.
  using Tracer = void (Comparison::*)(std::size_t stride, const Winner* known, std::vector<Winner>& found,
                                      Tally& tally) const;

  struct Competitor {
    LeafSearch search;
    std::size_t stride = 1;
    Tracer tracer = nullptr;
    std::vector<Winner> found, unused;
    Tally tally, unused_tally;
  };

  std::span<const CertifiedLeaf> leaves() const { return tiles_->leaves().certified; }

  void ChooseRays() {
    for (int tile = 0; tile < tiles_->tiles_x() * tiles_->tiles_y(); ++tile) {
      const int x = tile % tiles_->tiles_x(), y = tile / tiles_->tiles_x();
      if ((x + 2 * y) % kTileStep != 0) continue;
      chosen_.push_back(tile);
      for (int i = y * kTileSize; i < std::min((y + 1) * kTileSize, camera_.height_px); ++i)
        for (int j = x * kTileSize; j < std::min((x + 1) * kTileSize, camera_.width_px); ++j)
          rays_.push_back({j, i});
    }
  }

  void Add(const char* name, double build_ms, std::size_t bytes, std::size_t stride, Tracer tracer) {
    Competitor competitor;
    competitor.search.name = name;
    competitor.search.build_ms = build_ms;
    competitor.search.bytes = bytes;
    competitor.stride = stride;
    competitor.tracer = tracer;
    competitors_.push_back(std::move(competitor));
  }

  void Measure(LeafSearches& searches) {
    std::vector<std::function<void()>> turns;
    for (Competitor& competitor : competitors_)
      turns.emplace_back([&] {
        competitor.found.assign(rays_.size(), {});
        competitor.tally = {};
        (this->*competitor.tracer)(competitor.stride, nullptr, competitor.found, competitor.tally);
      });
    const auto runs = TakeTurns(repeats_, turns);
    // Measure the search alone.
    const std::vector<Winner>& bitmaps = competitors_.front().found;
    turns.clear();
    for (Competitor& competitor : competitors_)
      turns.emplace_back([&] {
        competitor.unused.resize(rays_.size());
        (this->*competitor.tracer)(competitor.stride, bitmaps.data(), competitor.unused,
                                   competitor.unused_tally);
      });
    const auto searching = TakeTurns(repeats_, turns);
    for (std::size_t c = 0; c < competitors_.size(); ++c) {
      Competitor& competitor = competitors_[c];
      LeafSearch& search = competitor.search;
      for (std::size_t i = 0; i < rays_.size(); i += competitor.stride) {
        ++search.rays;
        search.hits += competitor.found[i].depth < INFINITY;
        search.unlike += competitor.found[i].depth != bitmaps[i].depth;
      }
      const double rays = static_cast<double>(search.rays);
      search.ns_per_ray = 1e6 * Median(runs[c]) / rays;
      search.search_ns_per_ray = 1e6 * Median(searching[c]) / rays;
      search.candidates_per_ray = static_cast<double>(competitor.tally.candidates) / rays;
      searches.methods.push_back(search);
    }
  }

  void TraceBitmaps(std::size_t, const Winner* known, std::vector<Winner>& found, Tally& tally) const {
    TileBitmaps bitmaps;
    std::size_t ray = 0;
    for (const int tile : chosen_) {
      const int column = tile % tiles_->tiles_x() * kTileSize, row = tile / tiles_->tiles_x() * kTileSize;
      bitmaps.Build(*tiles_, tile);
      const auto list = tiles_->Tile(tile);
      for (int i = row; i < std::min(row + kTileSize, camera_.height_px); ++i)
        for (int j = column; j < std::min(column + kTileSize, camera_.width_px); ++j, ++ray) {
          Query query(leaves(), camera_, {j, i}, known != nullptr ? known + ray : nullptr);
          WalkBitmaps(bitmaps.Row(i - row), bitmaps.Column(j - column), bitmaps.words(), list, query);
          found[ray] = query.nearest;
          tally.candidates += query.candidates;
        }
    }
  }

  void WalkBitmaps(const std::uint64_t* row, const std::uint64_t* column, int words,
                   std::span<const TileLeaf> list, Query& query) const {
    for (int word = 0; word < words; ++word)
      for (std::uint64_t bits = row[word] & column[word]; bits != 0; bits &= bits - 1) {
        const std::uint32_t index = list[static_cast<std::size_t>(64 * word + __builtin_ctzll(bits))].leaf;
        if (leaves()[index].near_depth > query.nearest.depth) return;
        query.TestLeaf(index);
      }
  }

  std::size_t BitmapBytes() const { return tiles_->bytes() - tiles_->leaf_bytes() + tiles_->bits() / 8; }

  void TraceScan(std::size_t stride, const Winner* known, std::vector<Winner>& found, Tally& tally) const {
    for (std::size_t i = 0; i < rays_.size(); i += stride) {
      Query query(leaves(), camera_, rays_[i], known != nullptr ? known + i : nullptr);
      for (const std::uint32_t k : by_depth_) {
        if (!leaves()[k].box.Holds(rays_[i].column, rays_[i].row)) continue;
        if (leaves()[k].near_depth > query.nearest.depth) break;
        query.TestLeaf(k);
      }
      found[i] = query.nearest;
      tally.candidates += query.candidates;
    }
  }

  void SortByDepth() {
    for (std::uint32_t k = 0; k < leaves().size(); ++k) by_depth_.push_back(k);
    std::sort(by_depth_.begin(), by_depth_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(leaves()[a].near_depth, a) < std::pair(leaves()[b].near_depth, b);
    });
  }

  void MakeCircles() {
    // The circle encloses the box's pixel centres. Half a pixel more covers the rounding many times over.
    for (const std::uint32_t k : by_depth_) {
      const CertifiedLeaf& leaf = leaves()[k];
      const SampleBox box = leaf.box;
      const double half_width = 0.5 * (box.col_end() - box.col_begin()),
                   half_height = 0.5 * (box.row_end() - box.row_begin());
      const float near = std::nextafter(static_cast<float>(leaf.near_depth), -INFINITY);
      circles_.push_back({static_cast<float>(box.col_begin() + half_width),
                          static_cast<float>(box.row_begin() + half_height),
                          static_cast<float>(half_width * half_width + half_height * half_height), near});
    }
  }

  void TraceCircles(std::size_t stride, const Winner* known, std::vector<Winner>& found, Tally& tally) const {
    for (std::size_t i = 0; i < rays_.size(); i += stride) {
      Query query(leaves(), camera_, rays_[i], known != nullptr ? known + i : nullptr);
      const float x = static_cast<float>(rays_[i].column) + 0.5f, y = static_cast<float>(rays_[i].row) + 0.5f;
      for (std::uint32_t k = 0; k < circles_.size(); ++k) {
        const float dx = x - circles_[k].x, dy = y - circles_[k].y;
        if (dx * dx + dy * dy > circles_[k].radius2) continue;
        if (circles_[k].near_depth > query.nearest.depth) break;
        query.TestLeaf(by_depth_[k]);
      }
      found[i] = query.nearest;
      tally.candidates += query.candidates;
    }
  }

  void TraceTree(std::size_t stride, const Winner* known, std::vector<Winner>& found, Tally& tally) const {
    for (std::size_t i = 0; i < rays_.size(); i += stride) {
      Query query(leaves(), camera_, rays_[i], known != nullptr ? known + i : nullptr);
      tree_->Visit(rays_[i].column, rays_[i].row, [&](std::uint32_t leaf) { return query.TestLeaf(leaf); });
      found[i] = query.nearest;
      tally.candidates += query.candidates;
    }
  }

  void TraceEmbree(std::size_t stride, const Winner* known, std::vector<Winner>& found, Tally& tally) const {
    for (std::size_t i = 0; i < rays_.size(); i += stride) {
      Query query(leaves(), camera_, rays_[i], known != nullptr ? known + i : nullptr);
      embree_->Visit(
          rays_[i].column, rays_[i].row,
          [](void* context, std::uint32_t leaf) { return static_cast<Query*>(context)->TestLeaf(leaf); },
          &query);
      found[i] = query.nearest;
      tally.candidates += query.candidates;
    }
  }

  const Camera& camera_;
  const int repeats_;
  double build_bitmaps_ms_ = 0, circles_ms_ = 0;
  std::unique_ptr<TileLeaves> tiles_;
  std::vector<int> chosen_;  // chosen tiles
  std::vector<Pixel> rays_;
  std::vector<std::uint32_t> by_depth_;  // leaves from front to back
  std::vector<Circle> circles_;          // in the same order
  std::optional<LeafTree> tree_;
  const BoxTree* embree_ = nullptr;
  std::vector<Competitor> competitors_;
};

}  // namespace

Result<LeafSearches> MeasureLeafSearches(const std::string& file, const Model& model, const Camera& camera,
                                         int repeats) {
  const Scene scene(model);
  const Result<CameraFrame> frame = MakeFrame(camera, model.Diagonal());
  if (!frame) return frame.error();
  // The view owns the coefficients to which the leaves point.
  const Result<PreparedView> view = PrepareView(scene.data(), camera, frame.value(), {});
  if (!view) return view.error();
  LeafSearches searches;
  searches.file = file;
  searches.view = camera.name;
  const LeafSpans all = view.value().tiles->leaves();
  const LeafSpans certified{all.certified, all.places, {}, {}};
  searches.leaves = certified.size();
  searches.left_out = all.size() - certified.size();
  if (certified.size() == 0)
    return Error{ErrorCode::kNothingUsable, file + " shows no leaf in view '" + camera.name + "'"};
  if (auto done = Comparison(camera, certified, repeats).Run(searches); !done) return done.error();
  return searches;
}

Table LeafSearchTable(const LeafSearches& searches) {
  Table table;
  table.title = "Structures over the leaves of " + searches.file + ", view " + searches.view;
  table.columns = {"structure",
                   "build",
                   "memory",
                   "per ray",
                   "search alone",
                   "candidates per ray",
                   "search against bitmaps",
                   "rays asked",
                   "unlike"};
  const double bitmaps_ns = searches.methods.empty() ? 1 : searches.methods.front().search_ns_per_ray;
  for (const LeafSearch& search : searches.methods)
    table.rows.push_back(
        {search.name, MillisecondsText(search.build_ms), BytesText(static_cast<double>(search.bytes)),
         ThreeDigits(search.ns_per_ray) + " ns", ThreeDigits(search.search_ns_per_ray) + " ns",
         ThreeDigits(search.candidates_per_ray), TimesText(search.search_ns_per_ray / bitmaps_ns),
         std::to_string(search.rays), std::to_string(search.unlike)});
  table.notes = {
      "The structures hold " + std::to_string(searches.leaves) + " leaves with a certificate; " +
          std::to_string(searches.left_out) +
          " leaves without one are left out. \"Search alone\" knows the answer of each ray and asks no "
          "solver.",
      "For the bitmaps, the build is sorting and listing per tile, and the time of a ray includes its share "
      "of "
      "making the bitmaps of its tile. Their memory is that of the lists and of the bitmaps of all tiles at "
      "once; the renderer holds those of one tile per thread."};
  return table;
}

Json LeafSearchJson(const LeafSearches& searches) {
  Json methods = Json::array();
  for (const LeafSearch& search : searches.methods)
    methods.push_back({{"name", search.name},
                       {"build_ms", search.build_ms},
                       {"bytes", search.bytes},
                       {"rays", search.rays},
                       {"ns_per_ray", search.ns_per_ray},
                       {"search_ns_per_ray", search.search_ns_per_ray},
                       {"candidates_per_ray", search.candidates_per_ray},
                       {"hits", search.hits},
                       {"unlike", search.unlike}});
  return {{"file", searches.file},
          {"view", searches.view},
          {"leaves", searches.leaves},
          {"left_out", searches.left_out},
          {"methods", std::move(methods)}};
}

}  // namespace facetless
