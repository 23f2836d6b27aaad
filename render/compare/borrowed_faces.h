// The faces whose colours the samples of a mesh without face ids have (law 5 of compare_view.h): the face that the
// reference shows at the same sample, or, where it shows none, the face that it shows most often.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/view/refinement.h"
#include "render/view/samples.h"

namespace facetless {

class BorrowedFaces {
 public:
  // Without a reference: every hit has the first face that has the commonest colour. `colors` has the colours of the
  // faces, then of the caps.
  explicit BorrowedFaces(const std::vector<Color>& colors);
  // With a reference. `centres` are its pixel centres. `all` are all its samples, if it was sampled uniformly with
  // more than one sample per pixel; `refinement` are those of its refined pixels, if it was sampled adaptively. At
  // most one of them is not null. All must outlive this object.
  BorrowedFaces(const SampleBuffer& centres, const SampleBuffer* all, const Refinement* refinement);

  // The faces of a view's pixel centres.
  PerSample<std::uint32_t> OfCentres(const SampleBuffer& samples) const;
  // The faces of all samples of a view, of which a pixel has `grid`.
  PerSample<std::uint32_t> OfAllSamples(const SampleBuffer& samples, SampleGrid grid) const;
  // The faces of the samples of refined pixels.
  PerSample<std::uint32_t> OfRefinement(const Refinement& refinement) const;

 private:
  // The face that the reference shows at sample `k` of a pixel (row·width + column); kNoIndex: none.
  std::uint32_t Shown(std::uint32_t pixel, SampleGrid grid, int k) const;
  std::uint32_t Or(std::uint32_t shown) const { return shown != kNoIndex ? shown : commonest_; }

  const SampleBuffer *centres_ = nullptr, *all_ = nullptr;
  const Refinement* refinement_ = nullptr;
  std::uint32_t commonest_ = 0;
};

}  // namespace facetless
