// Ray blocks over random quadrilaterals, against brute force in double: whatever the blocks claim is so, on every
// instruction set with the same bits.
#include "render/rays/block_tree.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "render/kernels/dispatch.h"

namespace facetless {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double low, double high) { return low + (high - low) * (double(engine_() >> 11) * 0x1p-53); }
  Vec3 InCube(double half) { return {Uniform(-half, half), Uniform(-half, half), Uniform(-half, half)}; }
  Vec3 Direction() {
    for (;;) {
      const Vec3 v = InCube(1);
      if (Dot(v, v) > 0.01 && Dot(v, v) <= 1) return Normalized(v);
    }
  }

 private:
  std::mt19937_64 engine_;
};

// A parallelogram with a trim line: corner + s·a + t·b for s, t in [−1, 1].
struct Plate {
  Vec3 middle, a, b;
  TrimLine line = TrimLine::Whole();

  Box3 Bounds() const {
    Box3 box;
    for (const double s : {-1.0, 1.0})
      for (const double t : {-1.0, 1.0}) box.Add(middle + s * a + t * b);
    return box;
  }
  // Where the ray meets the plane: s, t and the distance.
  bool Meet(Vec3 origin, Vec3 d, double* s, double* t, double* distance) const {
    const Vec3 n = Cross(a, b);
    const double slope = Dot(n, d);
    if (slope == 0) return false;
    *distance = Dot(n, middle - origin) / slope;
    const Vec3 at = origin + *distance * d - middle;
    *s = Dot(Cross(at, b), n) / Dot(n, n);
    *t = Dot(Cross(a, at), n) / Dot(n, n);
    return true;
  }
};

struct Plates {
  std::vector<Plate> plates;
  std::vector<Box3> boxes;

  Plates(int count, double size, double scale, Vec3 shift, Random& random) {
    for (int i = 0; i < count; ++i) {
      Plate plate{shift + random.InCube(scale), {}, {}};
      plate.a = scale * size * random.Uniform(0.1, 1) * random.Direction();
      plate.b = scale * size * random.Uniform(0.1, 1) * Normalized(Cross(plate.a, random.Direction()));
      if (random.Uniform(0, 1) < 0.3) {
        const double angle = random.Uniform(0, 6.28);
        plate.line = {std::cos(angle), std::sin(angle), random.Uniform(-0.5, 0.5), random.Uniform(0, 0.1)};
      }
      plates.push_back(plate);
      const Box3 box = plate.Bounds();
      const double margin = 0x1p-40 * scale;
      boxes.push_back({box.low - Vec3{margin, margin, margin}, box.high + Vec3{margin, margin, margin}});
    }
  }
  std::optional<BlockTree> Build() const {
    return BlockTree::Build(boxes, [this](std::uint32_t id, Vec3 from, PieceShape* shape) {
      const Plate& plate = plates[id];
      const Vec3 c = plate.middle - from;
      *shape = {};
      shape->points = {c - plate.a - plate.b, c - plate.a + plate.b, c + plate.a - plate.b,
                       c + plate.a + plate.b};
      shape->line = plate.line;
    });
  }
};

BlockRay RayOf(Vec3 origin, Vec3 d, double length) {
  return {{origin.x, origin.y, origin.z}, {d.x, d.y, d.z}, length, 0};
}

