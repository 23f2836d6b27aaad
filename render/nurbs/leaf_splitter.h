// LeafSplitter: divides projected patches into leaves, and drops the pieces that are not visible or are
// trimmed away.
//
//     LeafSplitter splitter(window, &budget);
//     BezierNet& net = splitter.Begin(degree_u, degree_v);
//     Fill(net);  // the caller writes the values and the errors
//     splitter.Split(patch, &leaves, &arena);
//
//  1. Every point of the patch that a sample ray meets, in front of the eye plane and inside the trimmed
//     face, lies in a returned leaf. A dropped piece is proven to lie outside the window, behind the eye,
//     between the sample centres, or outside the trimmed face.
//  2. A leaf is either certified (leaf.h) or hard. A hard leaf contains at most kHardSamples sample centres,
//     or cannot be split further, or is one for which splitting does not help: it is seen edge-on, or its
//     errors are so large that it may lie anywhere (edge_on.h).
//  3. The work for one patch is bounded. After SplitPatch::max_nodes pieces, each remaining piece becomes a
//     leaf with the flag kLeafGivenUp; there are at most kMaxLevels + 1 of them. A hard leaf that contains
//     more than kHardSamples sample centres counts as the number of pieces into which its samples would be
//     divided.
//  4. The result depends only on the patch, the view and the trimming, not on the calling thread.
//  5. If pixels may be refined (SplitWindow::grid_x, grid_y), pieces that lie between the pixel centres, and that
//     may hold a sample of the grid, become leaves in a list of their own. All other leaves are the same as without
//     refinement.
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

// The largest number of sample centres in a hard leaf. For so few samples, solving them one by one costs less
// than splitting further.
inline constexpr int kHardSamples = 4;
// The largest number of sample centres in a leaf that a trim curve crosses. For more samples, splitting costs
// less than a trim query for each sample.
inline constexpr int kTrimmedSamples = 64;

struct SplitWindow {
  double half_width = 0,
         half_height = 0;  // half the size of the image, in samples: X/W lies within ±half_width
  double near_depth = 0;   // perspective views: points with W ≤ near_depth·Q are not visible
  bool perspective = false;
  int grid_x = 1, grid_y = 1;   // the grid of samples in which a pixel may be refined; 1×1: none is
  KernelArithmetic arithmetic;  // arithmetic of the kernel that will solve the leaves
  const NetOperations* nets = nullptr;
};

// State shared by all splitters of one view: the cancellation flag, and the memory that remains for leaves.
struct SplitBudget {
  const std::atomic<bool>* cancel = nullptr;  // may be null
  std::atomic<std::int64_t> bytes_left{0};

  bool Exhausted() const { return bytes_left.load(std::memory_order_relaxed) < 0; }
  bool Stopped() const { return Exhausted() || (cancel && cancel->load(std::memory_order_relaxed)); }
};

// Storage for coefficients. It grows in blocks whose size is proportional to the memory already allocated.
// The coefficients never move, and are freed all at once.
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
  RectClass trim_class = RectClass::kMixed;  // class of the whole patch
  std::uint32_t placed_face = 0, patch = 0;
  PatchBounds bounds;  // what the net spans
  // The work limit of law 3. Patches of valid models stay far below it (see NodeLimit).
  std::uint64_t max_nodes = std::numeric_limits<std::uint64_t>::max();
};

// The largest number of pieces into which a patch may be split, given the number of sample centres in the box
// of its image.
std::uint64_t NodeLimit(double samples, int degree_u, int degree_v);

class LeafSplitter {
 public:
  // `budget` must outlive the splitter. After the budget is exhausted or cancelled, Split skips the remaining
  // pieces, and the caller must abandon the view.
  LeafSplitter(const SplitWindow& window, SplitBudget* budget);
  ~LeafSplitter();

  // Returns the net that the caller fills before it calls Split. Begin sets the degrees; the splitter owns
  // the storage.
  BezierNet& Begin(int degree_u, int degree_v);
  // Appends the leaves of the net to `leaves`, their coefficients and nets to `arena`. `between` receives the
  // leaves of law 5, whose boxes count samples of the grid; it may be null if no pixel is refined.
  void Split(const SplitPatch& patch, LeafLists* leaves, LeafLists* between, CoefficientArena* arena);

  std::uint64_t nodes() const { return nodes_; }  // number of patches and sub-patches examined so far

 private:
  struct Node;
  void Visit(Node* node);
  void VisitHalves(const Node& node, Direction direction, RectClass trim);
  double HalfWindow() const;
  // Counts a node, and returns whether the patch has used up its work limit. The node holds `samples` samples.
  bool IsWorkUsedUp(const Node& node, double samples);
  // Returns the list that receives the leaf of a node.
  LeafLists* ListFor(const Node& node) const;
  // Classifies the range of a leaf against the trimming: the rectangle and its overlap with its neighbours.
  RectClass ClassifyRect(const ParameterRect& rect) const;
  // Keeps a piece in front of the eye as a certified leaf, or as a hard one if it is small enough or seen
  // edge-on. Returns false if it must be halved; `verdict` then says how much a halving in each direction
  // improves the bound.
  bool KeepLeaf(const Node& node, RectClass trim, const NetBox& box, SampleBox seen_in, NetVerdict* verdict);
  // Returns the direction of the halving that improves the bound most. Along a fold no bound ever holds, so
  // there, and for a piece that crosses the eye plane, only the extent decides.
  Direction HalvingDirection(const BezierNet& net, bool in_front, const NetVerdict& verdict) const;
  // These append the leaf of a node whose near depth and box are known. `monomials` has as many coefficients
  // as the leaf's planes.
  void KeepCertified(CertifiedLeaf leaf, const Node& node, RectClass trim, const double* monomials);
  void KeepHard(HardKind kind, double near_depth, SampleBox box, const Node& node, RectClass trim);
  // Fills in the data that leaves of both kinds take from their patch and node.
  void FillHeader(const Node& node, RectClass trim, LeafHeader* leaf) const;
  void Spend(std::size_t leaf_bytes, std::size_t coefficients);
  Node* Level(int level, int side);

  SplitWindow window_;
  SplitBudget* budget_;
  std::vector<std::unique_ptr<Node>> levels_;  // two per level
  const SplitPatch* patch_ = nullptr;
  LeafLists *leaves_ = nullptr, *between_ = nullptr;
  CoefficientArena* arena_ = nullptr;
  bool lost_ =
      false;  // this patch already has the one leaf that represents all its pieces that may lie anywhere
  std::uint64_t nodes_ = 0;
  std::uint64_t node_limit_ = 0;  // value of nodes_ at which the splitter gives up this patch
  std::uint64_t between_left_ =
      0;  // pieces between the pixel centres that may still be examined for this patch
};

}  // namespace facetless
