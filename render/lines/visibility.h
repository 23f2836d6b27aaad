// Visibility of lines, determined by comparison with the exact samples of the same view.
//
//  1. A line is tested every kStep samples. The tangent plane of the nearest sample is continued to the line,
//     and the test is whether it lies in front of the line there. The tolerance is twice the change of depth
//     due to the slope of the plane, plus kSlack samples' width: near a silhouette a surface bends like a
//     square root, for which twice the change is the bound. A plane that is seen nearly edge-on is used only
//     if it belongs to the line's own faces, because every surface is arbitrarily steep close to its
//     silhouette. The line's own faces may lie in front of it by as much as if the line were off its curve by
//     kFlatness, as its chords may be; for silhouettes and smooth edges, the same is true of faces that share
//     an edge with them. A silhouette therefore does not hide itself.
//  2. Changes of visibility are found to within one sample. A run of less than kShortest samples between two
//     runs of the other kind is considered noise and joined to them.
//  3. A line of a class that is drawn paler becomes a silhouette where it is the outline of what is visible:
//     where, two samples away on one of its sides, there is a miss, or something farther behind than the
//     line's faces could be.
//  4. The samples may be finer than the pixels of the lines (Camera::Supersampled).
#pragma once

#include <vector>

#include "render/lines/line.h"
#include "render/view/samples.h"

namespace facetless {

// Splits lines where their visibility changes, and clips them with CutToPicture. `frame` belongs to the
// lines, and `sample_frame` to the samples; both have the same window. `joined` lists, for each placed face,
// the placed faces that share an edge with it, ascending.
std::vector<ViewLine> SplitByVisibility(const std::vector<ViewLine>& lines, const CameraFrame& frame,
                                        const SampleBuffer& samples, const CameraFrame& sample_frame,
                                        const std::vector<std::vector<std::uint32_t>>& joined);

}  // namespace facetless
