// Views traced with solvers by name, judged by the certified samples of the same camera: every solver, every structure,
// starts, threads, refinement, and errors.
#include "render/solve/solver_trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/accel/structures.h"
#include "render/solve/solver.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::Frustum;
using testing::LooseBox;
using testing::ModelOf;
using testing::Rectangle;
using testing::Sphere;
using testing::Torus;

constexpr int kSize = 48;

// The solvers of the program, without that of the test below.
std::vector<const SolverInfo*> ProgramsSolvers() {
  std::vector<const SolverInfo*> solvers = Solvers();
  std::erase_if(solvers, [](const SolverInfo* info) { return info->name == "test-plane"; });
  return solvers;
}

// Whether a method minimises instead of solving equations: it is less exact, and loses more.
bool IsDescent(const SolverInfo& info) {
  return info.name == "gradient" || info.name == "steepest-descent";
}

Model Shapes() {
  return ModelOf({Sphere({0, 0, 0}, 10), Torus({0, 0, 0}, 20, 4), Frustum({25, 25, -5}, 6, 3, 12),
                  Rectangle({-30, -30, -12}, {60, 0, 0}, {0, 60, 0})});
}

Camera View(const Model& model, const char* name, Projection projection) {
  const Result<Camera> camera = NamedView(name, model.bounds, projection, kSize, kSize);
  EXPECT_TRUE(camera) << camera.error().message;
  return camera.value();
}

SampleBuffer Certified(const Scene& scene, const Camera& camera) {
  DirectOptions options;
  options.accuracy.precision = Precision::kCertified;
  options.uv = true;
  Result<DirectResult> traced = TraceDirect(scene, camera, options);
  EXPECT_TRUE(traced) << traced.error().message;
  return std::move(traced.value().samples);
}

SolverTrace Traced(const Scene& scene, const Camera& camera, const SolverInfo& info,
                   const SolverOptions& options = {}, const SolverTraceRequest& request = {}) {
  Result<SolverTrace> traced = TraceWithSolver(scene, camera, info, options, request);
  if (!traced) {
    ADD_FAILURE() << info.name << ": " << traced.error().message;
    return {};
  }
  return std::move(traced).value();
}

struct Differences {
  std::uint64_t hits = 0, lost = 0, invented = 0, apart = 0;
  double depth_px = 0, normal = 0;  // largest, of hits on the same surface
};

// Hits that differ by more than this many pixels belong to other roots.
constexpr double kOtherRoot = 1e-3;

Differences Compare(const SampleBuffer& exact, const SampleBuffer& samples, const CameraFrame& frame) {
  Differences d;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (exact.certificate[i] != Certificate::kCertified) continue;
    const bool there = exact.face[i] != kNoIndex, shown = samples.face[i] != kNoIndex;
    d.hits += there;
    if (!there) d.invented += shown;
    if (!there) continue;
    if (!shown) {
      ++d.lost;
      continue;
    }
    const Vec3 n{exact.normal[i][0], exact.normal[i][1], exact.normal[i][2]},
        m{samples.normal[i][0], samples.normal[i][1], samples.normal[i][2]};
    const double depth =
        std::fabs(samples.depth[i] - exact.depth[i]) * std::fabs(Dot(n, frame.forward)) /
        (frame.pixel_x * (frame.projection == Projection::kPerspective ? exact.depth[i] : 1));
    if (depth > kOtherRoot || exact.face[i] != samples.face[i]) {
      ++d.apart;
      continue;
    }
    d.depth_px = std::max(d.depth_px, depth);
    d.normal = std::max(d.normal, Length(n - m));
  }
  return d;
}

