// Refined pixels against a view of all samples: the same surfaces, whatever the grid, the projection, the number of
// threads and the part of the picture that is refined.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/trace/direct.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::Frustum;
using testing::LooseBox;
using testing::ModelOf;
using testing::Rectangle;
using testing::Sphere;
using testing::Torus;

// Picks a share of the pixels, by a fixed pattern.
class Share final : public PixelPicker {
 public:
  explicit Share(unsigned one_in) : one_in_(one_in) {}
  void Pick(const SampleBuffer& centres, const CameraFrame&, PixelSet* set) override {
    std::mt19937 random(3);
    for (int row = 0; row < centres.height; ++row)
      for (int column = 0; column < centres.width; ++column)
        if (random() % one_in_ == 0) set->Add(column, row);
  }

 private:
  unsigned one_in_;
};

class Nothing final : public PixelPicker {
 public:
  void Pick(const SampleBuffer&, const CameraFrame&, PixelSet*) override {}
};

struct Compared {
  std::uint64_t samples = 0, other_face = 0;
  double depth = 0, normal = 0;  // largest differences where both show one face
};

Compared Compare(const Refinement& refinement, const SampleBuffer& all) {
  Compared compared;
  const int count = refinement.grid.count();
  for (std::size_t i = 0; i < refinement.samples.size(); ++i) {
    const SamplePlace at = PlaceOfSample(refinement.pixels.pixels()[i / static_cast<std::size_t>(count)],
                                         refinement.pixels.width(), refinement.grid,
                                         static_cast<int>(i % static_cast<std::size_t>(count)));
    const std::size_t j = static_cast<std::size_t>(at.row) * all.width + at.column;
    ++compared.samples;
    if (refinement.samples.face[i] != all.face[j]) {
      ++compared.other_face;
      continue;
    }
    if (all.face[j] == kNoIndex) continue;
    compared.depth = std::fmax(compared.depth, std::fabs(refinement.samples.depth[i] - all.depth[j]));
    for (int c = 0; c < 3; ++c)
      compared.normal =
          std::fmax(compared.normal, std::fabs(refinement.samples.normal[i][c] - all.normal[j][c]));
  }
  return compared;
}

std::vector<Model> Shapes() {
  std::vector<Model> models;
  models.push_back(ModelOf({Sphere({0, 0, 0}, 5), Torus({0, 0, 1}, 8, 0.7)}));
  models.push_back(ModelOf({Frustum({0, 0, 0}, 3, 0, 6), Rectangle({-4, -4, -1}, {8, 0, 0}, {0, 8, 2})}));
  models.push_back(LooseBox({4, 3, 2}, 0, 1));
  return models;
}

TEST(Refinement, ShowsWhatAViewOfAllSamplesShows) {
  const std::vector<Model> models = Shapes();
  int number = 0;
  for (const Model& model : models) {
    const Scene scene(model);
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      for (const SampleGrid grid : {SampleGrid{2, 2}, {3, 3}, {4, 2}, {1, 2}, {8, 8}, {7, 1}}) {
        const int width = 40 + 13 * (number % 5), height = 50 - 7 * (number % 4);
        ++number;
        const Camera camera = NamedView("iso", model.bounds, projection, width, height).value();
        Share share(1 + static_cast<unsigned>(number) % 3);
        const RefineRequest refine{grid, &share};
        DirectOptions options;
        options.refine = &refine;
        options.accuracy.precision = number % 4 == 0 ? Precision::kFast : Precision::kStandard;
        const Result<DirectResult> refined = TraceDirect(scene, camera, options);
        ASSERT_TRUE(refined.ok()) << refined.error().message;
        ASSERT_TRUE(refined.value().refinement);
        options.refine = nullptr;
        const Result<DirectResult> all = TraceDirect(scene, camera.Supersampled(grid.x, grid.y), options);
        ASSERT_TRUE(all.ok()) << all.error().message;
        const Compared compared = Compare(*refined.value().refinement, all.value().samples);
        EXPECT_GT(compared.samples, 0u);
        // A sample on an edge may fall to either side of it by rounding.
        EXPECT_LE(compared.other_face, 2u) << grid.x << "x" << grid.y << " of " << compared.samples;
        const bool fast = options.accuracy.precision == Precision::kFast;
        EXPECT_LT(compared.depth, fast ? 1e-3 : 1e-9);
        EXPECT_LT(compared.normal, fast ? 1e-2 : 1e-5);
      }
    }
  }
}

