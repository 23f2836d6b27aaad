// The tile kernel: all instruction sets give the same bytes, and the selection among them works.
#include "render/kernels/tile_kernel.h"

#include <gtest/gtest.h>

#include <cstring>

#include "render/kernels/dispatch.h"
#include "render/trace/tile_tracer.h"
#include "tests/support/shapes.h"

namespace facetless {
namespace {

using testing::ModelOf;

// Returns all answers of one kernel for one view, tile by tile.
std::vector<unsigned char> Bytes(const TraceShared& shared, TileKernel kernel, TileCounters* counters) {
  std::vector<unsigned char> bytes;
  TileTracer tracer(shared, kernel, /*certify=*/true);
  for (int tile = 0; tile < shared.view.tiles->tiles_x() * shared.view.tiles->tiles_y(); ++tile) {
    tracer.Trace(tile, nullptr);
    const auto append = [&](const auto& value) {
      const auto* first = reinterpret_cast<const unsigned char*>(&value);
      bytes.insert(bytes.end(), first, first + sizeof(value));
    };
    append(tracer.empty());
    for (int i = 0; i < tracer.rows() && !tracer.empty(); ++i) {
      for (int j = 0; j < tracer.columns(); ++j) {
        const int k = i * kTileSize + j;
        append(tracer.depth[k]);
        append(tracer.leaf[k]);
        append(tracer.doubt[k]);
        if (tracer.leaf[k] == kNoIndex) continue;
        append(tracer.error[k]);
        append(tracer.s[k]);
        append(tracer.t[k]);
        append(tracer.normal[k]);
      }
    }
  }
  *counters = tracer.counters;
  return bytes;
}

TEST(TileKernel, EveryInstructionSetGivesTheSameBytes) {
  const std::vector<Kernels> kernels = AvailableKernels();
  ASSERT_EQ(kernels.front().isa, "scalar");
  const Model model = ModelOf({testing::Torus({0, 0, 0}, 10, 3), testing::Sphere({4, 6, 2}, 5),
                               testing::Frustum({-6, 0, -4}, 4, 0, 9),
                               testing::Rectangle({-12, -12, -4}, {24, 0, 1}, {0, 24, 2})});
  const Scene scene(model);
  for (const Precision precision : {Precision::kFast, Precision::kStandard}) {
    const auto kernel_of = [&](const Kernels& k) {
      return precision == Precision::kFast ? k.trace_tile_float : k.trace_tile;
    };
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      // 203 is not a multiple of a packet or a tile.
      const Camera camera = NamedView("iso", model.bounds, projection, 203, 201).value();
      const CameraFrame frame = MakeFrame(camera, model.Diagonal()).value();
      DirectOptions options;
      options.accuracy.precision = precision;
      const PreparedView view = PrepareView(scene.data(), camera, frame, options).value();
      const TraceShared shared(scene.data(), view, camera, frame);
      TileCounters expected_counters;
      const std::vector<unsigned char> expected = Bytes(shared, kernel_of(kernels[0]), &expected_counters);
      EXPECT_GT(expected_counters.solves, 10000u);
      EXPECT_GT(expected_counters.fallbacks, 10u);
      for (const Kernels& other : kernels) {
        TileCounters counters;
        EXPECT_EQ(Bytes(shared, kernel_of(other), &counters), expected) << other.isa;
        EXPECT_EQ(counters.solves, expected_counters.solves) << other.isa;
        EXPECT_EQ(counters.iterations, expected_counters.iterations) << other.isa;
      }
    }
  }
}

TEST(TileKernel, TheActiveKernelIsOneOfTheAvailable) {
  const Result<Kernels>& active = ActiveKernels();
  ASSERT_TRUE(active.ok());
  bool found = false;
  for (const Kernels& kernels : AvailableKernels())
    found = found || kernels.trace_tile == active.value().trace_tile;
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace facetless
