// Why a sample is not certified: bits of one byte.
#pragma once

#include <array>
#include <cstdint>

namespace facetless {

enum Doubt : std::uint8_t {
  kDoubtSilhouette = 1,   // a root without proof where the ray is tangent to the surface
  kDoubtPole = 2,         // a root without proof where the surface has no tangent plane of its own
  kDoubtTwoRoots = 4,     // two roots of one face closer than their errors, or one on a border of two patches
  kDoubtTrim = 8,         // a trim curve or an edge lies within the error of the hit
  kDoubtCoincident = 16,  // another face lies within the error of the hit's depth
  kDoubtUnresolved = 32,  // neither hit nor miss
  kDoubtLimit =
      // a patch that needed too many leaves, or a ray that needed too much work, was given up: neither hit
  // nor miss
  64,
  kDoubtContradicted =
      128,  // the independent check of a certificate contradicts it (trace/certificate_check.h)
};

// Doubts under which neither a hit nor a miss is known.
inline constexpr std::uint8_t kUnresolvedDoubts = kDoubtUnresolved | kDoubtLimit | kDoubtContradicted;

// What each bit is called in reports, lowest first.
inline constexpr std::array<const char*, 8> kDoubtNames = {
    "silhouette", "pole", "two_roots", "trim", "coincident", "unresolved", "limit", "contradicted"};
static_assert(kDoubtNames.size() <= 8, "a sample keeps its doubts in one byte");

}  // namespace facetless