TEST(SolverTrace, EverySolverShowsTheShapes) {
  const Model model = Shapes();
  const Scene scene(model);
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const Camera camera = View(model, "iso", projection);
    const SampleBuffer exact = Certified(scene, camera);
    for (const SolverInfo* info : ProgramsSolvers())
      for (const SolverStarts starts :
           {SolverStarts::kPieces, SolverStarts::kMap, SolverStarts::kPublishedMap}) {
        if (starts != SolverStarts::kPieces && !info->takes_map) continue;
        SCOPED_TRACE(info->name + ", " + kSolverStartsNames[static_cast<std::size_t>(starts)]);
        const SolverTrace traced = Traced(scene, camera, *info, {.starts = starts}, {.uv = true});
        ASSERT_EQ(traced.samples.size(), exact.size());
        const Differences d = Compare(exact, traced.samples, traced.frame);
        EXPECT_GT(d.hits, 500u);
        // Where a method loses roots, it loses few of them; a map has none, or another surface's, along outlines.
        const bool map = starts != SolverStarts::kPieces;
        EXPECT_LE(d.lost + d.apart, d.hits / (map ? 4 : IsDescent(*info) ? 8 : 20));
        EXPECT_LE(d.invented, d.hits / 50);
        EXPECT_LE(d.depth_px, 8 * info->tolerance_px);
        EXPECT_LE(d.normal, IsDescent(*info) ? 1e-2 : 1e-3);
        EXPECT_EQ(traced.stats.hits + static_cast<std::uint64_t>(std::count(
                                          traced.samples.face.begin(), traced.samples.face.end(), kNoIndex)),
                  exact.size());
        EXPECT_GT(traced.stats.counters.solves, d.hits / 2);
        EXPECT_GT(traced.stats.counters.iterations, 0u);
        EXPECT_EQ(traced.start_face.size(), map ? exact.size() : 0u);
        EXPECT_EQ(traced.stats.structure, map ? "" : kUsualSolverStructure);
        EXPECT_GT(traced.stats.bytes, 0u);
        for (const Certificate certificate : traced.samples.certificate)
          ASSERT_NE(certificate, Certificate::kCertified) << "a solver proves nothing";
      }
  }
}

TEST(SolverTrace, ParametersBelongToTheHit) {
  const Model model = Shapes();
  const Scene scene(model);
  const Camera camera = View(model, "front", Projection::kOrthographic);
  const SampleBuffer exact = Certified(scene, camera);
  const SolverTrace traced = Traced(scene, camera, *FindSolver("martin"), {}, {.uv = true});
  std::uint64_t same = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (exact.face[i] == kNoIndex || traced.samples.face[i] != exact.face[i]) continue;
    ++same;
    EXPECT_NEAR(traced.samples.uv[i][0], exact.uv[i][0], 1e-5);
    EXPECT_NEAR(traced.samples.uv[i][1], exact.uv[i][1], 1e-5);
  }
  EXPECT_GT(same, 300u);
}

TEST(SolverTrace, TrimmedFacesAreTrimmed) {
  const Model model = LooseBox({10, 20, 30}, 1e-9, 5);
  const Scene scene(model);
  const Camera camera = View(model, "iso", Projection::kOrthographic);
  const SampleBuffer exact = Certified(scene, camera);
  for (const SolverInfo* info : ProgramsSolvers()) {
    SCOPED_TRACE(info->name);
    const SolverTrace traced = Traced(scene, camera, *info, {.starts = SolverStarts::kPieces});
    const Differences d = Compare(exact, traced.samples, traced.frame);
    EXPECT_GT(d.hits, 500u);
    // A descent that loses the front shows the back.
    EXPECT_LE(d.lost + d.apart, IsDescent(*info) ? d.hits / 8 : 0);
    EXPECT_EQ(d.invented, 0u);
    EXPECT_GT(traced.stats.trim_tests, d.hits / 2);
  }
}

