// The numbers of a surface: weights, degrees, control points, knots.
#include <cmath>

#include "tests/verify/extremes/catalogue.h"
#include "tests/verify/extremes/models.h"
#include "tests/verify/oracle/random_models.h"

namespace facetless::extremes {

using testing::ModelOf;
using testing::PatchGrid;

namespace {

std::vector<Camera> Around(const Model& model) {
  return NamedViews(model, {"iso", "top", "iso-below"}, 64);
}

void AddWeights(Rows& rows) {
  // Where almost all of the weight is in a small part of the surface, that part is a tiny range of the
  // parameters. The net's rounding there is that of its largest weight, and leaves roots without a proof.
  // They must be in doubt, with a reason.
  constexpr std::uint8_t kAny =
      kDoubtSilhouette | kDoubtPole | kDoubtTwoRoots | kDoubtTrim | kDoubtUnresolved;
  const auto row = [&](const char* input, double certified, double bound_mm, std::uint8_t doubts,
                       const std::function<double(int, int)>& weight) {
    rows.push_back({.group = "weights",
                    .input = input,
                    .expected = doubts ? "right, or in doubt" : "right",
                    .model = [=] { return ModelOf({BumpyPatch(3, 3, 10, weight)}); },
                    .cameras =
                        [](const Model& model) {
                          return NamedViews(model, {"iso", "top"}, 32);
                        },
                    .certified = {certified, certified, certified},
                    .doubts = doubts,
                    .depth_bound_mm = bound_mm});
  };
  row("bicubic, weights 1 and 1e12 in turn", 0.8, 1e-3, kAny,
      [](int k, int l) { return (k + l) % 2 ? 1e12 : 1; });
  row("bicubic, weights from 1e-6 to 1e6 along u", 0.4, 0.1, kAny,
      [](int k, int) { return std::pow(10.0, 4 * k - 6); });
  row("bicubic, one inner weight of 1e12", 0.4, 0.1, kAny,
      [](int k, int l) { return k == 1 && l == 2 ? 1e12 : 1; });
  row("bicubic, one corner's weight of 1e-12", 0.9, 1e-3, kAny,
      [](int k, int l) { return k + l == 0 ? 1e-12 : 1; });
  row("bicubic, one side's weights of 1e-12", 0.7, 0.1, kAny, [](int k, int) { return k == 0 ? 1e-12 : 1; });
  row("bicubic, weights 1 and 1e20 in turn", 0, 1e-3, kAny,
      [](int k, int l) { return (k + l) % 2 ? 1e20 : 1; });
  row("bicubic, one inner weight of 1e160", 0, 1e-3, kAny,
      [](int k, int l) { return k == 1 && l == 2 ? 1e160 : 1; });
  row("bicubic, inner weights of 1e-300", 1, 1e-6, 0,
      [](int k, int l) { return k % 3 && l % 3 ? 1e-300 : 1; });
  row("bicubic, all weights 1e-200", 1, 1e-6, 0, [](int, int) { return 1e-200; });
  row("bicubic, all weights 1e200", 1, 1e-6, 0, [](int, int) { return 1e200; });
  for (const double bad : {0.0, -1e-12, -1.0}) {
    char input[80];
    std::snprintf(input, sizeof input, "one inner weight of %g", bad);
    rows.push_back({.group = "weights",
                    .input = input,
                    .expected = "a clear error",
                    .model =
                        [=] {
                          Model model = ModelOf({BumpyPatch(3, 3, 10)});
                          model.surfaces[0].rational = true;
                          model.control_points[5].w = bad;
                          return model;
                        },
                    .cameras = Around,
                    .error = ErrorCode::kFormatBroken});
  }
}

void AddDegrees(Rows& rows) {
  rows.push_back({.group = "degree",
                  .input = "degree 25 × 25, bumps",
                  .expected = "right",
                  .model = [] { return ModelOf({BumpyPatch(25, 25, 10)}); },
                  .cameras = Around,
                  .depth_bound_mm = 1e-4,
                  .judged = 6});
  rows.push_back({.group = "degree",
                  .input = "degree 25 × 1, weights 1 to 1e6",
                  .expected = "right",
                  .model =
                      [] {
                        return ModelOf(
                            {BumpyPatch(25, 1, 10, [](int k, int) { return std::pow(10.0, 6.0 * k / 25); })});
                      },
                  .cameras = Around,
                  .certified = {0.999, 0.999, 0.999},
                  .doubts = kDoubtSilhouette | kDoubtTwoRoots | kDoubtTrim,
                  .depth_bound_mm = 1e-2,
                  .judged = 24});
}

void AddSheets(Rows& rows) {
  for (const int count : {100, 1000}) {
    char input[80];
    std::snprintf(input, sizeof input, "bicubic B-spline of %d × %d control points", count, count);
    rows.push_back({.group = "control points",
                    .input = input,
                    .expected = "right",
                    .model = [=] { return ModelOf({WavySheet(count, 10)}); },
                    .cameras = [](const Model& model) { return NamedViews(model, {"iso"}, 128); },
                    .depth_bound_mm = 1e-9,
                    .judged = 12,
                    .by_hand = count > 100});
  }
}

void AddKnots(Rows& rows) {
  for (const double gap : {1e-6, 1e-12, 4e-16}) {
    char input[80];
    std::snprintf(input, sizeof input, "bicubic, two knots %g apart in the middle", gap);
    rows.push_back({.group = "knots",
                    .input = input,
                    .expected = "right, through the short span too",
                    .model =
                        [=] {
                          return ModelOf({CutAt(BumpyPatch(3, 3, 10), {0.5, 0.5 + gap})});
                        },
                    .cameras =
                        [](const Model& model) {
                          std::vector<Camera> views = Around(model);
                          views.push_back(CloseTo(model, "top", {5, 5, 0}, 1e-9, 33));
                          return views;
                        },
                    // In float, leaves of the short span overlap in a large part of the close view.
                    .certified = {0.95, 0.99, 0.99},
                    .doubts = kDoubtSilhouette | kDoubtTwoRoots | kDoubtTrim | kDoubtUnresolved,
                    .depth_bound_mm = 1e-6});
  }
  rows.push_back(
      {.group = "knots",
       .input = "degrees 5 × 4, knots of every multiplicity up to the degree",
       .expected = "right",
       .model =
           [] {
             return oracle::RandomSurface(
                 {.degree_u = 5, .degree_v = 4, .spans_u = 6, .spans_v = 6, .bump = 0.4, .seed = 3});
           },
       .cameras = Around,
       .depth_bound_mm = 1e-6});
}

}  // namespace

void AddNets(Rows& rows) {
  AddWeights(rows);
  AddDegrees(rows);
  AddSheets(rows);
  AddKnots(rows);
}

}  // namespace facetless::extremes
