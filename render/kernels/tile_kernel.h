// The tile kernel: for each sample of one screen tile, the nearest hit among the tile's leaves (or every
// hit).
//
//  1. Samples are processed in packets of 4×4, in as many registers as they fill. The candidates of a packet
//     are the set bits of (R_i | … | R_i+3) & (S_j | … | S_j+3), visited from front to back. The visit ends at
//     the first leaf that begins behind the hits of all lanes.
//  2. Each lane runs the homogeneous Newton–Cramer iteration on its leaf until the bounds of the leaf prove a
//     miss, or locate the root to within the leaf's root_error. The lane is then frozen. Lanes never
//     influence each other, so all builds give the same bits.
//  3. The kernel works on numbers only. Trimming, borders of patches and leaves without a certificate are
//     left to the HitResolver.
//  4. Each instruction set has a kernel in double and one in float, compiled from the same source. The float
//     kernel transforms each pixel into the frame of the leaf in double, iterates there in float, and adds
//     the result to the depth of the leaf in double.
//  5. A doubt is attached to the depth at which it arose, and a nearer hit hides it. If every hit is
//     requested, nothing is hidden, and all doubts of a ray count.
//
// A. Sisojevs, "3D scene rendering" (2011), eq. 10–13, gives the Newton–Cramer step in the form W/M·(M_U,
// M_V). The kernel computes F = (X − x_R·W, Y − y_R·W) first. Cramer's rule, applied to F and its
// derivatives, gives the same step without the cancellation in 3×3 determinants.
#pragma once

#include <array>
#include <cstdint>

#include "render/accel/tile_leaf.h"
#include "render/base/vec.h"
#include "render/nurbs/leaf.h"
#include "render/view/doubt.h"

namespace facetless {

// Of packets of 4×4 the walk examines 40 % fewer candidates than of packets of 4×2.
inline constexpr int kPacketWidth = 4, kPacketHeight = 4, kPacketLanes = kPacketWidth * kPacketHeight;
// The number of Newton steps after which a lane is given up as unconverged. By law 5 of leaf.h, each step at
// least halves the error bound and eventually squares it, so six steps suffice.
inline constexpr int kMaxIterations = 12;

struct TileHit {
  double depth, s, t;
  double error;  // bound of the depth error, mm; infinite if there is no bound
};

struct TileCounters {
  std::uint64_t candidates = 0;  // packets × leaves examined
  std::uint64_t solves = 0;      // lanes that started an iteration
  std::uint64_t iterations = 0;  // Newton steps of all lanes
  std::uint64_t fallbacks = 0;   // lanes × leaves without a certificate
  std::uint64_t trim_tests = 0;
};

// The axes and pixel sizes that convert the tangents of a leaf to model axes.
struct ViewAxes {
  Vec3 right, down, forward;
  double pixel_x = 1, pixel_y = 1;  // as CameraFrame's
};

// Receives the roots of one ray in one leaf.
class RootSink {
 public:
  // Adds a root. `kept`: the root lies inside the trimmed face.
  virtual void Add(const TileHit& hit, std::uint8_t doubt, bool kept) = 0;

 protected:
  ~RootSink() = default;
};

// The questions that the kernel leaves to the tracer. (x, y) is the pixel of the ray relative to the image
// centre.
class HitResolver {
 public:
  // Returns whether the hit at (s, t) of a certified leaf with kLeafTrimmed lies inside its face; adds to
  // *doubt.
  virtual bool IsInsideFace(std::uint32_t leaf, double s, double t, double x, double y,
                            std::uint8_t* doubt) = 0;
  // Returns whether a root on the border of its patch is the certified leaf's own; adds to *doubt and to
  // hit->error.
  virtual bool OwnsBorderRoot(std::uint32_t leaf, double x, double y, TileHit* hit, std::uint8_t* doubt) = 0;
  // Adds the roots of a leaf without a certificate that are nearer than `limit` to *roots. Returns the doubts
  // that belong to no root.
  virtual std::uint8_t SolveUncertified(std::uint32_t leaf, double x, double y, double limit,
                                        RootSink* roots) = 0;
  // Receives a hit of sample row·kTileSize + column of the tile. Called only if TileJob::every_hit is set.
  virtual void RecordHit(int sample, std::uint32_t leaf, const TileHit& hit, std::uint8_t doubt) = 0;

