// TileTracer: runs the tile kernel on the tiles of one prepared view. It answers the kernel's questions about
// trimming, and solves leaves without a certificate with the fallback solver.
//
//     TileTracer tracer(shared, kernel, /*certify=*/false);
//     tracer.Trace(tile, /*crossings=*/nullptr);
//     if (!tracer.empty()) Copy(tracer.depth, tracer.leaf, tracer.doubt);
//
//  1. Each thread has its own TileTracer, which owns the bitmaps, the solver's stack and the results of a
//     tile. The view and the scene are shared and read-only.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "render/accel/bmssm.h"
#include "render/kernels/tile_kernel.h"
#include "render/trace/fallback_solver.h"
#include "render/trace/trace_shared.h"

namespace facetless {

// One crossing of a ray with a face.
struct Crossing {
  std::uint32_t sample;  // row·width + column of the image
  std::uint32_t leaf;    // LeafId
  TileHit hit;
  std::uint8_t doubt;
};

class TileTracer final : private HitResolver {
 public:
  // `certify`: also detect coincident faces, which takes more time.
  TileTracer(const TraceShared& shared, TileKernel kernel, bool certify);

  // Traces tile `index` and stores the nearest hits in the arrays below. If `crossings` is not null, all hits
  // of every ray are appended to it as well. `active` restricts the samples (TileJob::active).
  void Trace(int index, std::vector<Crossing>* crossings, const std::uint32_t* active = nullptr);

  int column() const { return job_.column; }  // first sample of the last tile
  int row() const { return job_.row; }
  int columns() const { return job_.columns; }
  int rows() const { return job_.rows; }

  bool empty() const { return job_.words == 0; }  // no leaf meets the tile, and the arrays below are not set

  static constexpr int kSamples = kTileSize * kTileSize;
  std::array<double, kSamples> depth, error, s, t;
  std::array<std::uint32_t, kSamples> leaf;
  std::array<std::uint8_t, kSamples> doubt;
  std::array<std::array<float, 3>, kSamples> normal;  // as TileJob::normal; not set with crossings
  TileCounters counters;                              // counters of all tiles so far
  CheckStats check;                                   // results for the roots of leaves without a certificate

  std::size_t bitmap_bytes() const { return bitmaps_.bytes(); }

 private:
  // A root of a leaf, with bounds of its errors in s and t.
  struct Root {
    double s, t, error_s, error_t;
    double jacobian_sign;  // sign of the Jacobian of (s, t) → pixel; 0: unknown
  };
  Root MakeRoot(const CertifiedLeaf& leaf, double s, double t) const;
  static Root MakeRoot(const FallbackRoot& root);
  using LeafSite = TraceShared::LeafSite;
  // Queries the trim index at the root, with the errors of the root converted to native parameters. `window` may be null.
  TrimAnswer QueryTrim(const LeafSite& site, const TrimWindow* window, const Root& root, double cosine) const;
  // The index, in the arrays of the tile, of the ray through (x, y), relative to the image centre.
  int SampleAt(double x, double y) const;
  // Calls found(leaf, root, hit) for every root of the untrimmed placed face on the ray. Returns false if the
  // work limit of the ray does not suffice for all roots.
  template <typename Found>
  bool ForEachRoot(std::uint32_t placed_face, double x, double y, const Found& found);
  // Returns whether a root on the border of its patch (OnPatchBorder) belongs to the leaf and not to its
  // neighbour. Adds to *doubt if that is not proven, and widens the hit's error by the difference from the
  // neighbour's depth.
  bool OwnsBorderRoot(const LeafSite& site, const Root& root, double x, double y, TileHit* hit,
                      std::uint8_t* doubt);
  // The root of the same ray in the patch across the border.
  struct Neighbour {
    double depth, error;
    bool within;  // not proven to lie beyond the neighbour's own border
  };
  std::optional<Neighbour> FindNeighbourRoot(const LeafSite& site, const Root& root, const TileHit& hit,
                                             double x, double y);
  // Returns whether the face has the same root again on the other side of the seam that `answer` reports.
  bool OnSeam(const LeafSite& site, const Root& root, const TrimAnswer& answer, double depth, double x,
              double y);
  bool IsInsideFace(const LeafSite& site, const TrimWindow* window, const Root& root, double x, double y,
                    std::uint8_t* doubt);
  bool IsTrimmed(std::uint32_t leaf) const;
  // Adds the crossing of a seam leaf if the number of the face's other crossings has the wrong parity
  // (seams.h).
  std::uint8_t SolveSeam(const SeamLeaf& leaf, double x, double y, RootSink* roots);

  // The functions of HitResolver.
  bool IsInsideFace(std::uint32_t leaf, double s, double t, double x, double y, std::uint8_t* doubt) override;
  bool OwnsBorderRoot(std::uint32_t leaf, double x, double y, TileHit* hit, std::uint8_t* doubt) override;
  std::uint8_t SolveUncertified(std::uint32_t leaf, double x, double y, double limit,
                                RootSink* roots) override;
  void RecordHit(int sample, std::uint32_t leaf, const TileHit& hit, std::uint8_t doubt) override;

  // The site of a leaf that the kernel asks about, and the window of its trim index. Both are kept until another leaf
  // takes their place, because the kernel returns to a leaf in several packets.
  struct KeptSite {
    LeafSite site;
    TrimWindow window;  // of a certified leaf with kLeafTrimmed
  };
  const KeptSite& KeptSiteOf(std::uint32_t leaf);
  const LeafSite& SiteOf(std::uint32_t leaf) { return KeptSiteOf(leaf).site; }
  std::uint8_t DoubtForRoot(std::uint32_t leaf, const FallbackRoot& root, double x, double y) const;

  const TraceShared& shared_;
  TileKernel kernel_;
  TileBitmaps bitmaps_;
  TileJob job_;
  FallbackSolver solver_;
  std::array<RayWork, kSamples> work_;  // work limits of the rays of the tile
  std::vector<FallbackRoot> roots_;
  std::vector<RootTwin> seam_roots_;
  std::vector<Crossing>* crossings_ = nullptr;
  static constexpr std::uint32_t kKeptSites = 32;  // the trimmed leaves of a row of packets
  std::array<KeptSite, kKeptSites> kept_sites_;    // by the last bits of the leaf
};

}  // namespace facetless
