// The picture of an inspection, and its legend.
//
//     Result<InspectionView> view = Measure(model, &scene, centres, frame, inspection, {});
//     if (!view) return view.error();
//     Result<Film> film = Draw(model, &scene, samples, frame, view.value(), options);
//
//  1. Colours are matte: they are the colours of the legend, darkened by up to a quarter where the surface
//     turns away from the viewer. There is no lighting and no shadow.
//  2. Numbers are coloured by a scale over the range, clamped at its ends. Quantities with a sign are blue
//     below 0 and orange above it; others run from dark to light. A hit without a number is grey.
//  3. draft has three classes: sufficient, too little, undercut. The limits have the tolerance kSettled, so
//     that a wall with exactly the limiting angle has one class in spite of the rounding of its float32
//     normal.
//  4. back shows faces seen from inside in a signal colour. unseen shows these too, and faces with fewer
//     pixel centres than `few_pixels`. A face without any pixel cannot be shown, but is listed.
//  5. Caps of sections are grey and hatched. They have no number and belong to no class.
//  6. Stripes and light are oriented to the viewer. Draft, curvature and thickness use the outside that
//     Inspection::orient selects; back_pixels counts the pixels where the outside of the file is turned away.
//     Two tracers whose samples are equal give pictures with equal bytes. No libm function is used.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/image/film.h"
#include "render/inspect/values.h"
#include "render/shade/shade.h"

namespace facetless {

// A class of the picture: its name, its colour and the number of its pixel centres.
struct InspectionClass {
  std::string name;
  Color color;
  std::uint64_t pixels = 0;
};

// The inspection of one view. It is measured at the pixel centres, and can be drawn with any number of
// samples per pixel.
struct InspectionView {
  Inspection inspection;
  Quantity quantity;  // for kinds with values
  PerSample<double> values;
  ValueStatistics statistics;
  ValueRange range;
  std::vector<InspectionClass> classes;
  std::vector<std::uint32_t> face_pixels;  // number of pixel centres by placed face; for kUnseen
  std::uint64_t back_pixels = 0;  // number of pixel centres that show the inside, by the file's orientation
};

// Measures an inspection. `centres` are the samples at the pixel centres, of the model's `scene`, or of a
// mesh if `scene` is null. Errors: the errors of InspectionValues.
Result<InspectionView> Measure(const Model& model, const Scene* scene, const SampleBuffer& centres,
                               const CameraFrame& frame, const Inspection& inspection,
                               const Execution& execution);

// Draws the picture of `samples`, which are the samples with which `view` was measured, or a supersampling of
// them. `model` and `scene` are those of Measure. Errors: kSizeMismatch, kNotFinite (names the pixel), and
// the errors of InspectionValues.
Result<Film> Draw(const Model& model, const Scene* scene, const SampleBuffer& samples,
                  const CameraFrame& frame, const InspectionView& view, const ShadeOptions& options);

// Draws the legend as a separate picture, max(width, kLeastLegend) pixels wide. It is empty for kinds without
// a legend.
inline constexpr int kLeastLegend = 240;
Image8 DrawLegend(const InspectionView& view, int width);

}  // namespace facetless