TEST(SolverTrace, MirroredPlacementsKeepTheirOutside) {
  Model model = ModelOf({Sphere({3, 0, 0}, 10)});
  Placement mirror;
  mirror.m[0][0] = -1;
  testing::Place(&model, mirror);
  const Scene scene(model);
  const Camera camera = View(model, "iso", Projection::kOrthographic);
  const SampleBuffer exact = Certified(scene, camera);
  const SolverTrace traced = Traced(scene, camera, *FindSolver("martin"));
  EXPECT_LE(Compare(exact, traced.samples, traced.frame).normal, 1e-3);
}

TEST(SolverTrace, ThreadsAndStructuresDoNotMatter) {
  const Model model = Shapes();
  const Scene scene(model);
  const Camera camera = View(model, "iso", Projection::kPerspective);
  for (const SolverInfo* info : ProgramsSolvers()) {
    const SolverTrace one = Traced(scene, camera, *info, {}, {.execution = {.threads = 1}}),
                      four = Traced(scene, camera, *info, {}, {.execution = {.threads = 4}});
    EXPECT_TRUE(one.samples.depth == four.samples.depth && one.samples.face == four.samples.face)
        << info->name;
  }
  const SolverInfo& clipping = *FindSolver("robust-clipping");
  const SolverTrace usual = Traced(scene, camera, clipping);
  for (const StructureName& structure : StructureNames()) {
    const SolverTrace other = Traced(scene, camera, clipping, {.structure = std::string(structure.name)});
    EXPECT_TRUE(usual.samples.face == other.samples.face) << structure.name;
  }
}

TEST(SolverTrace, LeavesFacesOut) {
  const Model model = Shapes();
  const Scene scene(model);
  const Camera camera = View(model, "top", Projection::kOrthographic);
  std::vector<bool> out(model.PlacedFaceCount());
  out[0] = true;
  const SolverTrace traced = Traced(scene, camera, *FindSolver("martin"), {}, {.leave_out = &out});
  EXPECT_EQ(std::count(traced.samples.face.begin(), traced.samples.face.end(), 0u), 0);
  EXPECT_GT(std::count(traced.samples.face.begin(), traced.samples.face.end(), 3u), 0);
}

class Left final : public PixelPicker {
 public:
  void Pick(const SampleBuffer& centres, const CameraFrame&, PixelSet* set) override {
    for (int row = 0; row < centres.height; ++row)
      for (int column = 0; column < centres.width / 2; ++column) set->Add(column, row);
  }
};

TEST(SolverTrace, RefinedPixelsAreThoseOfTheFinerView) {
  const Model model = Shapes();
  const Scene scene(model);
  const Camera camera = View(model, "iso", Projection::kOrthographic);
  const SolverInfo& info = *FindSolver("robust-clipping");
  Left left;
  const RefineRequest refine{{3, 2}, &left, true};
  const SolverTrace traced = Traced(scene, camera, info, {}, {.refine = &refine});
  ASSERT_TRUE(traced.refinement);
  const Refinement& refined = *traced.refinement;
  const SolverTrace all = Traced(scene, camera.Supersampled(3, 2), info);
  ASSERT_EQ(refined.pixels.size(), static_cast<std::size_t>(kSize) * kSize / 2);
  EXPECT_EQ(refined.samples.uv.size(), refined.samples.size());
  for (std::size_t k = 0; k < refined.samples.size(); ++k) {
    const SamplePlace at =
        PlaceOfSample(refined.pixels.pixels()[k / 6], kSize, refine.grid, static_cast<int>(k % 6));
    const std::size_t i =
        static_cast<std::size_t>(at.row) * all.samples.width + static_cast<std::size_t>(at.column);
    ASSERT_EQ(refined.samples.face[k], all.samples.face[i]);
    ASSERT_EQ(refined.samples.depth[k], all.samples.depth[i]);
  }
}

