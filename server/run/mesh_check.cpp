#include "server/run/mesh_check.h"

#include <algorithm>
#include <cstdio>

namespace facetless {
namespace {

// Even a coarse mesh shares nine tenths of its pixels with the model; a part of an assembly rarely shares
// less than a tenth.
constexpr double kLeastShared = 0.05;
// The thresholds, as shares of the model's size and of the pixels.
constexpr double kMostApart = 0.1, kMostOpposite = 0.9;

}  // namespace

void MeshCheck::Add(const Difference& difference) {
  direct_ += difference.direct_hits;
  baseline_ += difference.baseline_hits;
  both_ += difference.both_hit;
  oriented_ += difference.oriented_pixels;
  opposite_ += difference.opposite_pixels;
  nearest_mm_ = difference.depth_mm.count > 0 ? std::min(nearest_mm_, difference.depth_mm.p50) : nearest_mm_;
}

std::vector<std::string> MeshCheck::Problems() const {
  std::vector<std::string> problems;
  const std::uint64_t any = direct_ + baseline_ - both_;
  if (direct_ > 0 && baseline_ > 0 && static_cast<double>(both_) < kLeastShared * static_cast<double>(any)) {
    problems.push_back("the mesh has hardly anything in common with the model: of " + std::to_string(any) +
                       " pixels that show at least one of the two, " + std::to_string(both_) + " show both");
  } else if (direct_ > 0 && baseline_ == 0) {
    problems.push_back("the mesh is not visible: none of the " + std::to_string(direct_) +
                       " pixels that show the model shows it");
  } else if (both_ > 0 && nearest_mm_ > kMostApart * diagonal_mm_) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the mesh has hardly anything in common with the model: in every view half of the depths "
                  "differ by more than %.3g mm, and the model is %.3g mm large",
                  nearest_mm_, diagonal_mm_);
    problems.push_back(text);
  }
  if (oriented_ > 0 && static_cast<double>(opposite_) > kMostOpposite * static_cast<double>(oriented_))
    problems.push_back("the mesh is turned inside out: " + std::to_string(opposite_) + " of " +
                       std::to_string(oriented_) +
                       " pixels show its inside where the model shows its outside");
  return problems;
}

}  // namespace facetless