TEST(Refinement, LeavesTheCentresAsTheyAre) {
  for (const Model& model : Shapes()) {
    const Scene scene(model);
    const Camera camera = NamedView("iso", model.bounds, Projection::kPerspective, 90, 70).value();
    const Result<DirectResult> plain = TraceDirect(scene, camera, {});
    Share share(2);
    const RefineRequest refine{{2, 2}, &share};
    DirectOptions options;
    options.refine = &refine;
    const Result<DirectResult> refined = TraceDirect(scene, camera, options);
    ASSERT_TRUE(plain.ok() && refined.ok());
    EXPECT_EQ(plain.value().samples.depth, refined.value().samples.depth);
    EXPECT_EQ(plain.value().samples.normal, refined.value().samples.normal);
    EXPECT_EQ(plain.value().samples.certificate, refined.value().samples.certificate);
    EXPECT_EQ(plain.value().stats.unseen_faces, refined.value().stats.unseen_faces);
  }
}

TEST(Refinement, HasTheSameBytesForAnyNumberOfThreads) {
  for (const Model& model : Shapes()) {
    const Scene scene(model);
    const Camera camera = NamedView("iso", model.bounds, Projection::kOrthographic, 90, 70).value();
    Share share(2);
    const RefineRequest refine{{2, 2}, &share};
    DirectOptions options;
    options.refine = &refine;
    options.execution.threads = 1;
    const Result<DirectResult> one = TraceDirect(scene, camera, options);
    options.execution.threads = 5;
    const Result<DirectResult> five = TraceDirect(scene, camera, options);
    ASSERT_TRUE(one.ok() && five.ok());
    EXPECT_EQ(one.value().refinement->samples.depth, five.value().refinement->samples.depth);
    EXPECT_EQ(one.value().refinement->samples.face, five.value().refinement->samples.face);
    EXPECT_EQ(one.value().refinement->samples.normal, five.value().refinement->samples.normal);
  }
}

// Wires and slats of a tenth of a pixel, at every angle: each pixel through which one passes is refined, though no
// centre may show it.
TEST(Refinement, FindsWhatIsThinnerThanAPixel) {
  constexpr int kSize = 64;
  std::uint64_t all_shown = 0;
  for (int step = 0; step < 40; ++step) {
    const double angle = step * 0.08, c = std::cos(angle), s = std::sin(angle);
    const Vec3 along{100 * c, 100 * s, 0}, across{-0.05 * s, 0.05 * c, 0};
    const Model slat = ModelOf({Rectangle(-0.5 * along + Vec3{0.21, 0.32, 0}, along, across)});
    const Model wire = ModelOf({Torus({0, 0, 0}, 20 + 0.1 * step, 0.04)});
    for (const Model* model : {&slat, &wire}) {
      const Scene scene(*model);
      Camera camera;
      camera.eye = {0, 0, 10};
      camera.target = {0.013, 0.027, 0};
      camera.up = {0, 1, 0};
      camera.height = kSize;
      camera.width_px = camera.height_px = kSize;
      Nothing nothing;
      const RefineRequest refine{{4, 4}, &nothing};
      DirectOptions options;
      options.refine = &refine;
      const Result<DirectResult> refined = TraceDirect(scene, camera, options);
      ASSERT_TRUE(refined.ok()) << refined.error().message;
      options.refine = nullptr;
      const Result<DirectResult> all = TraceDirect(scene, camera.Supersampled(4, 4), options);
      ASSERT_TRUE(all.ok());
      std::uint64_t missed = 0, shown = 0;
      for (int row = 0; row < 4 * kSize; ++row) {
        for (int column = 0; column < 4 * kSize; ++column) {
          if (all.value().samples.face[static_cast<std::size_t>(row) * 4 * kSize + column] == kNoIndex)
            continue;
          ++shown;
          // Where a centre around shows the face, its contrast is the picker's to find.
          bool seen = false;
          for (int i = std::max(row / 4 - 1, 0); i <= std::min(row / 4 + 1, kSize - 1); ++i)
            for (int j = std::max(column / 4 - 1, 0); j <= std::min(column / 4 + 1, kSize - 1); ++j)
              seen |= refined.value().samples.face[static_cast<std::size_t>(i) * kSize + j] != kNoIndex;
          missed += !seen && !refined.value().refinement->pixels.Has(column / 4, row / 4);
        }
      }
      all_shown += shown;
      EXPECT_EQ(missed, 0u) << "angle " << angle << (model == &slat ? ", slat" : ", wire") << ", of "
                            << shown;
    }
  }
  EXPECT_GT(all_shown, 2000u);
}

TEST(Refinement, IsRefusedWithSections) {
  const Model model = ModelOf({Sphere({0, 0, 0}, 5)});
  const Scene scene(model);
  Nothing nothing;
  const RefineRequest refine{{2, 2}, &nothing};
  DirectOptions options;
  options.refine = &refine;
  options.sections.push_back({{0, 0, 0}, {0, 0, 1}});
  const Camera camera = NamedView("iso", model.bounds, Projection::kOrthographic, 32, 32).value();
  EXPECT_EQ(TraceDirect(scene, camera, options).error().code, ErrorCode::kBadUsage);
}

}  // namespace
}  // namespace facetless
