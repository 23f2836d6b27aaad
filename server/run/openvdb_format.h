// The format .vdb among those of voxel files. Another program reads and writes it (server/importer/openvdb_process.h).
#pragma once

namespace facetless {

// Adds the format. Must be called once, before other threads use voxel files.
void AddOpenVdbFormat();

}  // namespace facetless
