// One view, start to end: what the command line and the HTTP service both call.
//
//  1. Depth, normals, faces and every number of the difference come from a pass through pixel centres. With
//     samples > 1 the colour comes from a second, supersampled pass of the same camera.
//  2. Times are of a steady clock, in ms, and disjoint: total is the whole call for that representation, files
//     excluded. prepare and trace are of the pixel-centre pass; the second pass is color_ms, finding lines
//     lines_ms, and shading (with resolve and encode) shade_ms.
//  3. peak_bytes counts what a representation holds for this view at its fullest: exact surfaces the scene's
//     leaves, bitmaps and buffers; triangles the mesh, Embree's own count at its highest, and buffers. The
//     model and the program itself are not in it.
//  4. An inspection is measured at pixel centres, its robust range included, and drawn where the colour comes
//     from.
//  5. A candidate that names no faces (a mesh of another program) has each of its pixels take the colour of
//     the face that the reference shows there, and the commonest colour of the reference where it shows none.
//     Alone, such a representation has the colour that most faces of the model have.
//  6. Section planes cut every representation (view/section.h). An audit counts the crossings of the whole
//     model.
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
#include "render/compare/representation.h"
#include "render/image/film.h"
#include "render/image/metrics.h"
#include "render/inspect/picture.h"
#include "render/lines/line.h"
#include "render/model/model.h"
#include "render/shade/shade.h"
#include "render/view/camera.h"

namespace facetless {

// What a view needs to know whatever it looks at.
struct ViewOptions {
  Execution execution;
  int samples = 1;  // per pixel, 1 … 64: split into the most even grid (SampleGrid)
  bool edges = false;
  LineMode lines = LineMode::kNone;  // drawn over all pictures, from the exact model
  bool find_lines = false;           // fill View::lines of exact surfaces, whatever is drawn
  Background background = Background::kStudio;
  Coloring coloring;
  Inspection inspection;     // what all pictures show; the difference is measured all the same
  bool uv = false;           // fill the samples' uv, where the representation has parameters
  bool depth_error = false;  // fill the samples' depth_error, where the representation knows it
  bool audit = false;        // fill odd_rays and reverse_mismatches of View::direct
  // What is cut away; of exact surfaces and triangles the same planes belong into their own options.
  std::vector<SectionPlane> sections;
  ColorMetricOptions color;
  DifferencePictureOptions picture;
};

struct SampleGrid {
  int x = 1, y = 1;
};
// The most even factors: 4 → 2×2, 8 → 4×2, 7 → 7×1.
SampleGrid GridOf(int samples);

// What one representation looks like from one camera.
struct View {
  CameraFrame frame;
  SampleBuffer samples;                   // of the pixel centres
  TraceCounters counters;                 // of the pixel-centre pass
  std::optional<DirectStats> direct;      // of exact surfaces, of the pixel-centre pass
  std::vector<std::string> unseen_names;  // of direct->unseen_faces, in that order
  Image8 image;
  std::optional<InspectionView> inspection;  // none: the studio
  SampleGrid grid;
  std::vector<ViewLine> lines;  // of exact surfaces; hidden ones only with LineMode::kHidden
  double color_ms = 0, lines_ms = 0, shade_ms = 0;
  double total_ms = 0;  // without making the representation, which happens once for all views
  std::uint64_t peak_bytes = 0;
};

// One representation beside the reference.
struct CandidateView {
  std::string name, title;  // of the representation
  double make_ms = 0;
  std::vector<RepresentationFact> facts;
  View view;
  Difference difference;
  DifferencePicture picture;
  double difference_ms = 0;
};

struct ViewComparison {
  Camera camera;
  View reference;
  std::vector<CandidateView> candidates;  // in the order in which they were given
};

// The view of one representation of `model`. Errors: those of Trace, Shade, Measure and Draw; kBadUsage (the
// options, an inspection that the representation cannot show).
Result<View> RenderView(const Representation& representation, const Model& model, const Camera& camera,
                        const ViewOptions& options);

// The view of the reference, those of the candidates, and how each of these differs from the reference.
// Errors: those of RenderView, ComputeDifference and DrawDifference.
Result<ViewComparison> CompareView(const Representation& reference,
                                   std::span<const Representation* const> candidates, const Model& model,
                                   const Camera& camera, const ViewOptions& options);

}  // namespace facetless
