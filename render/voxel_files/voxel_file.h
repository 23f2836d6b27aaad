// Files of voxels. The suffix of the name selects the format.
//
//     if (auto written = WriteVoxels("part.nrrd", *model, grid); !written) return written.error();
//     Result<VoxelFile> read = ReadVoxels("part.oct", max_bytes);
//
//  1. A file holds the voxels, their colours and materials, and the grid. VoxelFormat::loses says what of this the format
//     cannot hold; nothing else is lost.
//  2. Readers trust no file: if sizes, counts or offsets do not fit the file, the reader returns one error, which names the
//     file and what is wrong. Memory is allocated for a size that a file claims only after the size was compared with the
//     length of the file or with `max_bytes`.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "render/base/result.h"
#include "render/voxels/voxel_grid.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

struct VoxelFile {
  std::unique_ptr<VoxelModel> model;
  std::optional<VoxelGrid> grid;  // nothing: the format does not say where the voxels are
};

struct VoxelFormat {
  std::string_view suffix;  // ".nrrd"
  std::string_view name;    // "NRRD"
  std::string_view loses;   // what the format cannot hold, as a sentence; empty: nothing
  // Every format of VoxelFormats() has both functions. Errors of `write`: kWriteFailed, kBadUsage (the format cannot hold a
  // model of this size). Errors of `read`: kFileUnreadable, kFormatUnknown, kFormatBroken, kLimitExceeded.
  Result<void> (*write)(const std::string& path, const VoxelModel& model, const VoxelGrid& grid) = nullptr;
  Result<VoxelFile> (*read)(const std::string& path, std::uint64_t max_bytes) = nullptr;
};

std::span<const VoxelFormat> VoxelFormats();
// Error: kBadUsage (no format has the suffix of the path; the message lists the suffixes).
Result<const VoxelFormat*> VoxelFormatOf(const std::string& path);

// Errors: those of VoxelFormatOf, and those of VoxelFormat::write or VoxelFormat::read.
Result<void> WriteVoxels(const std::string& path, const VoxelModel& model, const VoxelGrid& grid);
Result<VoxelFile> ReadVoxels(const std::string& path, std::uint64_t max_bytes);

}  // namespace facetless
