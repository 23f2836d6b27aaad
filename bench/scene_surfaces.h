// Surfaces that the scenes of the bench are made of. All are added to a builder's part, each as a face without trimming.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/base/vec.h"
#include "render/model/builder.h"

namespace facetless {

Vec4 Weighted(Vec3 p, double w);
// `count` spans of length 1.
std::vector<Span> UnitSpans(int count);
// Returns the built model with one placement. Our own scenes are valid, so Finish() cannot fail.
Model Placed(ModelBuilder builder);

// Adds a uniform bicubic B-spline, split into its columns × rows Bézier patches. Its control points are net(i, j) with
// i < columns + 3 and j < rows + 3.
void AddUniformBspline(ModelBuilder& builder, int columns, int rows,
                       const std::function<Vec4(int, int)>& net);

// Adds a closed tube around z. Its radius and centre depend on the angle and on the share of the height. `seed` draws the
// weights; with 0, all are 1.
void AddTube(ModelBuilder& builder, int around, int along, double height,
             const std::function<Vec3(double, double)>& at, std::uint64_t seed);

}  // namespace facetless
