// Looks for light through the seams of a CAD file: every crossing of every ray from many sides, forwards and
// backwards.
//
//  1. `Around` has the 26 directions of a cube's faces, edges and corners. Each is a view of the whole model.
//  2. `AtEdges` aims at points and ends of edges, from those directions, along the edge, across it and at
//     random. It is so close that the gap between faces, or a share of the model's size, fills the view. Rays
//     that do not aim at edges miss the defects.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/model/model.h"
#include "render/trace/direct.h"
#include "render/view/camera.h"

namespace facetless {

struct SweepView {
  std::string what;  // "from 1 -1 0"
  Camera camera;
};

std::vector<SweepView> Around(const Model& model, int size);
std::vector<SweepView> AtEdges(const Model& model, int count, int size, std::uint64_t seed);

// A ray that crosses a closed solid an odd number of times, or that does not meet backwards what it meets
// forwards.
struct LeakingRay {
  std::string view;
  int column = 0, row = 0;
  bool odd = false, mismatched = false;
  std::string crossings;          // faces and depths, forwards and backwards
  std::uint32_t edge = kNoIndex;  // the nearest edge in the image
  double edge_px = 0;             // distance of that edge
  double gap_mm = 0;              // gap of that edge
};

struct SweepResult {
  std::uint64_t views = 0, rays = 0, crossings = 0, odd = 0, mismatched = 0, seam_samples = 0;
  std::vector<LeakingRay> leaking;  // at most kMostLeaking
};
inline constexpr std::size_t kMostLeaking = 100;

// Errors: those of the renderer.
Result<SweepResult> Sweep(const Scene& scene, const std::vector<SweepView>& views);

// Imports the file as facetless-import does. Errors: those of the importer.
Result<Model> ImportedModel(const std::string& path);

}  // namespace facetless
