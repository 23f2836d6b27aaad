// Which stretches of a view's lines are seen: by comparison with the exact samples of the same view.
//
//  1. A line is looked at every kStep samples. The nearest sample says what the ray there shows: its tangent plane,
//     continued to the line, is in front of the line or not. What the plane's slope itself changes on the way, twice,
//     and kSlack samples' width are allowed: beside a silhouette a surface bends like a square root, for which twice
//     is the bound. Planes seen nearly edge-on are taken at their word on the line's own faces only: near enough,
//     every silhouette is as steep as one likes.
//  2. So a change is found to within one sample; runs of less than kShortest samples between two of the other kind
//     are noise, and are given to them.
//  3. The samples may be finer than the lines' pixels (Camera::Supersampled).
#pragma once

#include <vector>

#include "render/lines/line.h"
#include "render/trace/samples.h"

namespace facetless {

// Splits lines where they come into sight or go out of it, and leaves out what CutToPicture does. `frame`: of the
// lines; `sample_frame`: of the samples, over the same window.
std::vector<ViewLine> SplitByVisibility(const std::vector<ViewLine>& lines, const CameraFrame& frame,
                                        const SampleBuffer& samples, const CameraFrame& sample_frame);

}  // namespace facetless
