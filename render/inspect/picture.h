// An inspection as a picture, and its legend.
//
//  1. Colours are matte: those of the legend, darkened by up to a quarter where the surface turns away from
//     the viewer. No light and no shadow is mixed in.
//  2. Numbers are coloured by a scale over the range, clamped at its ends: blue below 0 and orange above it
//     where 0 divides them, else dark to light. A hit without a number is grey.
//  3. Draft: enough, too little, undercut. kSettled decides the borders, so that a wall at exactly the limit
//     has one class, whatever float32 makes of its normal.
//  4. back: faces seen from inside, in a signal colour. unseen: those too, and faces with fewer pixel centres
//     than `few_pixels`; a face with none cannot be shown, and is listed.
//  5. Caps of sections are grey and hatched: no number and no class is theirs.
//  6. Stripes and light are turned to the viewer. Draft, curvature and thickness have the outside that
//     Inspection::orient says, and back_pixels counts where the file's is turned away. Two tracers that agree
//     in the samples agree in every byte; no libm.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/image/film.h"
#include "render/inspect/values.h"
#include "render/shade/shade.h"

namespace facetless {

// A colour of the picture that stands for a class, and how many pixel centres have it.
struct InspectionClass {
  std::string name;
  Color color;
  std::uint64_t pixels = 0;
};

// One view's inspection: made from its pixel centres, drawn at any number of samples per pixel.
struct InspectionView {
  Inspection inspection;
  Quantity quantity;  // of kinds with values
  PerSample<double> values;
  ValueStatistics statistics;
  ValueRange range;
  std::vector<InspectionClass> classes;
  std::vector<std::uint32_t> face_pixels;  // by placed face; of unseen
  std::uint64_t back_pixels = 0;  // pixel centres where the viewer looks at the inside, as the file has it
};

// `centres` are the samples at pixel centres, of the model's `scene` or, where it is null, of a mesh.
// Errors: those of InspectionValues.
Result<InspectionView> Measure(const Model& model, const Scene* scene, const SampleBuffer& centres,
                               const CameraFrame& frame, const Inspection& inspection,
                               const Execution& execution);

// The picture of `samples`, which are the centres that `view` was measured at or a supersampling of them.
// `model` and `scene` as for Measure. Errors: kSizeMismatch, kNotFinite (names the pixel), those of
// InspectionValues.
Result<Film> Draw(const Model& model, const Scene* scene, const SampleBuffer& samples,
                  const CameraFrame& frame, const InspectionView& view, const ShadeOptions& options);

// The legend as a picture of its own, `width` pixels wide and at least kLeastLegend; empty for kinds that
// need none.
inline constexpr int kLeastLegend = 240;
Image8 DrawLegend(const InspectionView& view, int width);

}  // namespace facetless
