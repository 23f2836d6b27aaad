// The tile kernel: for each sample of one screen tile, the nearest hit among the tile's leaves (or every
// hit).
//
//  1. Samples are taken in packets of 4×2. A packet's candidates are the set bits of (R_i | R_i+1) & (S_j | …
//     | S_j+3), walked front to back; the walk ends at the first leaf that begins behind the hits of all
//     lanes.
//  2. Each lane runs the homogeneous Newton–Cramer iteration on its leaf until the leaf's own bounds prove a
//     miss or pin the root down to kSolverTolerance; then it is frozen. Lanes never influence each other, so
//     all builds give the same bits.
//  3. The kernel knows numbers only, and of leaves without a certificate only their headers. Trimming, borders
//     of patches and those leaves are the HitResolver's.
//  4. There is a kernel in double and one in float for each instruction set, of one source. The float one
//     brings each pixel into the leaf's own frame in double, iterates there in float, and adds what it finds
//     to the leaf's depth in double.
//  5. A doubt counts from the depth at which it arose: what a nearer hit hides is no doubt. Where every hit
//     is asked for, nothing is hidden, and all doubts of a ray count.
//
// A. Sisojevs, "3D scene rendering" (2011), eq. 10–13, has the Newton–Cramer step in the form W/M·(M_U, M_V);
// with F = (X − x_R·W, Y − y_R·W) formed first, Cramer's rule on F and its derivatives is the same step
// without the cancellation of 3×3 determinants.
#pragma once

#include <array>
#include <cstdint>

#include "render/base/vec.h"
#include "render/nurbs/leaf.h"
#include "render/view/doubt.h"

namespace facetless {

inline constexpr int kPacketWidth = 4, kPacketHeight = 2, kPacketLanes = kPacketWidth * kPacketHeight;
// Newton steps before a lane is given up as unconverged. Law 5 of leaf.h halves the error bound at least, and
// then squares it: six suffice.
inline constexpr int kMaxIterations = 12;

struct TileHit {
  double depth, s, t;
  double error;  // of the depth, mm; infinite where there is no bound
};

struct TileCounters {
  std::uint64_t candidates = 0;  // packets × leaves looked at
  std::uint64_t solves = 0;      // lanes that started an iteration
  std::uint64_t iterations = 0;  // Newton steps of all lanes
  std::uint64_t fallbacks = 0;   // lanes × leaves without a certificate
  std::uint64_t trim_tests = 0;
};

// What turns a leaf's tangents into the model's axes.
struct ViewAxes {
  Vec3 right, down, forward;
  double pixel_x = 1, pixel_y = 1;  // as CameraFrame's
};

// Takes the roots of one leaf and one ray.
class RootSink {
 public:
  // `kept`: the trimming keeps the root.
  virtual void Add(const TileHit& hit, std::uint8_t doubt, bool kept) = 0;

 protected:
  ~RootSink() = default;
};

// What the kernel asks of the tracer around it. (x, y) is the ray's pixel relative to the image centre, and
// `leaf` the leaf's LeafId.
class HitResolver {
 public:
  // Whether the hit at (s, t) of a certified leaf with kLeafTrimmed lies inside its face; adds to *doubt.
  virtual bool IsInsideFace(std::uint32_t leaf, double s, double t, double x, double y,
                            std::uint8_t* doubt) = 0;
  // Whether a root on the border of its patch is the certified leaf's own; adds to *doubt and to hit->error.
  virtual bool OwnsBorderRoot(std::uint32_t leaf, double x, double y, TileHit* hit, std::uint8_t* doubt) = 0;
  // Adds the roots of a leaf without a certificate that are nearer than `limit`. Returns the doubts that
  // belong to no root.
  virtual std::uint8_t SolveUncertified(std::uint32_t leaf, double x, double y, double limit,
                                        RootSink* roots) = 0;
  // Takes a hit of sample row·tile_size + column of the tile, where TileJob::every_hit is set.
  virtual void RecordHit(int sample, std::uint32_t leaf, const TileHit& hit, std::uint8_t doubt) = 0;

 protected:
  ~HitResolver() = default;
};

struct TileJob {
  // The view's leaves, the kernel that they were made for, the names of the tile's, front to back, and its
  // bitmaps (accel/bmssm.h).
  LeafSpans leaves;
  KernelArithmetic arithmetic;
  const std::uint32_t* list = nullptr;
  const std::uint64_t* row_bits = nullptr;
  const std::uint64_t* column_bits = nullptr;
  int words = 0, tile_size = 0;
  int column = 0, row = 0;    // first sample
  int columns = 0, rows = 0;  // samples inside the image
  double half_width = 0, half_height = 0;
  double near_depth = 0;      // hits must lie beyond; −inf in orthographic views
  bool coincidences = false;  // look for hits of other faces within the error of the nearest hit's depth

  HitResolver* resolver = nullptr;
  bool every_hit = false;  // report every hit to HitResolver::RecordHit, instead of keeping the nearest

  // tile_size² entries each, row by row; beyond the image they hold nothing. `leaf` is a LeafId, or kNoIndex for
  // a miss, and then only depth (+inf) and doubt are set besides.
  double* depth = nullptr;
  double* error = nullptr;  // of the depth: no other face is nearer by more, either
  double* s = nullptr;
  double* t = nullptr;
  std::uint32_t* leaf = nullptr;
  std::uint8_t* doubt = nullptr;
  // Of hits, unit normals along ds × dt of the leaf's parameters, and what they need; zero where the two are
  // too close to parallel, or the leaf has no certificate. Null: not wanted.
  std::array<float, 3>* normal = nullptr;
  ViewAxes axes;
  TileCounters* counters = nullptr;
};

using TileKernel = void (*)(const TileJob&);

enum class SampleRoot : std::uint8_t { kMiss, kHit, kUnconverged };

namespace kernel_scalar {
void TraceTile(const TileJob& job);
// One sample against one certified leaf, without trimming: what each lane of the tile kernel does.
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
