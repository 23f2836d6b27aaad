// Faces that meet only to within a gap must let no light through, seen from all sides. No ray may cross a
// solid an odd number of times.
#include "render/trace/seams.h"

#include <gtest/gtest.h>

#include "render/trace/direct.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

// A camera that sees the whole of `bounds` from the direction `toward_eye`.
Camera From(Vec3 toward_eye, const Box3& bounds, Projection projection, int size) {
  Camera camera;
  camera.target = bounds.center();
  camera.eye = camera.target + 2 * bounds.diagonal() * Normalized(toward_eye);
  camera.up = toward_eye.x == 0 && toward_eye.y == 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  camera.projection = projection;
  camera.height = 1.1 * bounds.diagonal();
  camera.fov_y_deg = 35;
  camera.width_px = camera.height_px = size;
  return camera;
}

// Returns the directions of a cube's faces, edges and corners.
std::vector<Vec3> Directions() {
  std::vector<Vec3> directions;
  for (double x = -1; x <= 1; ++x)
    for (double y = -1; y <= 1; ++y)
      for (double z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) directions.push_back({x, y, z});
  return directions;
}

DirectStats AuditOf(const Model& model, const Camera& camera) {
  DirectOptions options;
  options.audit = true;
  return TraceDirect(Scene(model), camera, options).value().stats;
}

std::size_t SeamsIn(const Model& model, const Camera& camera) {
  const CameraFrame frame = MakeFrame(camera, model.Diagonal()).value();
  SplitBudget budget;
  budget.bytes_left = std::int64_t{1} << 40;
  return FindSeamSamples(model, SeamTable(model), camera, frame, &budget).size();
}

TEST(Seams, AGapThatIsWideInThePictureIsSeenAsWhatItIs) {
  // The edges lie off their faces by some hundredths of their length. From nearby, the number of samples in
  // the gap is as large as that of the picture.
  const Model model = testing::LooseBox({10, 8, 6}, 0.25, 1);
  EXPECT_GT(SeamsIn(model, From({1, 2, 3}, model.bounds, Projection::kOrthographic, 48)), 0u);
  EXPECT_EQ(SeamsIn(model, From({1, 2, 3}, model.bounds, Projection::kOrthographic, 4096)), 0u);
}

TEST(Seams, ALooseBoxLetsNoLightThroughFromAnySide) {
  // The gaps are several pixels wide, and from most sides some faces are seen edge-on, so that they have no
  // root that could be kept.
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Model model = testing::LooseBox({10, 8, 6}, 0.25, seed);
    ASSERT_TRUE(Validate(model).ok());
    for (const Vec3 direction : Directions()) {
      for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
        const Camera camera = From(direction, model.bounds, projection, 48);
        const DirectStats stats = AuditOf(model, camera);
        EXPECT_GT(stats.hits, 300u);
        EXPECT_EQ(stats.odd_rays, 0u)
            << "seed " << seed << " from " << direction.x << " " << direction.y << " " << direction.z;
        EXPECT_EQ(stats.reverse_mismatches, 0u)
            << "seed " << seed << " from " << direction.x << " " << direction.y << " " << direction.z;
        EXPECT_GT(SeamsIn(model, camera), 100u);
      }
    }
  }
}

TEST(Seams, CloseToAnEdgeAndToAVertexTheGapIsTheWholePicture) {
  const Model model = testing::LooseBox({10, 8, 6}, 1e-4, 5);
  for (const Vec3 direction : Directions()) {
    for (const Vec3 at : {Vec3{10, 8, 6}, Vec3{0, 8, 2}}) {
      Camera camera = From(direction, model.bounds, Projection::kOrthographic, 16);
      camera.eye = camera.eye + (at - camera.target);
      camera.target = at;
      camera.height = 6e-4;
      const DirectStats stats = AuditOf(model, camera);
      EXPECT_EQ(stats.odd_rays, 0u) << direction.x << " " << direction.y << " " << direction.z << " at "
                                    << at.x;
      EXPECT_EQ(stats.reverse_mismatches, 0u)
          << direction.x << " " << direction.y << " " << direction.z << " at " << at.x;
    }
  }
}

TEST(Seams, ABoxWithoutGapsHasNone) {
  const Model model = testing::LooseBox({10, 8, 6}, 0, 1);
  for (const Vec3 direction : Directions())
    EXPECT_EQ(SeamsIn(model, From(direction, model.bounds, Projection::kPerspective, 200)), 0u);
}

TEST(Seams, TheyAreThePixelsWithinReachOfAnEdge) {
  // Seen from above, there are four edges around the top, four around the bottom, and the vertical ones.
  const double gap = 0.05;
  const Model model = testing::LooseBox({10, 8, 6}, gap, 2);
  const Camera camera = From({0, 0, 1}, model.bounds, Projection::kOrthographic, 400);
  const CameraFrame frame = MakeFrame(camera, model.Diagonal()).value();
  SplitBudget budget;
  budget.bytes_left = std::int64_t{1} << 40;
  const std::vector<SeamSample> samples = FindSeamSamples(model, SeamTable(model), camera, frame, &budget);
  ASSERT_GT(samples.size(), 1000u);
  for (const SeamSample& sample : samples) {
    const Vec3 at = PixelRay(frame, sample.column + 0.5, sample.row + 0.5).origin;
    const double x = std::min(std::fabs(at.x), std::fabs(at.x - 10)),
                 y = std::min(std::fabs(at.y), std::fabs(at.y - 8));
    // The edge is at most a gap away from the box. A ray passes the edge within two gaps, or a corner within
    // the sum of two such distances.
    EXPECT_LE(std::min(x, y), 5 * gap) << sample.column << " " << sample.row;
    // The depth is that of the edge: at the top, at the bottom, or in between.
    const double height = camera.eye.z - sample.depth;
    EXPECT_GE(height, -gap);
    EXPECT_LE(height, 6 + gap);
  }
}

TEST(Seams, AnOddFaceBesideAnEdgeIsGivenACrossingOnTheEdge) {
  // The view is along y, at an edge that bulges out of a face seen edge-on. Rays under the bulge do not meet
  // the faces themselves.
  Model model = testing::LooseBox({10, 8, 6}, 0, 1);
  for (Vec4& p : model.edge_points)
    if (p.x == 5 && p.y == 0 && p.z == 6) p.z += 1;
  for (Vec4& p : model.edge_points)
    if (p.x == 5 && p.y == 8 && p.z == 6) p.z += 1;
  for (Coedge& coedge : model.coedges) coedge.gap_mm = 1;
  Camera camera = From({0, -1, 0}, model.bounds, Projection::kOrthographic, 100);
  camera.target = camera.target + Vec3{0, 0, 3};
  camera.eye = camera.eye + Vec3{0, 0, 3};
  camera.height = 14;
  const Result<DirectResult> picture = TraceDirect(Scene(model), camera, {});
  ASSERT_TRUE(picture.ok());
  // The pixel at x = 5, z = 6.2 is under the parabola, whose middle is half a millimetre higher.
  const PixelPoint pixel = Project(picture.value().frame, {5, 0, 6.2});
  const std::size_t k = std::size_t(pixel.y) * 100 + std::size_t(pixel.x);
  EXPECT_NEAR(picture.value().samples.depth[k], Project(picture.value().frame, {5, 0, 6.5}).depth, 1);
  EXPECT_EQ(AuditOf(model, camera).odd_rays, 0u);
}

}  // namespace
}  // namespace facetless
