// Voxel samples: a terrain with buildings, as a .vxl file of Voxlap, and a scan of a head, as a NRRD file. Only sums, products
// and hashes of integers decide the voxels, so that they are the same on every machine.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace facetless::samples {

// Write terrain.vxl and head.nrrd into a folder, and return their entries of expected.json.
nlohmann::ordered_json WriteTerrain(const std::filesystem::path& folder);
nlohmann::ordered_json WriteHead(const std::filesystem::path& folder);

// The hash of a place: the same whole number, 0 … 2³² − 1, everywhere.
std::uint32_t PlaceHash(int x, int y, int z, std::uint32_t seed);

}  // namespace facetless::samples