TEST(SolverTrace, SaysWhatItCannotDo) {
  const Model model = Shapes();
  const Scene scene(model);
  const Camera camera = View(model, "iso", Projection::kOrthographic);
  const auto error = [&](const char* name, const SolverOptions& options) {
    const Result<SolverTrace> traced = TraceWithSolver(scene, camera, *FindSolver(name), options, {});
    EXPECT_FALSE(traced);
    return traced ? Error{} : traced.error();
  };
  EXPECT_EQ(error("martin", {.starts = SolverStarts::kMap}).code, ErrorCode::kBadUsage);
  EXPECT_EQ(error("martin", {.structure = "tree"}).code, ErrorCode::kBadUsage);
  EXPECT_EQ(error("martin", {.max_bytes = 1000}).code, ErrorCode::kLimitExceeded);
  const std::atomic<bool> stop = true;
  const Result<SolverTrace> stopped =
      TraceWithSolver(scene, camera, *FindSolver("martin"), {}, {.execution = {.cancel = &stop}});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

// A solver that finds the roots of planes of degree 1×1 only: what a new method needs is in this block.
class PlaneSolver final : public Solver {
 public:
  explicit PlaneSolver(const SolverScene& scene) : scene_(scene) {
    for (std::uint32_t i = 0; i < scene.patches().size(); ++i) {
      SolverPiece piece;
      piece.surface = i;
      const SolverPatch& patch = scene.patches()[i];
      for (int k = 0; k < patch.points(); ++k) {
        const Vec4& p = scene.space(patch)[k];
        piece.box.Add({p.x, p.y, p.z});
      }
      pieces_.push_back(piece);
    }
  }
  std::span<const SolverPiece> pieces() const override { return pieces_; }
  std::uint64_t bytes() const override { return pieces_.size() * sizeof(SolverPiece); }
  void Solve(const SolverRay& ray, const SolverStart& start, SolverState& state) const override {
    ++state.counters.solves;
    const ViewProjection::Point* p = scene_.screen(scene_.patches()[start.surface]);
    const double ux = p[2].x - p[0].x, uy = p[2].y - p[0].y, vx = p[1].x - p[0].x, vy = p[1].y - p[0].y;
    const double x = ray.x - p[0].x, y = ray.y - p[0].y, det = ux * vy - uy * vx;
    const double u = (x * vy - y * vx) / det, v = (ux * y - uy * x) / det;
    if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1)) return state.End(SolverStop::kNoRoot);
    state.AddRoot({start.surface, u, v});
    state.End(SolverStop::kRoot);
  }

 private:
  const SolverScene& scene_;
  std::vector<SolverPiece> pieces_;
};

const RegisterSolver kPlane({.name = "test-plane",
                             .title = "Planes",
                             .source = "this test",
                             .does = "It intersects parallelograms.",
                             .does_not = "It takes no other surface.",
                             .max_degree = 1,
                             .rational = false,
                             .make = [](const SolverScene& scene, std::uint64_t, const Execution&) {
                               return Result<std::unique_ptr<const Solver>>(
                                   std::make_unique<PlaneSolver>(scene));
                             }});

TEST(SolverTrace, ANewSolverNeedsOneRow) {
  const Model planes = ModelOf({Rectangle({-30, -30, -12}, {60, 0, 0}, {0, 60, 0})});
  const Scene scene(planes);
  const Camera camera = View(planes, "iso", Projection::kOrthographic);
  const SolverTrace traced = Traced(scene, camera, *FindSolver("test-plane"));
  const Differences d = Compare(Certified(scene, camera), traced.samples, traced.frame);
  EXPECT_EQ(d.lost + d.apart + d.invented, 0u);
  EXPECT_GT(d.hits, 500u);
  // A surface that it does not claim is an error that names methods that do.
  const Model ball = ModelOf({Sphere({0, 0, 0}, 10)});
  const Scene round(ball);
  const Result<SolverTrace> refused =
      TraceWithSolver(round, View(ball, "iso", Projection::kOrthographic), *FindSolver("test-plane"), {}, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadUsage);
  EXPECT_NE(refused.error().message.find("use certified, newton-cramer"), std::string::npos)
      << refused.error().message;
}

}  // namespace
}  // namespace facetless
