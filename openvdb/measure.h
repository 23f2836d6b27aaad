// What OpenVDB makes of a tessellation, and how fast its rays are, for `facetless bench --openvdb`.
//
//  1. MESH has the tessellation in millimetres: the numbers of vertices and of triangles (64 bits each), three 32-bit
//     floating-point numbers for each vertex, three 32-bit indices for each triangle. RAYS has origins and directions in the
//     coordinates of the voxels: their number (64 bits), and six doubles for each ray, the direction of length 1.
//  2. The tessellation becomes a level set with meshToVolume, with OpenVDB's usual band of 3 voxels on either side and with
//     the narrowest band that it offers for closed surfaces (1 voxel), on all cores. A voxel is inside if its value is below 0.
//  3. The rays go through the voxels of the input as an active volume: VolumeRayIntersector finds the leaves and tiles, and
//     a DDA the first active voxel in them, as OpenVDB's documentation says. They also go through the level set of the
//     tessellation with LevelSetRayIntersector. One thread; the best of three passes counts.
//  4. OUT.oct has the voxels that are inside the level set, on the grid of the input; OUT.depths has where each ray enters
//     the first voxel of the volume, as doubles, or infinity.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "render/base/result.h"

namespace facetless {

// Errors: those of ReadVoxels and WriteVoxels; kFileUnreadable, kFormatBroken.
Result<nlohmann::json> Measure(const std::string& voxels, const std::string& mesh, const std::string& rays,
                               const std::string& out, std::uint64_t max_bytes);

}  // namespace facetless
