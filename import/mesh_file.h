// The tessellated baseline: OpenCASCADE's mesher over the converted faces, written as glTF binary (mesh.h,
// laws 1 and 2).
//
//  1. One mesh per part, one primitive per face (extras: face = index within the part), one node per instance
//     (extras: first_placed_face), in the model's order. Faces without triangles have no primitive and are
//     named.
//  2. Positions are millimetres, Z up, relative to their node's translation; the root node turns that into
//     glTF's metres, Y up.
//  3. Normals are the exact surface's at the nodes.
#pragma once

#include <string>
#include <vector>

#include "import/convert.h"
#include "render/base/result.h"

namespace facetless {

struct MeshOptions {
  double deflection_mm = 1;  // largest distance of a facet to the surface, > 0
  double angular_deg = 20;   // largest turn of the normal from facet to facet, > 0
};

struct MeshReport {
  double deflection_mm = 0, angular_deg = 0;
  double mesh_ms = 0;            // the mesher alone
  std::uint64_t peak_bytes = 0;  // what the mesher alone held at its fullest; 0: unknown (memory_gauge.h)
  std::uint64_t triangles = 0;   // of the prototypes
  std::vector<std::string> faces_unmeshed;
};

// Removes what was meshed before, meshes all parts on one thread, and writes `path` in full or not at all.
// Errors: kBadUsage (options out of range), kWriteFailed.
Result<MeshReport> WriteMesh(Conversion& conversion, const MeshOptions& options, const std::string& path,
                             const Progress& progress);

}  // namespace facetless