// A visit of many plates in random directions, from among them.
RC_GTEST_PROP(BlockTree, ClaimsHoldForPlatesOfAnySize, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  const double scale = std::pow(10.0, *rc::gen::inRange(-6, 10));
  const double size = *rc::gen::element(0.02, 0.1, 0.5);
  const Vec3 shift = *rc::gen::arbitrary<bool>() ? Vec3{} : 1000 * scale * random.Direction();
  const Plates plates(*rc::gen::inRange(1, 120), size, scale, shift, random);
  const std::optional<BlockTree> tree = plates.Build();
  RC_ASSERT(tree.has_value());
  const auto visit = std::make_unique<BlockVisit>(), other = std::make_unique<BlockVisit>();
  for (int i = 0; i < 60; ++i) {
    const Vec3 origin = shift + random.InCube(1.5 * scale), d = random.Direction();
    if (!tree->Reaches(origin)) continue;
    const double length = i % 3 == 0 ? random.Uniform(0.01, 1) * scale : INFINITY;
    const BlockRay ray = RayOf(origin, d, length);
    kernel_scalar::VisitRayBlocks(tree->blocks(), ray, visit.get());
    // What is met for certain, and what may be: rounding in double is far below 1e-9 here.
    bool certain = false;
    std::vector<std::uint32_t> possible;
    for (std::uint32_t k = 0; k < plates.plates.size(); ++k) {
      const Plate& plate = plates.plates[k];
      double s, t, distance;
      if (!plate.Meet(origin, d, &s, &t, &distance)) continue;
      const double value = plate.line.a * s + plate.line.b * t + plate.line.c;
      const auto meets = [&](double slack, double more) {
        return std::fabs(s) <= 1 + slack && std::fabs(t) <= 1 + slack && distance > -slack * scale &&
               distance < length + slack * scale && value > plate.line.w * more - slack;
      };
      certain = certain || meets(-1e-9, 1);
      if (meets(-1e-9, -1)) possible.push_back(k);
    }
    if (visit->blocked) {
      // A plate with a line blocks only where the line says so.
      RC_ASSERT(certain || !possible.empty());
      bool any = false;
      for (const std::uint32_t k : possible) {
        double s, t, distance;
        plates.plates[k].Meet(origin, d, &s, &t, &distance);
        const TrimLine& line = plates.plates[k].line;
        any = any || line.a * s + line.b * t + line.c > line.w - 1e-9;
      }
      RC_ASSERT(any);
    } else {
      // All that may be met is open.
      for (const std::uint32_t k : possible) {
        bool open = false;
        for (int n = 0; n < visit->open_count; ++n)
          for (std::uint32_t lane = 0; lane < 8; ++lane)
            open = open || ((visit->open[n].lanes >> lane & 1) != 0 &&
                            tree->blocks().blocks[visit->open[n].block].piece[lane] == k);
        RC_ASSERT(open);
      }
    }
    // All instruction sets say the same.
    for (const bool every : {false, true}) {
      visit->every = other->every = every;
      kernel_scalar::VisitRayBlocks(tree->blocks(), ray, visit.get());
      for (const Kernels& kernels : AvailableKernels()) {
        kernels.visit_blocks(tree->blocks(), ray, other.get());
        RC_ASSERT(other->blocked == visit->blocked);
        RC_ASSERT(other->open_count == visit->open_count);
        for (int n = 0; n < visit->open_count; ++n) {
          RC_ASSERT(other->open[n].block == visit->open[n].block);
          RC_ASSERT(other->open[n].lanes == visit->open[n].lanes);
          if (every) RC_ASSERT(std::memcmp(other->near[n], visit->near[n], sizeof visit->near[n]) == 0);
        }
      }
    }
  }
}

// Most rays through a plate are decided without a solver.
TEST(BlockTree, FewRaysAreOpen) {
  Random random(3);
  const Plates plates(400, 0.2, 1, {}, random);
  const std::optional<BlockTree> tree = plates.Build();
  ASSERT_TRUE(tree.has_value());
  BlockVisit visit;
  int open = 0, blocked = 0;
  constexpr int kRays = 2000;
  for (int i = 0; i < kRays; ++i) {
    kernel_scalar::VisitRayBlocks(tree->blocks(), RayOf(random.InCube(1), random.Direction(), INFINITY),
                                  &visit);
    blocked += visit.blocked;
    open += !visit.blocked && visit.open_count > 0;
  }
  EXPECT_GT(blocked, kRays / 2);
  EXPECT_LT(open, kRays / 100);
}

}  // namespace
}  // namespace facetless
