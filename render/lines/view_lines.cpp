#include "render/lines/view_lines.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "render/base/parallel.h"
#include "render/lines/edge_lines.h"
#include "render/lines/face_curves.h"
#include "render/lines/visibility.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

std::vector<ViewLine> Find(const Scene& scene, const Camera& camera, const CameraFrame& frame,
                           const LineOptions& options) {
  const Model& model = scene.model();
  std::vector<ViewLine> whole =
      EdgeLines(model, ClassifyEdges(model, options.edge_angle_deg), camera, frame, options.execution);
  std::vector<ViewLine> silhouettes = SilhouetteLines(scene, camera, frame, options.execution);
  whole.insert(whole.end(), std::make_move_iterator(silhouettes.begin()),
               std::make_move_iterator(silhouettes.end()));
  if (options.sections.empty()) return whole;

  // Clip the lines with the planes, and add the outlines of the cuts.
  std::vector<ViewLine> lines;
  for (ViewLine& line : whole) ClipLine(frame, options.sections, -1, std::move(line), &lines);
  for (int k = 0; k < static_cast<int>(options.sections.size()); ++k)
    for (ViewLine& line : CutLines(scene, options.sections[k], camera, frame, options.execution))
      ClipLine(frame, options.sections, k, std::move(line), &lines);
  return lines;
}

// For each placed face, the placed faces that share an edge with it.
std::vector<std::vector<std::uint32_t>> JoinedFaces(const Model& model) {
  const EdgeUses uses(model);
  std::vector<std::vector<std::uint32_t>> of_face(model.faces.size()), joined(model.PlacedFaceCount());
  for (std::size_t e = 0; e < model.edges.size(); ++e)
    for (const EdgeUse& a : uses[e])
      for (const EdgeUse& b : uses[e])
        if (a.face != b.face) of_face[a.face].push_back(b.face);
  for (const Instance& instance : model.instances) {
    for (const PlacedFace placed : WalkPlacedFaces(model, instance)) {
      std::vector<std::uint32_t>& own = joined[placed.id];
      for (const std::uint32_t other : of_face[placed.face])
        own.push_back(PlacedFaceId(model, instance, other));
      std::sort(own.begin(), own.end());
      own.erase(std::unique(own.begin(), own.end()), own.end());
    }
  }
  return joined;
}

}  // namespace

std::vector<ViewLine> FindLines(const Scene& scene, const Camera& camera, const CameraFrame& frame,
                                const SampleBuffer& samples, const CameraFrame& sample_frame,
                                const LineOptions& options) {
  std::vector<ViewLine> lines;
  RunWithThreads(options.execution.threads, [&] {
    lines = SplitByVisibility(Find(scene, camera, frame, options), frame, samples, sample_frame,
                              JoinedFaces(scene.model()));
  });
  return lines;
}

}  // namespace facetless
