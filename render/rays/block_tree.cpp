#include "render/rays/block_tree.h"

#include <algorithm>
#include <cmath>

#include "render/base/parallel.h"

namespace facetless {
namespace {

constexpr double kUnit = 0x1p-24;        // roundoff of a float
constexpr double kBoxMargin = 0x1p-21;   // 8 roundoffs: the start's, and that of its difference from a side
constexpr double kReach = 2;             // sizes of the scene
constexpr double kLeastSlope = 0x1p-12;  // law 6 of ray_blocks.h
constexpr double kThicker = 1 + 0x1p-8;  // likewise
// A piece with a slack above this is not told from its neighbours.
constexpr double kMostSlack = 0.125;
// Blocks of which the squares of all rows stay within the range of a float.
constexpr double kLeastRadius = 0x1p-30, kMostRadius = 0x1p40;

float RoundedDown(double x) {
  const float rounded = static_cast<float>(x);
  return rounded <= x ? rounded : std::nextafter(rounded, -INFINITY);
}
float RoundedUp(double x) {
  return -RoundedDown(-x);
}

double Size(Vec3 v) {
  return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

// One affine function of space with coefficients that are floats.
struct Row {
  Vec3 row;
  double offset = 0;

  double At(Vec3 p) const { return Dot(row, p) + offset; }
  double Slack(double radius) const { return kUnit * (20 * Size(row) * radius + 4 * std::fabs(offset) + 8); }
  static Row Rounded(Vec3 row, double offset) {
    return {{static_cast<float>(row.x), static_cast<float>(row.y), static_cast<float>(row.z)},
            static_cast<float>(offset)};
  }
};

struct Extent1 {
  double low = INFINITY, high = -INFINITY;
  void Add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

// The functions x, y and z of a piece. Nothing if it has no two sides, or the slack is too large.
class Frame {
 public:
  Frame(const PieceShape& shape, double radius) : shape_(shape), radius_(radius) {}

  bool Make() {
    const int p = shape_.degree_u, q = shape_.degree_v;
    const Vec3 c00 = At(0, 0), c01 = At(0, q), c10 = At(p, 0), c11 = At(p, q);
    const Vec3 a = 0.25 * ((c10 - c00) + (c11 - c01)), b = 0.25 * ((c01 - c00) + (c11 - c10));
    const Vec3 n = Cross(a, b);
    const double square = Dot(n, n);
    if (!(square > 0) || !std::isfinite(square)) return false;
    const Vec3 middle = 0.25 * ((c00 + c01) + (c10 + c11));
    if (!MakeRow((1 / square) * Cross(b, n), middle, &x)) return false;
    if (!MakeRow((1 / square) * Cross(n, a), middle, &y)) return false;
    // z is in units of the sides' mean length.
    const double length = std::sqrt(square);
    const Vec3 up = (1 / (length * std::sqrt(length))) * n;
    Extent1 heights;
    for (const Vec3& point : shape_.points) heights.Add(Dot(up, point));
    z = Row::Rounded(up, -0.5 * (heights.low + heights.high));
    double most = 0;
    for (const Vec3& point : shape_.points) most = std::max(most, std::fabs(z.At(point)));
    h = (most + z.Slack(radius_) + shape_.error * Size(z.row)) * kThicker;
    least_dz = kLeastSlope * Size(z.row);
    return std::isfinite(h) && z.Slack(radius_) < kMostSlack;
  }

  // How far inside the parallelogram the borders may be: law 2 of ray_blocks.h.
  double Inner(const Row& row, bool across_u) const {
    const int p = shape_.degree_u, q = shape_.degree_v;
    double inner = INFINITY;
    for (int i = 0; i <= (across_u ? q : p); ++i) {
      inner = std::min(inner, -row.At(across_u ? At(0, i) : At(i, 0)));
      inner = std::min(inner, row.At(across_u ? At(p, i) : At(i, q)));
    }
    return inner - row.Slack(radius_) - shape_.error * Size(row.row) -
           h * 5 * kUnit * Size(row.row) / least_dz;
  }

  Row x, y, z;
  double h = 0, least_dz = 0;

 private:
  Vec3 At(int k, int l) const {
    return shape_.points[static_cast<std::size_t>(k) * (shape_.degree_v + 1) + l];
  }

  // Scales and moves a function so that its magnitude, with slack and error, is at most 1 at all control points.
  bool MakeRow(Vec3 row, Vec3 middle, Row* made) const {
    Extent1 range;
    for (const Vec3& point : shape_.points) range.Add(Dot(row, point - middle));
    const double center = 0.5 * (range.low + range.high) + Dot(row, middle);
    double half = 0.5 * (range.high - range.low);
    if (!(half > 0)) return false;
    half += kUnit * (20 * Size(row) * radius_ + 4 * std::fabs(center) + 8 * half) + shape_.error * Size(row);
    for (double scale = (1 - 0x1p-18) / half;; scale *= 1 - 0x1p-10) {
      *made = Row::Rounded(scale * row, -scale * center);
      const double slack = made->Slack(radius_) + shape_.error * Size(made->row);
      if (!(slack < kMostSlack)) return false;
      double most = 0;
      for (const Vec3& point : shape_.points) most = std::max(most, std::fabs(made->At(point)));
      if (most + slack <= 1) return true;
    }
  }

  const PieceShape& shape_;
  const double radius_;
};

// How x or y of a piece depends on its parameter: within `off` of slope·s + middle.
struct Along {
  double slope = 0, middle = 0, off = 0;
};

Along MeasureAlong(const PieceShape& shape, const Row& row, bool along_u, double uneven) {
  const int p = shape.degree_u, q = shape.degree_v, degree = along_u ? p : q, lines = along_u ? q : p;
  const auto at = [&](int i, int line) {
    return row.At(
        shape.points[static_cast<std::size_t>(along_u ? i : line) * (q + 1) + (along_u ? line : i)]);
  };
  double low = 0, high = 0;
  for (int line = 0; line <= lines; ++line) low += at(0, line), high += at(degree, line);
  Along result{0.5 * (high - low) / (lines + 1), 0.5 * (high + low) / (lines + 1), 0};
  for (int i = 0; i <= degree; ++i)
    for (int line = 0; line <= lines; ++line)
      result.off = std::max(result.off,
                            std::fabs(at(i, line) - result.middle - result.slope * (2.0 * i / degree - 1)));
  result.off += std::fabs(result.slope) * uneven;
  return result;
}

void FillOpen(RayBlock* block, int lane) {
  for (int r = 0; r < 3; ++r) {
    for (int axis = 0; axis < 3; ++axis) block->row[r][axis][lane] = 0;
    block->offset[r][lane] = 0;
  }
  block->h[lane] = 1e30f;
  block->least_dz[lane] = 1;
  block->inner_x[lane] = block->inner_y[lane] = -1;
  block->line_a[lane] = block->line_b[lane] = block->line_c[lane] = 0;
  block->line_w[lane] = 1e30f;
  block->line_dz[lane] = 0;
}

void FillLine(const PieceShape& shape, const Frame& frame, double radius, RayBlock* block, int lane) {
  const TrimLine& line = shape.line;
  block->line_a[lane] = block->line_b[lane] = 0;
  block->line_c[lane] = static_cast<float>(line.c);
  block->line_w[lane] = line.w < INFINITY ? static_cast<float>(line.w) : 1e30f;
  if (!(line.w < INFINITY) || (line.a == 0 && line.b == 0)) return;
  const Along x = MeasureAlong(shape, frame.x, true, shape.uneven_s),
              y = MeasureAlong(shape, frame.y, false, shape.uneven_t);
  if (!(x.slope > 0.25 && y.slope > 0.25)) {
    block->line_w[lane] = 1e30f;
    return;
  }
  const double a = line.a / x.slope, b = line.b / y.slope;
  const double c = line.c - a * x.middle - b * y.middle;
  block->line_a[lane] = static_cast<float>(a);
  block->line_b[lane] = static_cast<float>(b);
  block->line_c[lane] = static_cast<float>(c);
  // What x and y are off, by shape, slack and error; and the rounding of the coefficients and of the value.
  const double off_x = x.off + frame.x.Slack(radius) + shape.error * Size(frame.x.row);
  const double off_y = y.off + frame.y.Slack(radius) + shape.error * Size(frame.y.row);
  const double w = line.w + std::fabs(a) * off_x + std::fabs(b) * off_y +
                   8 * kUnit * (std::fabs(a) + std::fabs(b) + std::fabs(c));
  block->line_w[lane] = RoundedUp(w * (1 + 0x1p-20));
}

void FillLane(const PieceShape& shape, RayBlock* block, int lane) {
  const double radius = block->radius;
  Frame frame(shape, radius);
  if (!(radius >= kLeastRadius && radius <= kMostRadius) || !frame.Make()) return FillOpen(block, lane);
  const Row* const rows[3] = {&frame.x, &frame.y, &frame.z};
  for (int r = 0; r < 3; ++r) {
    block->row[r][0][lane] = static_cast<float>(rows[r]->row.x);
    block->row[r][1][lane] = static_cast<float>(rows[r]->row.y);
    block->row[r][2][lane] = static_cast<float>(rows[r]->row.z);
    block->offset[r][lane] = static_cast<float>(rows[r]->offset);
  }
  block->h[lane] = RoundedUp(frame.h);
  block->least_dz[lane] = RoundedUp(frame.least_dz);
  block->line_dz[lane] = shape.steep_only ? RoundedUp(kSteep * Length(frame.z.row)) : 0;
  block->inner_x[lane] = RoundedDown(frame.Inner(frame.x, true));
  block->inner_y[lane] = RoundedDown(frame.Inner(frame.y, false));
  FillLine(shape, frame, radius, block, lane);
}

}  // namespace

class BlockTree::Builder {
 public:
  Builder(std::span<const Box3> boxes, BlockTree* made)
      : set_(boxes), boxes_(boxes), tree_(BuildTopDown(set_)), made_(*made) {}

  // Makes the nodes and lists the pieces of each block. Returns false if the tree is too deep.
  bool MakeNodes() {
    CountPieces();
    const SlabBox& bounds = set_.bounds();
    made_.center_ = 0.5 * (bounds.low() + bounds.high());
    const Vec3 half = 0.5 * (bounds.high() - bounds.low());
    made_.size_ = std::max({half.x, half.y, half.z});
    // A node waits with the children that it takes, and its depth.
    struct Task {
      std::uint32_t node, root;
      int depth;
    };
    std::vector<Task> tasks{{0, tree_.root, 1}};
    made_.nodes_.emplace_back();
    while (!tasks.empty()) {
      const Task task = tasks.back();
      tasks.pop_back();
      if (task.depth > kDeepestBlocks) return false;
      std::uint32_t members[kBlockLanes] = {task.root};
      int count = 1;
      Divide(members, &count);
      for (int lane = 0; lane < kBlockLanes; ++lane) {
        if (lane >= count) {
          SetBox(task.node, lane, nullptr);
          continue;
        }
        SetBox(task.node, lane, &BoxOf(members[lane]));
        if (CountOf(members[lane]) <= kBlockLanes) {
          made_.nodes_[task.node].child[lane] = kBlockBit | MakeBlock(members[lane]);
        } else {
          const auto child = static_cast<std::uint32_t>(made_.nodes_.size());
          made_.nodes_[task.node].child[lane] = child;
          made_.nodes_.emplace_back();
          tasks.push_back({child, members[lane], task.depth + 1});
        }
      }
    }
    return true;
  }

 private:
  bool IsPiece(std::uint32_t member) const { return (member & BvhTree::kObject) != 0; }
  std::uint32_t CountOf(std::uint32_t member) const { return IsPiece(member) ? 1 : counts_[member]; }
  const SlabBox& BoxOf(std::uint32_t member) const {
    return IsPiece(member) ? set_[member & ~BvhTree::kObject] : tree_.nodes[member].box;
  }

  void CountPieces() {
    counts_.assign(tree_.nodes.size(), 0);
    std::vector<std::uint32_t> order;
    if (!IsPiece(tree_.root)) order.push_back(tree_.root);
    for (std::size_t i = 0; i < order.size(); ++i)
      for (const std::uint32_t child : {tree_.nodes[order[i]].left, tree_.nodes[order[i]].right})
        if (!IsPiece(child)) order.push_back(child);
    for (std::size_t i = order.size(); i-- > 0;)
      counts_[order[i]] = CountOf(tree_.nodes[order[i]].left) + CountOf(tree_.nodes[order[i]].right);
  }

  // Replaces the largest member by its children, until there are eight, or only blocks.
  void Divide(std::uint32_t* members, int* count) const {
    while (*count < kBlockLanes) {
      int largest = -1;
      double surface = -1;
      for (int i = 0; i < *count; ++i) {
        if (CountOf(members[i]) <= kBlockLanes || HalfSurface(BoxOf(members[i])) <= surface) continue;
        largest = i;
        surface = HalfSurface(BoxOf(members[i]));
      }
      if (largest < 0) return;
      const BvhTree::Node& node = tree_.nodes[members[largest]];
      members[(*count)++] = node.right;
      members[largest] = node.left;
    }
  }

  void SetBox(std::uint32_t node, int lane, const SlabBox* box) {
    RayNode& made = made_.nodes_[node];
    const double center[3] = {made_.center_.x, made_.center_.y, made_.center_.z};
    const double margin = kBoxMargin * made_.size_;
    for (int axis = 0; axis < 3; ++axis) {
      made.side[0][axis][lane] = box ? RoundedDown(box->side[0][axis] - center[axis] - margin) : 1e37f;
      made.side[1][axis][lane] = box ? RoundedUp(box->side[1][axis] - center[axis] + margin) : -1e37f;
    }
    if (!box) made.child[lane] = kBlockBit;
  }

  std::uint32_t MakeBlock(std::uint32_t root) {
    made_.blocks_.emplace_back();
    RayBlock& block = made_.blocks_.back();
    std::vector<std::uint32_t> waiting{root};
    while (!waiting.empty()) {
      const std::uint32_t member = waiting.back();
      waiting.pop_back();
      if (IsPiece(member)) {
        block.piece[block.count++] = member & ~BvhTree::kObject;
      } else {
        waiting.push_back(tree_.nodes[member].right);
        waiting.push_back(tree_.nodes[member].left);
      }
    }
    // The sphere around the common box.
    Box3 box;
    for (std::uint32_t i = 0; i < block.count; ++i) {
      box.Add(boxes_[block.piece[i]].low);
      box.Add(boxes_[block.piece[i]].high);
    }
    const Vec3 center = box.center();
    block.center[0] = center.x;
    block.center[1] = center.y;
    block.center[2] = center.z;
    block.radius = 0.5 * box.diagonal() * (1 + 0x1p-20);
    return static_cast<std::uint32_t>(made_.blocks_.size() - 1);
  }

  BoxSet set_;
  std::span<const Box3> boxes_;
  BvhTree tree_;
  BlockTree& made_;
  std::vector<std::uint32_t> counts_;
};

std::optional<BlockTree> BlockTree::Build(std::span<const Box3> boxes, const MakeShape& make) {
  BlockTree tree;
  if (boxes.empty()) return tree;
  Builder builder(boxes, &tree);
  if (!builder.MakeNodes()) return std::nullopt;
  ParallelForBlocks(0, tree.blocks_.size(), 64, [&](std::size_t first, std::size_t last) {
    PieceShape shape;
    for (std::size_t i = first; i < last; ++i) {
      RayBlock& block = tree.blocks_[i];
      const Vec3 center{block.center[0], block.center[1], block.center[2]};
      for (int lane = 0; lane < kBlockLanes; ++lane) {
        if (lane >= static_cast<int>(block.count)) {
          FillOpen(&block, lane);
          continue;
        }
        make(block.piece[lane], center, &shape);
        FillLane(shape, &block, lane);
      }
    }
  });
  return tree;
}

RayBlocks BlockTree::blocks() const {
  return {nodes_.data(),
          blocks_.data(),
          static_cast<std::uint32_t>(nodes_.size()),
          {center_.x, center_.y, center_.z}};
}

bool BlockTree::Reaches(Vec3 start) const {
  const Vec3 off = start - center_;
  return std::fabs(off.x) <= kReach * size_ && std::fabs(off.y) <= kReach * size_ &&
         std::fabs(off.z) <= kReach * size_;
}

}  // namespace facetless
