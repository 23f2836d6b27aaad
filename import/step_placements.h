// Placements of a STEP file that scale or mirror. OpenCASCADE 7.6 silently makes rotations of them, so the
// importer writes a stand-in into the copy that it reads: a rotation that no file has, one for each different
// linear map. The importer recognises the map by its stand-in.
//
//  1. A map is the linear part of a similarity: scale · (rotation or mirrored rotation), by rows. Its
//     translation is kept as it is: the reader brings it into millimetres.
//  2. Stand-ins of different maps, and their inverses, differ by more than 1e-5 in some coefficient;
//     kMostLinearMaps bounds their number.
#pragma once

#include <array>
#include <cstddef>

namespace facetless {

using LinearMap = std::array<double, 9>;

constexpr std::size_t kMostLinearMaps = 4096;

// The rotation that stands for map number `index`.
LinearMap StandIn(std::size_t index);

LinearMap Product(const LinearMap& a, const LinearMap& b);
LinearMap Transposed(const LinearMap& a);
std::array<double, 3> Apply(const LinearMap& a, const std::array<double, 3>& v);

// True if the map is a rotation, to within rounding of the numbers in files.
bool IsRotation(const LinearMap& a);

}  // namespace facetless
