// The audit accepts closed solids, notices open ones, and finds the same crossings in both directions.
#include "render/trace/audit.h"

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::ClosedSolid;
using testing::ModelOf;

DirectStats AuditOf(const Model& model, const char* view, Projection projection, int size) {
  DirectOptions options;
  options.audit = true;
  return TraceDirect(Scene(model), NamedView(view, model.bounds, projection, size, size).value(), options)
      .value()
      .stats;
}

TEST(Audit, AClosedSphereHasNoOddRayFromAnySide) {
  const Model model = ClosedSolid(ModelOf({testing::Sphere({1, 2, 3}, 5)}));
  for (const std::string& view : ViewNames()) {
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      const DirectStats stats = AuditOf(model, view.c_str(), projection, 200);
      EXPECT_EQ(stats.odd_rays, 0u) << view;
      EXPECT_EQ(stats.reverse_mismatches, 0u) << view;
    }
  }
}

TEST(Audit, AHoleMakesEveryRayThroughItOdd) {
  // A rectangle that is declared a closed solid: every ray that meets it crosses it once.
  const Model model = ClosedSolid(ModelOf({testing::Rectangle({0, 0, 0}, {4, 0, 0}, {0, 4, 1})}));
  const DirectStats stats = AuditOf(model, "iso", Projection::kOrthographic, 100);
  EXPECT_GT(stats.hits, 1000u);
  EXPECT_EQ(stats.odd_rays, stats.hits);
  EXPECT_EQ(stats.odd_samples.size(), stats.hits);
}

TEST(Audit, WithoutAClosedSolidThereIsNothingToCount) {
  const Model model = ModelOf({testing::Rectangle({0, 0, 0}, {4, 0, 0}, {0, 4, 1})});
  const DirectStats stats = AuditOf(model, "iso", Projection::kOrthographic, 100);
  EXPECT_FALSE(stats.odd_rays.has_value());
  EXPECT_EQ(stats.reverse_mismatches, 0u);
}

TEST(Audit, PlacementsAreSolidsOfTheirOwn) {
  // Two placements of one sphere overlap. Each is crossed twice, and rays through both cross four times.
  ModelBuilder builder(ClosedSolid(ModelOf({testing::Sphere({0, 0, 0}, 5)})));
  Instance other;
  other.placement.m[0][3] = 3;
  builder.AddInstance(other);
  builder.SetBounds({{-5, -5, -5}, {8, 5, 5}});
  const Model model = testing::Finished(std::move(builder));
  const DirectStats stats = AuditOf(model, "iso", Projection::kPerspective, 200);
  EXPECT_EQ(stats.odd_rays, 0u);
  EXPECT_EQ(stats.reverse_mismatches, 0u);
}

}  // namespace
}  // namespace facetless
