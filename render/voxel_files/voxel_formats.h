// The formats of voxel_file.h, one file each.
#pragma once

#include "render/voxel_files/voxel_file.h"

namespace facetless {

// NRRD ("Nearly Raw Raster Data", version 4): materials as 8-bit labels, x fastest, with spacing and origin in mm. The
// reader takes 8- and 16-bit integers and floats without compression; a voxel is filled if its value is above 0.
VoxelFormat NrrdFormat();
// VTK's image data in XML: cell data `material` and `color`, appended as raw bytes. The reader takes files of this form.
VoxelFormat VtiFormat();
// Plain voxels of 4 bytes (red, green, blue, material), x fastest, and a header beside them in NAME.raw.json.
VoxelFormat RawFormat();
// K. Silverman's columns with the colours of visible voxels, as Voxlap writes them; z runs downwards.
VoxelFormat VxlFormat();
// The octree of octree_model.h, versioned and with a checksum.
VoxelFormat OctFormat();

// The error for a file that violates its format.
Error BrokenVoxelFile(const std::string& path, const std::string& what);
// Checks the sizes that a file claims. `bytes_per_voxel`: what the reader needs for each voxel. Errors: kFormatBroken (a
// model cannot have these sizes), kLimitExceeded (the voxels need more than `max_bytes`).
Result<VoxelPoint> CheckVoxelSize(const std::string& path, std::int64_t x, std::int64_t y, std::int64_t z,
                                  double bytes_per_voxel, std::uint64_t max_bytes);

}  // namespace facetless
