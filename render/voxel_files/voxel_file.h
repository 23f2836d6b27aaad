// Files of voxels. The suffix of the name selects the format; a folder holds slices.
//
//     if (auto written = WriteVoxels("part.nrrd", *model, grid); !written) return written.error();
//     Result<VoxelFile> read = ReadVoxels("part.oct", max_bytes);
//
//  1. A file holds the voxels, their colours and materials, and the grid. VoxelFormat::loses says what of this the format
//     cannot hold; nothing else is lost.
//  2. Readers trust no file: if sizes, counts or offsets do not fit the file, the reader returns one error, which names the
//     file and what is wrong. Memory is allocated for a size that a file claims only after the size was compared with the
//     length of the file or with `max_bytes`.
//  3. A file is written completely or not at all, and so is a folder.
//  4. Files of other programs hold numbers: a voxel is filled if its number is above `threshold`. It has the number as its
//     material if that is whole and at most 255, and the material 1 otherwise.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/result.h"
#include "render/voxels/voxel_grid.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

struct VoxelFile {
  std::unique_ptr<VoxelModel> model;
  std::optional<VoxelGrid> grid;           // nothing: the format does not say where the voxels are
  std::vector<std::string> warnings = {};  // sentences: what the file says, but voxels cannot hold
};

struct VoxelFileOptions {
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // of memory, for reading
  double threshold = 0;                              // law 4
  // The axis (0, 1, 2) across which slices lie that are written, or that are read without a header beside them. Nothing: z.
  // A header names the axis of its slices.
  std::optional<int> slice_axis = std::nullopt;
  const std::atomic<bool>* cancel = nullptr;  // polled by slices if not null
};

struct VoxelFormat {
  std::string_view suffix;  // ".nrrd"; "/": a folder
  std::string_view name;    // "NRRD"
  std::string_view loses;   // what the format cannot hold, as a sentence; empty: nothing
  // Every format of VoxelFormats() has both functions.
  Result<void> (*write_file)(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                             const VoxelFileOptions& options) = nullptr;
  Result<VoxelFile> (*read_file)(const std::string& path, const VoxelFileOptions& options) = nullptr;
  std::string_view other_suffix = {};  // ".tiff"

  // Errors: kWriteFailed, kCancelled, kBadUsage (the format cannot hold a model of this size; a folder is not empty).
  Result<void> write(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                     const VoxelFileOptions& options = {}) const {
    return write_file(path, model, grid, options);
  }
  // Errors: kFileUnreadable, kFormatUnknown, kFormatBroken, kSizeMismatch (slices), kLimitExceeded, kCancelled.
  Result<VoxelFile> read(const std::string& path, const VoxelFileOptions& options) const {
    return read_file(path, options);
  }
};

std::span<const VoxelFormat> VoxelFormats();
// Adds a format that another program reads and writes. Must be called before other threads use this header.
void AddVoxelFormat(const VoxelFormat& format);
// A path has the format of its suffix; one that ends with a slash, or is a folder, has that of folders. Error: kBadUsage (no
// format has the suffix; the message lists the suffixes).
Result<const VoxelFormat*> VoxelFormatOf(const std::string& path);
// The suffixes of all formats, for messages: ".oct, .vxl, …, or a folder, whose name ends with /".
std::string VoxelSuffixes();

// Errors: those of VoxelFormatOf, and those of VoxelFormat::write or VoxelFormat::read.
Result<void> WriteVoxels(const std::string& path, const VoxelModel& model, const VoxelGrid& grid,
                         const VoxelFileOptions& options = {});
Result<VoxelFile> ReadVoxels(const std::string& path, const VoxelFileOptions& options);
inline Result<VoxelFile> ReadVoxels(const std::string& path, std::uint64_t max_bytes) {
  return ReadVoxels(path, VoxelFileOptions{.max_bytes = max_bytes});
}

}  // namespace facetless
