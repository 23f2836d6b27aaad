// The formats of voxel_file.h, one file each.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>

#include "render/voxel_files/file_bytes.h"
#include "render/voxel_files/voxel_file.h"

namespace facetless {

// NRRD ("Nearly Raw Raster Data", version 4): materials as 8-bit labels, x fastest, with spacing and origin in mm. The
// reader takes whole numbers and floating-point numbers of any width and byte order, as raw bytes, gzip or text.
VoxelFormat NrrdFormat();
// VTK's image data in XML: cell data `material` and `color`, appended as raw bytes. The reader takes the data of cells or of
// points, of any type of numbers and byte order, as text, base64 or appended bytes, compressed with zlib or not.
VoxelFormat VtiFormat();
// Plain voxels of 4 bytes (red, green, blue, material), x fastest, and a header beside them in NAME.raw.json.
VoxelFormat RawFormat();
// K. Silverman's columns with the colours of visible voxels, as Voxlap writes them; z runs downwards.
VoxelFormat VxlFormat();
// The octree of octree_model.h, versioned and with a checksum.
VoxelFormat OctFormat();

// Slices as the pages of a TIFF file, and as a folder of PNG or TIFF files, in the natural order of their names. A pixel with
// alpha 0 is empty; in pictures without alpha, one is empty if no channel is above the threshold. The pixel (i, j) of a slice
// across z is the voxel (x, y) = (i, j), so that y runs downwards. The axis and the grid are in a header: NAME.tif.json, or
// slices.json in the folder.
VoxelFormat TiffFormat();
VoxelFormat SliceFolderFormat();

// What every VTI file that is written has: the text before the arrays, the arrays `material` and `color`, and the end.
struct VtiArray {
  const char *name, *type;
  int components;
  std::uint64_t voxel_bytes;
};
inline constexpr VtiArray kVtiMaterial = {"material", "UInt8", 1, 1}, kVtiColor = {"color", "UInt8", 3, 3};
inline constexpr const char* kVtiEnd = "\n</AppendedData>\n</VTKFile>\n";
// Behind it, the bytes of each array follow, each behind its length in 64 bits. `scalars` is the array that viewers show.
std::string VtiBeginning(const VoxelGrid& grid, const char* scalars, std::span<const VtiArray> arrays);
// Errors: kCancelled, kWriteFailed.
Result<void> WriteVtiColors(const VoxelModel& model, const std::atomic<bool>* cancel, VoxelFileWriter* out);

// The error for a file that violates its format.
Error BrokenVoxelFile(const std::string& path, const std::string& what);
// Checks the sizes that a file claims. Error: kFormatBroken (a model cannot have these sizes).
Result<VoxelPoint> CheckVoxelSize(const std::string& path, std::int64_t x, std::int64_t y, std::int64_t z);
// The voxel of a number (voxel_file.h, law 4). `whole`: the type of the numbers has no fractions.
Voxel VoxelOfNumber(double number, bool whole, double threshold);
// Compares the size of a file that is to be written with the room on its disk. Error: kWriteFailed.
Result<void> CheckRoom(const std::string& path, double bytes);

}  // namespace facetless
