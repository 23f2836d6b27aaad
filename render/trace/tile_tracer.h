// TileTracer: runs the tile kernel over one prepared view, with trimming and the fallback solver behind it.
//
//  1. One per thread: it owns the bitmaps, the solver's stack and a tile's results. The view and the scene
//     are shared and only read.
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
  // `certify`: spend what it takes to tell coincident faces from certified ones.
  TileTracer(const TraceShared& shared, TileKernel kernel, bool certify);

  // The nearest hits of tile `index`, in the arrays below. With `crossings`, every hit of every ray is
  // appended to it too.
  void Trace(int index, std::vector<Crossing>* crossings);

  int column() const { return job_.column; }  // of the last tile
  int row() const { return job_.row; }
  int columns() const { return job_.columns; }
  int rows() const { return job_.rows; }

  bool empty() const { return job_.words == 0; }  // no leaf meets it: nothing below is set

  static constexpr int kSamples = kTileSize * kTileSize;
  std::array<double, kSamples> depth, error, s, t;
  std::array<std::uint32_t, kSamples> leaf;
  std::array<std::uint8_t, kSamples> doubt;
  std::array<std::array<float, 3>, kSamples> normal;  // as TileJob's; not with crossings
  TileCounters counters;                              // of all tiles so far
  CheckStats check;                                   // of the roots of leaves without a certificate

  std::size_t bitmap_bytes() const { return bitmaps_.bytes(); }

 private:
  // A root of a leaf, and how far off in s and t it may be.
  struct Root {
    double s, t, error_s, error_t;
    double jacobian_sign;  // of (s, t) → pixel; 0: not known
  };
  Root RootOf(const CertifiedLeaf& leaf, double s, double t) const;
  static Root RootOf(const FallbackRoot& root);
  using LeafSite = TraceShared::LeafSite;
  // With its errors, in native parameters.
  TrimAnswer QueryTrim(const LeafSite& site, const Root& root, double cosine) const;
  // Where the ray through (x, y), relative to the image centre, lies in the arrays of the tile.
  int SampleAt(double x, double y) const;
  // Calls back found(leaf, root, hit) for every root of the placed face on the ray, untrimmed. Returns false
  // if the ray's work does not suffice for all of them.
  template <typename Found>
  bool EveryRoot(std::uint32_t placed_face, double x, double y, const Found& found);
  // Whether the root on the border of its patch (OnPatchBorder) is the leaf's, and not its neighbour's; adds
  // to *doubt where that is not proven, and to the hit's error what the neighbour says of the depth.
  bool OwnsBorderRoot(const LeafSite& site, const Root& root, double x, double y, TileHit* hit,
                      std::uint8_t* doubt);
  // The root of the same ray in the patch across the border.
  struct Neighbour {
    double depth, error;
    bool within;  // not proven to lie beyond its own border
  };
  std::optional<Neighbour> NeighbourOf(const LeafSite& site, const Root& root, const TileHit& hit, double x,
                                       double y);
  // Whether the face has the root again on the other side of the seam that `answer` names.
  bool OnSeam(const LeafSite& site, const Root& root, const TrimAnswer& answer, double depth, double x,
              double y);
  bool IsInsideFace(const LeafSite& site, const Root& root, double x, double y, std::uint8_t* doubt);
  bool IsTrimmed(std::uint32_t leaf) const;
  // The crossing that a seam leaf's face owes the ray, if the others of the face don't come out as they
  // should.
  std::uint8_t SolveSeam(const SeamLeaf& leaf, double x, double y, RootSink* roots);

  // As HitResolver.
  bool IsInsideFace(std::uint32_t leaf, double s, double t, double x, double y, std::uint8_t* doubt) override;
  bool OwnsBorderRoot(std::uint32_t leaf, double x, double y, TileHit* hit, std::uint8_t* doubt) override;
  std::uint8_t SolveUncertified(std::uint32_t leaf, double x, double y, double limit,
                                RootSink* roots) override;
  void RecordHit(int sample, std::uint32_t leaf, const TileHit& hit, std::uint8_t doubt) override;

  // For what the kernel asks about: it asks many times of one leaf before it asks of the next.
  const LeafSite& SiteOf(std::uint32_t leaf);
  std::uint8_t DoubtOf(std::uint32_t leaf, const FallbackRoot& root, double x, double y) const;

  const TraceShared& shared_;
  TileKernel kernel_;
  TileBitmaps bitmaps_;
  TileJob job_;
  FallbackSolver solver_;
  std::array<RayWork, kSamples> work_;  // of the tile's rays
  std::vector<FallbackRoot> roots_;
  std::vector<RootTwin> seam_roots_;
  std::vector<Crossing>* crossings_ = nullptr;
  LeafSite site_;  // SiteOf's
};

}  // namespace facetless
