// LeafSplitter: cuts projected patches into leaves, keeping only what the view and the trimming leave of
// them.
//
//  1. Every point of the patch that some sample ray meets, in front of the eye plane and inside the trimmed
//     face, lies in a leaf that is returned. What is dropped is proven to be outside the window, behind the
//     eye, between the sample centres, or trimmed away.
//  2. A leaf is certified (leaf.h) or hard. Hard ones hold at most kHardSamples sample centres, or could not
//     be split further, or are seen edge-on, or lie anywhere (edge_on.h), where splitting leads nowhere.
//  3. The work for one patch is bounded: what is left of it after SplitPatch::max_nodes pieces becomes leaves
//     that say so (HardKind::kGivenUp), one for each piece that waits, at most kMaxLevels + 1. A leaf that the last
//     level leaves with many sample centres counts as the pieces that they would make.
//  4. The result depends on the patch, the view and the trimming only, not on the calling thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "render/base/large_pages.h"
#include "render/nurbs/angle_map.h"
#include "render/nurbs/bezier.h"
#include "render/nurbs/leaf.h"
#include "render/nurbs/net_operations.h"
#include "render/nurbs/trim_index.h"

namespace facetless {

// Sample centres in a leaf without a certificate: few enough that solving them one by one costs less than
// splitting on.
inline constexpr int kHardSamples = 4;
// Sample centres in a leaf that the trimming cuts, above which splitting is cheaper than asking for each
// sample.
inline constexpr int kTrimmedSamples = 64;

struct SplitWindow {
  double half_width = 0, half_height = 0;  // of the image, in samples: X/W runs over ±half_width
  double near_depth = 0;                   // perspective: what has W ≤ near_depth·Q is not seen
  bool perspective = false;
  KernelArithmetic arithmetic;  // of the kernel that will solve the leaves
  const NetOperations* nets = nullptr;
};

// What all splitters of one view share: a stop sign, and the memory that their leaves may take together.
struct SplitBudget {
  const std::atomic<bool>* cancel = nullptr;  // may be null
  std::atomic<std::int64_t> bytes_left{0};

  bool Exhausted() const { return bytes_left.load(std::memory_order_relaxed) < 0; }
  bool Stopped() const { return Exhausted() || (cancel && cancel->load(std::memory_order_relaxed)); }
};

// Storage of coefficients: grows in blocks, each of a share of what is there already, never moves, freed as a
// whole.
class CoefficientArena {
 public:
  double* Allocate(std::size_t count);
  float* AllocateFloats(std::size_t count) { return reinterpret_cast<float*>(Allocate((count + 1) / 2)); }
  std::size_t bytes() const { return bytes_; }

 private:
  std::vector<std::vector<double, LargePages<double>>> blocks_;
  std::size_t used_ = 0, capacity_ = 0, bytes_ = 0;
};

struct SplitPatch {
  DepthRule rule;
  SpanParameter u_map, v_map;  // Bézier to native parameters of the patch
  const FaceTrim* trim = nullptr;
  RectClass trim_class = RectClass::kMixed;  // of the whole patch
  std::uint32_t placed_face = 0, patch = 0;
  PatchBounds bounds;  // what the net spans
  // Law 3. No patch of a sound model comes near to its nodes: see NodeLimit.
  std::uint64_t max_nodes = std::numeric_limits<std::uint64_t>::max();
};

// The pieces that a patch may be split into, for so many sample centres in the box of its image.
std::uint64_t NodeLimit(double samples, int degree_u, int degree_v);

class LeafSplitter {
 public:
  // `budget` must outlive the splitter. Once it is stopped, Split leaves out what is left: the caller gives
  // the view up.
  LeafSplitter(const SplitWindow& window, SplitBudget* budget);
  ~LeafSplitter();

  // The net that the caller fills before Split: degrees set by Begin, storage belongs to the splitter.
  BezierNet& Begin(int degree_u, int degree_v);
  // Appends the leaves of the net to `leaves`, their coefficients and nets to `arena`.
  void Split(const SplitPatch& patch, LeafLists* leaves, CoefficientArena* arena);

  std::uint64_t nodes() const { return nodes_; }  // patches and sub-patches looked at so far

 private:
  struct Node;
  void Visit(const Node& node);
  void VisitHalves(const Node& node, Direction direction, RectClass trim);
  // Append the leaf of a node, of which near depth and box are known; `monomials`: as many as the leaf's planes
  // have.
  void KeepCertified(CertifiedLeaf leaf, const Node& node, RectClass trim, const double* monomials);
  void KeepHard(HardKind kind, double near_depth, SampleBox box, const Node& node, RectClass trim);
  // What leaves of both kinds have from their patch and node.
  void FillHeader(const Node& node, RectClass trim, LeafHeader* leaf) const;
  void Spend(std::size_t leaf_bytes, std::size_t coefficients);
  Node* Level(int level, int side);

  SplitWindow window_;
  SplitBudget* budget_;
  std::vector<std::unique_ptr<Node>> levels_;  // two per level
  const SplitPatch* patch_ = nullptr;
  LeafLists* leaves_ = nullptr;
  CoefficientArena* arena_ = nullptr;
  bool lost_ = false;  // a leaf of this patch stands for all its pieces that may lie anywhere
  std::uint64_t nodes_ = 0;
  std::uint64_t node_limit_ = 0;  // nodes_ at which this patch is given up
};

}  // namespace facetless
