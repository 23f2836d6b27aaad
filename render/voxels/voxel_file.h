// Files of voxels, by the suffix of their names.
//
//     if (auto written = WriteVoxels("part.nrrd", *model, grid); !written) return written.error();
//     Result<VoxelFile> read = ReadVoxels("part.oct", max_bytes);
//
//  1. A file holds the voxels, their colours and materials as far as the format can (VoxelFormat::keeps), and where they
//     are, if the format can say it. A format that cannot says so in `loses`; nothing else is lost.
//  2. Files of others are checked before they are used: sizes, counts and offsets that do not fit the file are one error,
//     which names the file and what is wrong. No size that a file claims is allocated before it is compared with the file's
//     length and with `max_bytes`.
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
  // Null if the format cannot be written, or read. Errors: kWriteFailed; kUnreadable, kFormatBroken, kLimitExceeded.
  Result<void> (*write)(const std::string& path, const VoxelModel& model, const VoxelGrid& grid) = nullptr;
  Result<VoxelFile> (*read)(const std::string& path, std::uint64_t max_bytes) = nullptr;
};

std::span<const VoxelFormat> VoxelFormats();
// Error: kBadUsage (no format has the suffix of the path; the message lists the suffixes).
Result<const VoxelFormat*> VoxelFormatOf(const std::string& path);

// Errors: those of VoxelFormatOf, of VoxelFormat::write and VoxelFormat::read; kBadUsage (the format cannot be written, or
// read).
Result<void> WriteVoxels(const std::string& path, const VoxelModel& model, const VoxelGrid& grid);
Result<VoxelFile> ReadVoxels(const std::string& path, std::uint64_t max_bytes);

}  // namespace facetless
