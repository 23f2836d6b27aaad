#include "render/compare/borrowed_faces.h"

#include <array>
#include <map>
#include <utility>

namespace facetless {

BorrowedFaces::BorrowedFaces(const std::vector<Color>& colors) {
  std::map<std::array<float, 4>, std::pair<std::size_t, std::uint32_t>> counts;
  std::size_t most = 0;
  for (std::uint32_t face = 0; face < colors.size(); ++face) {
    const Color& color = colors[face];
    auto& [count, first] =
        counts.try_emplace({color.r, color.g, color.b, color.a}, std::size_t{0}, face).first->second;
    if (++count <= most) continue;
    most = count;
    commonest_ = first;
  }
}

BorrowedFaces::BorrowedFaces(const SampleBuffer& centres, const SampleBuffer* all,
                             const Refinement* refinement)
    : centres_(&centres), all_(all), refinement_(refinement) {
  std::map<std::uint32_t, std::size_t> counts;
  for (const std::uint32_t face : (all != nullptr ? *all : centres).face)
    if (face != kNoIndex) ++counts[face];
  std::size_t most = 0;
  for (const auto& [face, count] : counts) {
    if (count <= most) continue;
    most = count;
    commonest_ = face;
  }
}

PerSample<std::uint32_t> BorrowedFaces::OfCentres(const SampleBuffer& samples) const {
  PerSample<std::uint32_t> faces = samples.face;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (faces[i] != kNoIndex) faces[i] = Or(centres_ != nullptr ? centres_->face[i] : kNoIndex);
  return faces;
}

PerSample<std::uint32_t> BorrowedFaces::OfAllSamples(const SampleBuffer& samples, SampleGrid grid) const {
  PerSample<std::uint32_t> faces = samples.face;
  const int width = samples.width / grid.x;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i] == kNoIndex) continue;
    const int column = static_cast<int>(i % static_cast<std::size_t>(samples.width)),
              row = static_cast<int>(i / static_cast<std::size_t>(samples.width));
    const auto pixel = static_cast<std::uint32_t>(row / grid.y * width + column / grid.x);
    faces[i] = Or(Shown(pixel, grid, row % grid.y * grid.x + column % grid.x));
  }
  return faces;
}

PerSample<std::uint32_t> BorrowedFaces::OfRefinement(const Refinement& refinement) const {
  PerSample<std::uint32_t> faces = refinement.samples.face;
  const auto count = static_cast<std::size_t>(refinement.grid.count());
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (faces[i] != kNoIndex)
      faces[i] =
          Or(Shown(refinement.pixels.pixels()[i / count], refinement.grid, static_cast<int>(i % count)));
  return faces;
}

std::uint32_t BorrowedFaces::Shown(std::uint32_t pixel, SampleGrid grid, int k) const {
  if (centres_ == nullptr) return kNoIndex;
  if (all_ != nullptr) {
    const SamplePlace at = PlaceOfSample(pixel, centres_->width, grid, k);
    return all_->face[static_cast<std::size_t>(at.row) * all_->width + at.column];
  }
  const auto width = static_cast<std::uint32_t>(centres_->width);
  const int column = static_cast<int>(pixel % width), row = static_cast<int>(pixel / width);
  if (refinement_ == nullptr || !refinement_->pixels.Has(column, row)) return centres_->face[pixel];
  const std::size_t first = std::size_t{refinement_->pixels.Rank(column, row)} * grid.count();
  return refinement_->samples.face[first + static_cast<std::size_t>(k)];
}

}  // namespace facetless
