// Which samples are worth judging: random ones, and those where renderers fail.
//
//  1. Deterministic in the seed. No pixel twice.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "render/trace/direct.h"
#include "render/view/camera.h"

namespace facetless::oracle {

// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double low, double high) { return low + (high - low) * (double(engine_() >> 11) * 0x1p-53); }
  std::uint32_t Below(std::uint32_t count) { return static_cast<std::uint32_t>(engine_() % count); }

 private:
  std::mt19937_64 engine_;
};

// Points of the model where something begins or ends: vertices, points on edges, corners of patches (seams
// and poles among them). At most `most`, of all placed faces.
std::vector<Vec3> Features(const Model& model, std::size_t most, Random& random);

// `count` pixels anywhere.
std::vector<std::uint32_t> RandomPixels(const SampleBuffer& samples, std::size_t count, Random& random);

// At most `count` of: pixels beside a change of face, or from hit to miss; pixels without a certificate;
// pixels onto which one of `features` falls, and their neighbours.
std::vector<std::uint32_t> HardPixels(const DirectResult& direct, const std::vector<Vec3>& features,
                                      std::size_t count, Random& random);

// The same view through a window of `window` mm at `point`: what of the original is a fraction of a pixel.
Camera CloseUp(const Camera& camera, const CameraFrame& frame, Vec3 point, double window, int size);

}  // namespace facetless::oracle
