// Checks which voxel centres Voxelize puts inside closed solids, with two references that share no code with it: the solid
// classifier of OpenCASCADE, and the oracle in extended precision.
//
//  1. A centre is far if no face touches its voxel, and near otherwise.
//  2. The classifier is asked about random far centres: half of them anywhere, half of them beside a touched voxel. Where
//     it contradicts the voxels, the oracle decides which of the two is wrong.
//  3. The oracle is asked about random near centres: it counts the crossings above the centre, solid by solid.
//  4. A centre is undecided if the reference has no answer: the centre is on the border, or a crossing is in doubt.
#pragma once

#include <cstdint>
#include <string>

#include "render/base/result.h"

namespace facetless {

struct VoxelCheckOptions {
  int resolution = 256;       // voxels along the longest side
  int far = 2000, near = 50;  // centres
  std::uint32_t seed = 1;
};

struct VoxelCheckCount {
  std::uint64_t centres = 0, inside = 0;  // inside: whose voxels are filled
  std::uint64_t undecided = 0;
  std::uint64_t reference_wrong = 0;  // the oracle contradicts the classifier
  std::uint64_t wrong = 0;            // defects of the voxels
};

struct VoxelCheck {
  std::uint64_t solids = 0, filled = 0;
  std::uint32_t open_faces = 0;
  VoxelCheckCount far, near;
  std::string first_wrong;  // describes the first defect; empty without one
  double voxelize_ms = 0, far_ms = 0, near_ms = 0;
};

// Requires a file whose solids are closed: the classifier answers for closed solids only, and Voxelize fills no others.
// Errors: those of LoadBoth and of Voxelize; kNothingUsable (no closed solid).
Result<VoxelCheck> CheckVoxels(const std::string& path, const VoxelCheckOptions& options);

}  // namespace facetless
