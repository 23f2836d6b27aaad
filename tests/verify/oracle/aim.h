// Selects the samples to judge: random ones, and those where renderers often fail.
//
//  1. The selection depends only on the seed. No pixel occurs twice.
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

// Returns points of the model at which something begins or ends: vertices, points on edges, corners of
// patches (which include seams and poles). Returns at most `most`, from all placed faces.
std::vector<Vec3> Features(const Model& model, std::size_t most, Random& random);

// Returns `count` pixels at random places.
std::vector<std::uint32_t> RandomPixels(const SampleBuffer& samples, std::size_t count, Random& random);

// Returns at most `count` of these pixels: pixels next to a change of face, or of hit and miss; pixels
// without a certificate; pixels onto which one of `features` is projected, and their neighbours.
std::vector<std::uint32_t> HardPixels(const DirectResult& direct, const std::vector<Vec3>& features,
                                      std::size_t count, Random& random);

// Returns the same view through a window of `window` mm at `point`, which covers a fraction of a pixel of the
// original.
Camera CloseUp(const Camera& camera, const CameraFrame& frame, Vec3 point, double window, int size);

}  // namespace facetless::oracle
