// One view, start to end: what the command line and the HTTP service both call.
//
//  1. Depth, normals, faces and every number of the difference come from a pass through pixel centres. With
//     samples > 1 the colour comes from a second, supersampled pass of the same camera.
//  2. Times are of a steady clock, in ms, and disjoint: total is the whole call for that tracer, files
//     excluded. prepare and trace are of the pixel-centre pass; the second pass is color_ms, finding lines
//     lines_ms, and shading (with resolve and encode) shade_ms.
//  3. peak_bytes counts what the tracer holds for this view at its fullest: the direct one the scene's
//     leaves, bitmaps and buffers; the baseline the mesh, Embree's own count at its highest, and buffers. The
//     model and the program itself are not in it.
//  4. An inspection is measured at pixel centres, its robust range included, and drawn where the colour comes
//     from.
//  5. A foreign mesh names no faces: each of its pixels takes the colour of the face that the direct image
//     shows there, and the commonest colour of that image where it shows none.
//  6. Section planes cut both models (view/section.h). An audit counts the crossings of the whole model.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/execution.h"
#include "render/baseline/tracer.h"
#include "render/compare/difference.h"
#include "render/compare/difference_picture.h"
#include "render/compare/face_colors.h"
#include "render/image/film.h"
#include "render/image/metrics.h"
#include "render/inspect/picture.h"
#include "render/lines/line.h"
#include "render/model/model.h"
#include "render/shade/shade.h"
#include "render/trace/direct.h"
#include "render/view/camera.h"

namespace facetless {

struct ViewOptions {
  Execution execution;
  int samples = 1;  // per pixel, 1 … 64: split into the most even grid (SampleGrid)
  Precision precision = Precision::kStandard;
  CheckLevel check = CheckLevel::kAuto;
  // What the leaves of a view may take, and the search tree that a view alone needs (of what lies behind
  // transparent faces).
  std::uint64_t max_bytes = DirectOptions{}.max_bytes;
  bool edges = false;
  LineMode lines = LineMode::kNone;  // drawn over both pictures, from the exact model
  bool find_lines = false;           // fill DirectView::lines, whatever is drawn
  Background background = Background::kStudio;
  Coloring coloring;
  Inspection inspection;               // what both pictures show; the difference is measured all the same
  double newton_tolerance = 0;         // as DirectOptions
  bool uv = false;                     // fill the direct samples' uv
  bool depth_error = false;            // fill the direct samples' depth_error
  bool audit = false;                  // fill stats.odd_rays and stats.reverse_mismatches
  std::vector<SectionPlane> sections;  // what is cut away, of both models alike
  ColorMetricOptions color;
  DifferencePictureOptions picture;
};

struct SampleGrid {
  int x = 1, y = 1;
};
// The most even factors: 4 → 2×2, 8 → 4×2, 7 → 7×1.
SampleGrid GridOf(int samples);

struct DirectView {
  CameraFrame frame;
  SampleBuffer samples;
  DirectStats stats;                      // of the pixel-centre pass
  std::vector<std::string> unseen_names;  // of stats.unseen_faces, in that order
  Image8 image;
  std::optional<InspectionView> inspection;  // none: the studio
  SampleGrid grid;
  std::vector<ViewLine> lines;  // hidden ones only with LineMode::kHidden
  double color_ms = 0, lines_ms = 0, shade_ms = 0, total_ms = 0;
  std::uint64_t peak_bytes = 0;
};

struct BaselineView {
  SampleBuffer samples;
  BaselineStats stats;  // of the pixel-centre pass
  Image8 image;
  std::optional<InspectionView> inspection;  // none: the studio
  double color_ms = 0, shade_ms = 0;
  double total_ms = 0;  // without meshing and build, which happen once per mesh
  std::uint64_t peak_bytes = 0;
};

struct ViewComparison {
  Camera camera;
  DirectView direct;
  BaselineView baseline;
  Difference difference;
  DifferencePicture picture;
  double difference_ms = 0;
};

// Errors: those of TraceDirect, Shade, Measure and Draw; kBadUsage (options).
Result<DirectView> RenderView(const Scene& scene, const Camera& camera, const ViewOptions& options);

// The baseline alone, of a mesh that names the model's faces (Mesh::from_model). Errors: those of
// TraceBaseline and Shade; kBadUsage (options, a foreign mesh, an inspection that no mesh can show).
Result<BaselineView> RenderMesh(const BaselineScene& baseline, const Model& model, const Camera& camera,
                                const ViewOptions& options);

// Errors: those of RenderView, TraceBaseline, CheckMeshCanShow, ComputeDifference and DrawDifference.
Result<ViewComparison> CompareView(const Scene& scene, const BaselineScene& baseline, const Camera& camera,
                                   const ViewOptions& options);

}  // namespace facetless
