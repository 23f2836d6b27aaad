// The reasons why a sample is not certified, as bits of one byte.
#pragma once

#include <array>
#include <cstdint>

namespace facetless {

enum Doubt : std::uint8_t {
  kDoubtSilhouette = 1,  // a root without proof, at a point where the ray is tangent to the surface
  kDoubtPole = 2,        // a root without proof, at a point where the surface has no tangent plane
  kDoubtTwoRoots =
      4,           // two roots of one face closer than their errors, or a root on the border of two patches
  kDoubtTrim = 8,  // a trim curve or an edge lies within the error of the hit
  kDoubtCoincident = 16,  // another face lies within the error of the hit's depth
  kDoubtUnresolved = 32,  // the sample is neither a hit nor a miss
  kDoubtLimit =
      // a patch that needed too many leaves, or a ray that needed too much work, was given up; the sample is
  // neither a hit nor a miss
  64,
  kDoubtContradicted =
      128,  // the independent check of a certificate contradicts it (trace/certificate_check.h)
};

// The doubts that make a sample unresolved: it is neither a hit nor a miss.
inline constexpr std::uint8_t kUnresolvedDoubts = kDoubtUnresolved | kDoubtLimit | kDoubtContradicted;

// The name of each bit in reports, lowest bit first.
inline constexpr std::array<const char*, 8> kDoubtNames = {
    "silhouette", "pole", "two_roots", "trim", "coincident", "unresolved", "limit", "contradicted"};
static_assert(kDoubtNames.size() <= 8, "a sample keeps its doubts in one byte");

}  // namespace facetless
