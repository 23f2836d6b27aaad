// Faces that coincide, or almost coincide.
#include <cmath>

#include "tests/verify/extremes/catalogue.h"
#include "tests/verify/extremes/models.h"

namespace facetless::extremes {

using testing::ModelOf;
using testing::Rectangle;
using testing::Sphere;

void AddCoincidences(Rows& rows) {
  for (const double apart : {1e-3, 1e-6, 1e-9, 1e-10, 1e-11, 1e-12, 1e-14, 0.0}) {
    char distance[40];
    std::snprintf(distance, sizeof distance, apart > 0 ? "%g mm apart" : "upon each other", apart);
    // If the order cannot be proven, the certificate must say so. For a plane or a sphere of 10 mm, the limit
    // of a proof is a few hundred units in the last place.
    const bool provable = apart >= 1e-9;
    rows.push_back({.group = "coincidence",
                    .input = std::string("two slanted planes of 10 mm, ") + distance,
                    .expected = provable ? "the nearer one" : "either, in doubt, or the nearer one",
                    .model =
                        [=] {
                          const Vec3 a{9.9, 0.3, 1.1}, b{-0.7, 9.7, 2.3};
                          const Vec3 normal = Normalized(Cross(a, b));
                          return ModelOf({Rectangle({0, 0, 0}, a, b), Rectangle(apart * normal, a, b)});
                        },
                    .cameras =
                        [](const Model& model) {
                          return NamedViews(model, {"iso", "top", "iso-below"}, 64);
                        },
                    .certified = {1, 1, provable ? 1 : 0.1},
                    .doubts = static_cast<std::uint8_t>(provable ? 0 : kDoubtCoincident),
                    .depth_bound_mm = 1e-9});
    rows.push_back({.group = "coincidence",
                    .input = std::string("two spheres of 10 mm, one in the other, ") + distance,
                    .expected = provable ? "the outer one" : "either, in doubt, or the outer one",
                    .model =
                        [=] {
                          return ModelOf({Sphere({0, 0, 0}, 10), Sphere({0, 0, 0}, 10 + apart)});
                        },
                    .cameras = [](const Model& model) { return NamedViews(model, {"iso"}, 64); },
                    .certified = {1, 1, provable ? 0.99 : 0.1},
                    .doubts = kDoubtCoincident,
                    .depth_bound_mm = 1e-6,
                    .judged = 30});
  }
}

}  // namespace facetless::extremes
