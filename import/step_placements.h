// Placements of a STEP file that scale or mirror. OpenCASCADE 7.6 silently converts them to rotations. The
// importer therefore writes a stand-in into the copy that OpenCASCADE reads: for each different linear map, a
// rotation that occurs in no real file. After the transfer, the importer recognises the map by its stand-in.
//
//  1. A map is the linear part of a similarity, stored by rows: scale · (rotation or mirrored rotation). The
//     translation of the placement stays in the file, so that OpenCASCADE converts it to millimetres.
//  2. Stand-ins of different maps, and their inverses, differ by more than 1e-5 in some coefficient;
//     kMostLinearMaps bounds their number.
#pragma once

#include <array>
#include <cstddef>

namespace facetless {

using LinearMap = std::array<double, 9>;

constexpr std::size_t kMostLinearMaps = 4096;

// Returns the rotation that represents map number `index`.
LinearMap StandIn(std::size_t index);

LinearMap Product(const LinearMap& a, const LinearMap& b);
LinearMap Transposed(const LinearMap& a);
std::array<double, 3> Apply(const LinearMap& a, const std::array<double, 3>& v);

// Returns whether the map is a rotation, to within the rounding of numbers in files.
bool IsRotation(const LinearMap& a);

}  // namespace facetless
