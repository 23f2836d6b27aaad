// One view from start to end: rendering one representation, or comparing candidates with a reference. The
// command line and the HTTP service both call these functions.
//
//  1. Depth, normals, faces and every number of the difference come from a pass through pixel centres. With
//     samples > 1, the colour comes from samples of the same camera: adaptively, where something happens within a
//     pixel (view/refinement.h), or uniformly, in a second pass through all samples of all pixels.
//  2. Times are measured by a steady clock, in ms, and are disjoint. total_ms is the whole call for the
//     representation, without files. prepare_ms and trace_ms belong to the pixel-centre pass, color_ms to the
//     samples for the colour, lines_ms to finding lines, and shade_ms to shading (with resolve and encode).
//  3. peak_bytes is the peak memory of a representation for this view: for exact surfaces, the scene's
//     leaves, bitmaps and buffers; for triangles, the mesh, the peak memory that Embree reports, and buffers.
//     It excludes the model and the program.
//  4. An inspection and its robust range are measured at pixel centres. The picture is drawn at the samples
//     of the colour.
//  5. If a candidate has no face ids (a mesh of another program), each of its pixels has the colour of the
//     face that the reference shows there, or the most common colour of the reference if it shows none.
//     Without a reference, such a representation has the colour of most faces of the model.
//  6. Section planes cut every representation (view/section.h). An audit counts the crossings of the whole
//     model.
//  7. Light by secondary rays (ViewOptions::light) is cast for the samples from which the colour is made, and for the
//     pixel centres. Each representation casts its own rays. Transparent faces and faces of glass block no light.
//
//   const ExactSurfaces exact(scene, {});
//   const Triangles triangles(baseline, model, {}, max_bytes);
//   const Representation* candidates[] = {&triangles};
//   Result<ViewComparison> compared = CompareView(exact, candidates, model, camera, {.samples = 4});
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/compare/difference.h"
#include "render/compare/difference_picture.h"
#include "render/compare/face_colors.h"
#include "render/compare/light_difference.h"
#include "render/compare/representation.h"
#include "render/compare/view_light.h"
#include "render/image/film.h"
#include "render/image/metrics.h"
#include "render/inspect/picture.h"
#include "render/lines/line.h"
#include "render/model/model.h"
#include "render/shade/shade.h"
#include "render/view/camera.h"
#include "render/view/refinement.h"

namespace facetless {

// The options of a view that do not depend on the representation.
struct ViewOptions {
  Execution execution;
  int samples = 1;  // per pixel, 1 … 64: split into the most even grid (SampleGrid)
  // Take all samples of every pixel. Views with lines, edges, sections, transparent faces or an inspection are
  // always sampled uniformly, because those need the samples of all pixels.
  bool uniform_samples = false;
  bool edges = false;
  LineMode lines = LineMode::kNone;  // drawn over all pictures, from the exact model
  bool find_lines = false;           // fill View::lines for exact surfaces, even if no lines are drawn
  Background background = Background::kStudio;
  Coloring coloring;
  Inspection inspection;     // the inspection that all pictures show; it does not affect the difference
  bool uv = false;           // fill the samples' uv, if the representation has parameters
  bool depth_error = false;  // fill the samples' depth_error, if the representation provides it
  bool audit = false;        // fill odd_rays and reverse_mismatches of View::direct
  // The section planes. The options of exact surfaces and triangles must contain the same planes.
  std::vector<SectionPlane> sections;
  LightOptions light;      // secondary rays; they require InspectionKind::kStudio
  UpAxis up = UpAxis::kZ;  // the axis of the model that points up; the ground is perpendicular to it
  ColorMetricOptions color;
  DifferencePictureOptions picture;
};

// The view of one representation from one camera.
struct View {
  CameraFrame frame;
  SampleBuffer samples;                   // of the pixel centres
  TraceCounters counters;                 // of the pixel-centre pass
  std::optional<DirectStats> direct;      // of exact surfaces, of the pixel-centre pass
  std::optional<SolverStats> solver;      // if a solver by name traced them, of the pixel-centre pass
  std::vector<std::string> unseen_names;  // of direct->unseen_faces, in that order
  Image8 image;
  std::optional<InspectionView> inspection;  // nothing for InspectionKind::kStudio
  std::optional<ViewLight> light;            // nothing without secondary rays
  SampleGrid grid;
  std::optional<std::uint64_t>
      refined_pixels;           // pixels with all samples of the grid; nothing if all have them
  std::vector<ViewLine> lines;  // of exact surfaces; hidden ones only with LineMode::kHidden
  double color_ms = 0, lines_ms = 0, shade_ms = 0;
  double total_ms = 0;  // excludes making the representation, which happens once for all views
  std::uint64_t peak_bytes = 0;
};

// One candidate and its difference from the reference.
struct CandidateView {
  std::string name, title;  // of the representation
  double make_ms = 0;
  std::vector<RepresentationFact> facts;
  View view;
  Difference difference;
  DifferencePicture picture;
  std::optional<LightComparison> light;  // nothing without shadows and occlusion
  double difference_ms = 0;
};

struct ViewComparison {
  Camera camera;
  View reference;
  std::vector<CandidateView> candidates;  // in the order in which they were given
};

// Renders the view of one representation of `model`. Errors: the errors of Trace, Shade, Measure and Draw;
// kBadUsage (the options, or an inspection that the representation cannot show).
Result<View> RenderView(const Representation& representation, const Model& model, const Camera& camera,
                        const ViewOptions& options);

// Renders the reference and the candidates, and computes the difference of each candidate from the reference.
// Errors: the errors of RenderView, ComputeDifference and DrawDifference.
Result<ViewComparison> CompareView(const Representation& reference,
                                   std::span<const Representation* const> candidates, const Model& model,
                                   const Camera& camera, const ViewOptions& options);

}  // namespace facetless
