// Which stretches of a view's lines are seen: by comparison with the exact samples of the same view.
//
//  1. A line is looked at every kStep samples. The nearest sample says what the ray there shows: its tangent
//     plane, continued to the line, is in front of the line or not. What the plane's slope itself changes on
//     the way, twice, and kSlack samples' width are allowed: beside a silhouette a surface bends like a
//     square root, for which twice is the bound. Planes seen nearly edge-on are taken at their word on the
//     line's own faces only: near enough, every silhouette is as steep as one likes. A line's own faces, and
//     of silhouettes and smooth edges those that join them along an edge, may lie in front of it by as much
//     as they would if the line were off its curve by kFlatness, as its chords may be: a silhouette does not
//     hide itself.
//  2. So a change is found to within one sample; runs of less than kShortest samples between two of the other
//     kind are noise, and are given to them.
//  3. A line of a class that is drawn paler becomes a silhouette where it is the outline of what is seen:
//     where the samples on one of its sides, two samples away, show nothing, or something that lies behind it
//     by far more than its faces could.
//  4. The samples may be finer than the lines' pixels (Camera::Supersampled).
#pragma once

#include <vector>

#include "render/lines/line.h"
#include "render/view/samples.h"

namespace facetless {

// Splits lines where they come into sight or go out of it, and leaves out what CutToPicture does. `frame`: of
// the lines; `sample_frame`: of the samples, over the same window. `joined`: by placed face, the placed faces
// that share an edge with it, ascending.
std::vector<ViewLine> SplitByVisibility(const std::vector<ViewLine>& lines, const CameraFrame& frame,
                                        const SampleBuffer& samples, const CameraFrame& sample_frame,
                                        const std::vector<std::vector<std::uint32_t>>& joined);

}  // namespace facetless
