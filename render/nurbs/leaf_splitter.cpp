#include "render/nurbs/leaf_splitter.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/nurbs/edge_on.h"

namespace facetless {
namespace {

// This many halvings resolve 2^-32 of a patch in both directions. A piece that still has no certificate is
// left to the subdivision solver, which is exact to the last digit.
constexpr int kMaxLevels = kMostPatchHalvings;

// The slack of every screen box in samples, in addition to the net's own error. It covers the rounding of a
// division and the overlap of neighbouring leaves.
constexpr double kBoxSlack = 0x1p-20;

constexpr std::size_t kArenaBlock = 1 << 15, kLargestArenaBlock = 1 << 20;  // doubles

}  // namespace

double* CoefficientArena::Allocate(std::size_t count) {
  if (blocks_.empty() || used_ + count > capacity_) {
    capacity_ = std::max(std::clamp(bytes_ / sizeof(double) / 2, kArenaBlock, kLargestArenaBlock), count);
    blocks_.emplace_back(capacity_);
    bytes_ += capacity_ * sizeof(double);
    used_ = 0;
  }
  double* result = blocks_.back().data() + used_;
  used_ += count;
  return result;
}

struct LeafSplitter::Node : OwnedNet {
  ParameterRect rect;
  LeafPlace place;  // `rect` is RectOf(place)
  RectClass trim = RectClass::kMixed;
  int level = 0;
  bool between = false;  // it holds no pixel centre, and is split for the samples of the grid
};

namespace {

enum class Visibility : std::uint8_t { kHidden, kSeen };

// Tests homogeneous half-spaces, which is valid for any sign of W: if all control points are on the wrong
// side of one plane of the frustum, no ray of the window meets the patch in front of the near plane.
Visibility CullFrustum(const BezierNet& net, const SplitWindow& window) {
  bool left = true, right = true, above = true, below = true, behind = window.perspective;
  const int n = net.points();
  const double slack_x = net.error[kX] + window.half_width * net.error[kW],
               slack_y = net.error[kY] + window.half_height * net.error[kW];
  for (int i = 0; i < n; ++i) {
    const double x = net.at(i, kX), y = net.at(i, kY), w = net.at(i, kW);
    const double limit_x = (window.half_width + kBoxSlack) * w + slack_x,
                 limit_y = (window.half_height + kBoxSlack) * w + slack_y;
    left = left && x < -limit_x;
    right = right && x > limit_x;
    above = above && y < -limit_y;
    below = below && y > limit_y;
    behind = behind && w + net.error[kW] <= window.near_depth * net.at(i, kQ);
  }
  return left || right || above || below || behind ? Visibility::kHidden : Visibility::kSeen;
}

// Returns whether every part of the net may lie anywhere in the window. This is so if its errors are wider
// than the window, or leave almost no correct digit of its weights, and if the net is so close to the middle
// of the window that no piece of it could be proven to lie outside. Halving does not change this, because it
// makes no error smaller and no number larger.
bool MayLieAnywhere(const BezierNet& net, double half_window) {
  // The two factors leave a margin between nets that are given up and nets whose pieces can be separated. A
  // net with parts of both kinds is halved.
  constexpr double kDigits = 1024, kRoom = 4;
  double x = 0, y = 0, w = 0;
  for (int i = 0; i < net.points(); ++i) {
    x = std::max(x, std::fabs(net.at(i, kX)));
    y = std::max(y, std::fabs(net.at(i, kY)));
    w = std::max(w, std::fabs(net.at(i, kW)));
  }
  const double window = half_window * w, blur = half_window * net.error[kW];
  if (window > std::max(net.error[kX], net.error[kY]) + kDigits * blur) return false;
  return !(x > kRoom * (window + net.error[kX] + blur)) && !(y > kRoom * (window + net.error[kY] + blur));
}

// Returns whether the net's corners alone prove that its image is no line: they span a larger area than
// errors and rounding can explain.
bool CornersSpanArea(const BezierNet& net, const NetBox& box, double half_window) {
  const double size = std::max(std::max(-box.x_low, box.x_high), std::max(-box.y_low, box.y_high));
  // The error of a corner: the net's own error, scaled from the window's size to the net's size, and
  // rounding. FitLine allows four such errors.
  const double error = 64 * (box.error * std::max(1.0, size / half_window) + 0x1p-49 * size);
  const int corners[] = {0, net.degree_v, net.points() - net.stride(), net.points() - 1};
  double x[4], y[4];
  for (int k = 0; k < 4; ++k) {
    const double inverse = 1 / net.at(corners[k], kW);
    x[k] = net.at(corners[k], kX) * inverse - (k > 0 ? x[0] : 0);
    y[k] = net.at(corners[k], kY) * inverse - (k > 0 ? y[0] : 0);
  }
  const double longest = (box.x_high - box.x_low) + (box.y_high - box.y_low);
  return std::fabs(x[1] * y[2] - y[1] * x[2]) > error * longest ||
         std::fabs(x[1] * y[3] - y[1] * x[3]) > error * longest ||
         std::fabs(x[2] * y[3] - y[2] * x[3]) > error * longest;
}

// The samples of a grid of `grid_x` × `grid_y` per pixel that a box may hold, with its error; nothing if there
// are none.
std::optional<SampleBox> SamplesIn(const NetBox& box, const SplitWindow& window, int grid_x, int grid_y) {
  const auto first = [](double low) { return std::max(0.0, std::ceil(low - 0.5)); };
  const auto last = [](double high, double count) { return std::min(count, std::floor(high - 0.5) + 1); };
  const double slack_x = kBoxSlack + grid_x * box.error, slack_y = kBoxSlack + grid_y * box.error;
  const double half_x = grid_x * window.half_width, half_y = grid_y * window.half_height;
  const double c0 = first(grid_x * box.x_low - slack_x + half_x),
               c1 = last(grid_x * box.x_high + slack_x + half_x, 2 * half_x);
  const double r0 = first(grid_y * box.y_low - slack_y + half_y),
               r1 = last(grid_y * box.y_high + slack_y + half_y, 2 * half_y);
  if (!(c0 < c1 && r0 < r1)) return std::nullopt;
  return SampleBox::HalfOpen(static_cast<int>(c0), static_cast<int>(c1), static_cast<int>(r0),
                             static_cast<int>(r1));
}

}  // namespace

std::uint64_t NodeLimit(double samples, int degree_u, int degree_v) {
  // Splitting ends at kHardSamples for a piece without a certificate, and the boxes of neighbouring pieces
  // overlap. A patch of higher degrees may fold over itself more often.
  constexpr double kLeastNodes = 1 << 14, kNodesPerSample = 4;
  return static_cast<std::uint64_t>(kLeastNodes + kNodesPerSample * std::max(degree_u, degree_v) * samples);
}

LeafSplitter::LeafSplitter(const SplitWindow& window, SplitBudget* budget)
    : window_(window), budget_(budget) {}
LeafSplitter::~LeafSplitter() = default;

LeafSplitter::Node* LeafSplitter::Level(int level, int side) {
  const std::size_t index = 2 * static_cast<std::size_t>(level) + side;
  while (levels_.size() <= index) levels_.push_back(std::make_unique<Node>());
  return levels_[index].get();
}

BezierNet& LeafSplitter::Begin(int degree_u, int degree_v) {
  Node* root = Level(0, 0);
  root->SetDegrees(degree_u, degree_v);
  return root->net;
}

void LeafSplitter::Split(const SplitPatch& patch, LeafLists* leaves, LeafLists* between,
                         CoefficientArena* arena) {
  patch_ = &patch;
  leaves_ = leaves;
  between_ = between;
  arena_ = arena;
  lost_ = false;
  node_limit_ = std::numeric_limits<std::uint64_t>::max();
  Node* root = Level(0, 0);
  root->place = {0, patch.patch, 0, 0};
  root->rect = RectOf(root->place, patch.bounds);
  root->level = 0;
  root->between = false;
  root->trim = patch.trim_class;
  Visit(root);
}

void LeafSplitter::Visit(Node* at) {
  Node& node = *at;
  if (!node.between) ++nodes_;
  if (budget_->Stopped()) return;
  const BezierNet& net = node.net;

  // Find the sample centres in the projected box. If there are none, no ray meets the piece.
  const double half_window = HalfWindow();
  const NetBox box = window_.nets->project(net, patch_->rule, half_window);
  // A box that is not measured gives no information: the weights are positive, but too small to divide by.
  const bool measured = box.in_front && box.error < INFINITY;
  if (!measured && CullFrustum(net, window_) == Visibility::kHidden) return;
  if (window_.perspective && box.in_front && box.far_depth <= window_.near_depth) return;
  const SampleBox whole_window = SampleBox::HalfOpen(0, static_cast<int>(2 * window_.half_width), 0,
                                                     static_cast<int>(2 * window_.half_height));
  SampleBox seen_in = whole_window;
  if (box.in_front) {
    std::optional<SampleBox> samples;
    if (!node.between) samples = SamplesIn(box, window_, 1, 1);
    if (!samples && window_.grid_x * window_.grid_y > 1) {
      node.between = true;
      samples = SamplesIn(box, window_, window_.grid_x, window_.grid_y);
    }
    if (!samples) return;
    seen_in = *samples;
  }

  // Classify the piece against the trimming, unless the class of the parent applies.
  RectClass trim = node.trim;
  if (trim == RectClass::kMixed && node.level > 0) {
    trim = ClassifyRect(node.rect);
    if (trim == RectClass::kOutside) return;
  }

  // Give up a patch whose pieces no halving can locate. This includes a piece that crosses the eye plane at
  // the last level: the near plane has already removed pieces that are merely near the eye. One leaf
  // represents all such pieces of the patch.
  const double nearest_seen = window_.perspective ? window_.near_depth : -INFINITY;
  if ((!box.in_front && node.level >= kMaxLevels) ||
      (!node.between && !(box.in_front && box.error < half_window) && MayLieAnywhere(net, half_window))) {
    if (lost_) return;
    lost_ = true;
    KeepHard(HardKind::kEdgeOn, nearest_seen, whole_window, node, trim);
    return;
  }

  // Give up the remaining pieces of a patch that has used up its work limit.
  if (IsWorkUsedUp(node, seen_in.samples())) {
    KeepHard(HardKind::kGivenUp, box.in_front ? box.near_depth : nearest_seen, seen_in, node, trim);
    return;
  }

  // Certify the piece, or keep it as a hard leaf if it is small enough, or halve it.
  NetVerdict verdict;
  if (box.in_front && KeepLeaf(node, trim, box, seen_in, &verdict)) return;
  VisitHalves(node, HalvingDirection(net, box.in_front, verdict), trim);
}

bool LeafSplitter::IsWorkUsedUp(const Node& node, double samples) {
  if (node.level == 0) {
    const std::uint64_t limit =
        std::min(patch_->max_nodes, NodeLimit(samples, node.net.degree_u, node.net.degree_v));
    node_limit_ = nodes_ + limit;
    between_left_ = limit * static_cast<std::uint64_t>(window_.grid_x * window_.grid_y);
  }
  if (!node.between) return nodes_ > node_limit_;
  if (between_left_ > 0) --between_left_;
  return between_left_ == 0;
}

LeafLists* LeafSplitter::ListFor(const Node& node) const {
  return node.between ? between_ : leaves_;
}

double LeafSplitter::HalfWindow() const {
  return std::max(window_.half_width, window_.half_height);
}

RectClass LeafSplitter::ClassifyRect(const ParameterRect& rect) const {
  const auto u = [&](double s) {
    return patch_->u_map.ToNative(std::clamp(rect.U(s), patch_->bounds.u_low, patch_->bounds.u_high));
  };
  const auto v = [&](double t) {
    return patch_->v_map.ToNative(std::clamp(rect.V(t), patch_->bounds.v_low, patch_->bounds.v_high));
  };
  constexpr double kBorder = 1 + 2 * kBorderOverlap;
  return patch_->trim->Classify(u(-kBorder), u(kBorder), v(-kBorder), v(kBorder));
}

bool LeafSplitter::KeepLeaf(const Node& node, RectClass trim, const NetBox& box, SampleBox seen_in,
                            NetVerdict* verdict) {
  const BezierNet& net = node.net;
  CertifiedLeaf leaf;
  double monomials[kNetComponents * kMaxNetPoints];
  *verdict = window_.nets->certify(net, patch_->rule, window_.arithmetic, &leaf, monomials);
  const double samples = seen_in.samples();
  const bool last_level = node.level >= kMaxLevels;
  if (verdict->certified) {
    const bool trimmed_small = trim == RectClass::kInside || samples <= kTrimmedSamples;
    if (!trimmed_small && !last_level) return false;
    leaf.near_depth = box.near_depth - leaf.depth_error;
    leaf.box = seen_in;
    KeepCertified(leaf, node, trim, monomials);
    return true;
  }
  const bool edge_on =
      samples > kHardSamples && !CornersSpanArea(net, box, HalfWindow()) && FitLine(net).is_line;
  if (!edge_on && samples > kHardSamples && !last_level) return false;
  // The fallback solver will be called at each sample. Therefore a leaf that keeps many samples uses as much
  // of the patch's work limit as the pieces into which its samples would be divided.
  if (!edge_on) {
    std::uint64_t& left = node.between ? between_left_ : node_limit_;
    left -= std::min(left, static_cast<std::uint64_t>(samples / kHardSamples));
  }
  KeepHard(edge_on ? HardKind::kEdgeOn : HardKind::kSubdivide, box.near_depth, seen_in, node, trim);
  return true;
}

Direction LeafSplitter::HalvingDirection(const BezierNet& net, bool in_front,
                                         const NetVerdict& verdict) const {
  const Extent extent = window_.nets->measure(net, patch_->rule, HalfWindow(), in_front);
  if (!verdict.certified && verdict.kappa_halved_u != verdict.kappa_halved_v) {
    const Direction best = verdict.kappa_halved_v < verdict.kappa_halved_u ? Direction::kV : Direction::kU;
    if ((best == Direction::kV ? extent.v : extent.u) >= 1) return best;
  }
  return extent.v > extent.u ? Direction::kV : Direction::kU;
}

void LeafSplitter::VisitHalves(const Node& node, Direction direction, RectClass trim) {
  Node* low = Level(node.level + 1, 0);
  Node* high = Level(node.level + 1, 1);
  low->SetDegrees(node.net.degree_u, node.net.degree_v);
  high->SetDegrees(node.net.degree_u, node.net.degree_v);
  low->place = Halved(node.place, direction, /*upper=*/false);
  high->place = Halved(node.place, direction, /*upper=*/true);
  low->rect = high->rect = node.rect;
  if (direction == Direction::kU) {
    low->rect.u_half = high->rect.u_half = node.rect.u_half / 2;
    low->rect.u_mid = node.rect.u_mid - low->rect.u_half;
    high->rect.u_mid = node.rect.u_mid + low->rect.u_half;
  } else {
    low->rect.v_half = high->rect.v_half = node.rect.v_half / 2;
    low->rect.v_mid = node.rect.v_mid - low->rect.v_half;
    high->rect.v_mid = node.rect.v_mid + low->rect.v_half;
  }
  low->trim = high->trim = trim;
  low->level = high->level = node.level + 1;
  low->between = high->between = node.between;
  window_.nets->halve(node.net, direction, &low->net, &high->net);
  Visit(low);
  Visit(high);
}

void LeafSplitter::FillHeader(const Node& node, RectClass trim, LeafHeader* leaf) const {
  leaf->placed_face = patch_->placed_face;
  leaf->borders = BordersOf(node.rect);
  if (trim == RectClass::kMixed) leaf->flags |= kLeafTrimmed;
}

void LeafSplitter::Spend(std::size_t leaf_bytes, std::size_t coefficients) {
  const auto bytes = static_cast<std::int64_t>(leaf_bytes + coefficients * sizeof(double));
  budget_->bytes_left.fetch_sub(bytes, std::memory_order_relaxed);
}

void LeafSplitter::KeepCertified(CertifiedLeaf leaf, const Node& node, RectClass trim,
                                 const double* monomials) {
  FillHeader(node, trim, &leaf);
  const std::size_t count = static_cast<std::size_t>(leaf.planes()) * leaf.points();
  if (window_.arithmetic.is_single()) {
    float* kept = arena_->AllocateFloats(count);
    for (std::size_t i = 0; i < count; ++i) kept[i] = static_cast<float>(monomials[i]);
    leaf.coefficients = kept;
  } else {
    double* kept = arena_->Allocate(count);
    std::copy_n(monomials, count, kept);
    leaf.coefficients = kept;
  }
  LeafLists& list = *ListFor(node);
  list.certified.push_back(leaf);
  list.places.push_back(node.place);
  Spend(sizeof(CertifiedLeaf) + sizeof(LeafPlace), count);
}

void LeafSplitter::KeepHard(HardKind kind, double near_depth, SampleBox box, const Node& node,
                            RectClass trim) {
  const BezierNet& net = node.net;
  HardLeaf leaf;
  leaf.near_depth = near_depth;
  leaf.box = box;
  leaf.degree_u = static_cast<std::uint8_t>(net.degree_u);
  leaf.degree_v = static_cast<std::uint8_t>(net.degree_v);
  leaf.flags = FlagsOf(patch_->rule);
  FillHeader(node, trim, &leaf);
  const std::size_t count = static_cast<std::size_t>(kNetComponents) * net.points();
  double* kept = arena_->Allocate(count);
  std::copy_n(net.value, count, kept);
  leaf.net = kept;
  std::copy_n(net.error, int{kNetComponents}, leaf.error);
  leaf.place = node.place;
  leaf.kind = kind;
  ListFor(node)->hard.push_back(leaf);
  Spend(sizeof(HardLeaf), count);
}

}  // namespace facetless