 protected:
  ~HitResolver() = default;
};

struct TileJob {
  // The view's leaves, the kernel that they were made for, those of the tile, front to back, and its bitmaps
  // (accel/bmssm.h).
  LeafSpans leaves;
  KernelArithmetic arithmetic;
  const TileLeaf* list = nullptr;
  const std::uint64_t* row_bits = nullptr;
  const std::uint64_t* column_bits = nullptr;
  int words = 0;
  int column = 0, row = 0;    // first sample
  int columns = 0, rows = 0;  // samples inside the image
  // By row of the tile: bit j is set if sample j of the row is traced. Null: all samples are. The results of
  // the other samples are those of a miss.
  const std::uint32_t* active = nullptr;
  double half_width = 0, half_height = 0;
  double near_depth = 0;      // hits must lie beyond this depth; −inf in orthographic views
  bool coincidences = false;  // look for hits of other faces within the error of the nearest hit's depth

  HitResolver* resolver = nullptr;
  bool every_hit = false;  // report every hit to HitResolver::RecordHit, instead of keeping the nearest

  // The results: kTileSize² entries each, row by row. Entries outside the image are not set. For a miss,
  // `leaf` is kNoIndex, depth is +inf, doubt is set, and the other entries are not.
  double* depth = nullptr;
  double* error = nullptr;  // bound of the depth error; no other face is nearer by more than this, either
  double* s = nullptr;
  double* t = nullptr;
  std::uint32_t* leaf = nullptr;
  std::uint8_t* doubt = nullptr;
  // Unit normals of the hits, along ds × dt of the leaf's parameters. A normal is zero if ds and dt are too
  // close to parallel, or if the leaf has no certificate. Null: normals are not requested. `axes` is needed
  // for them.
  std::array<float, 3>* normal = nullptr;
  ViewAxes axes;
  TileCounters* counters = nullptr;
};

using TileKernel = void (*)(const TileJob&);

enum class SampleRoot : std::uint8_t { kMiss, kHit, kUnconverged };

namespace kernel_scalar {
void TraceTile(const TileJob& job);
// Solves one sample on one certified leaf, without trimming, exactly as each lane of the tile kernel does.
SampleRoot SolveSample(const CertifiedLeaf& leaf, const KernelArithmetic& arithmetic, double x, double y,
                       TileHit* hit);
}  // namespace kernel_scalar
namespace kernel_scalar_float {
void TraceTile(const TileJob& job);
SampleRoot SolveSample(const CertifiedLeaf& leaf, const KernelArithmetic& arithmetic, double x, double y,
                       TileHit* hit);
}  // namespace kernel_scalar_float
namespace kernel_avx2 {
void TraceTile(const TileJob& job);
}
namespace kernel_avx2_float {
void TraceTile(const TileJob& job);
}
namespace kernel_avx512 {
void TraceTile(const TileJob& job);
}
namespace kernel_avx512_float {
void TraceTile(const TileJob& job);
}

// By the kernel of `arithmetic`, which the leaf was made for.
inline SampleRoot SolveSample(const CertifiedLeaf& leaf, const KernelArithmetic& arithmetic, double x,
                              double y, TileHit* hit) {
  return arithmetic.is_single() ? kernel_scalar_float::SolveSample(leaf, arithmetic, x, y, hit)
                                : kernel_scalar::SolveSample(leaf, arithmetic, x, y, hit);
}

}  // namespace facetless
