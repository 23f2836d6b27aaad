// The tessellated baseline: OpenCASCADE's mesher meshes the converted faces, and the result is written as
// glTF binary (mesh.h, laws 1 and 2).
//
//  1. There is one mesh per part, one primitive per face (extras: face = index within the part) and one node
//     per instance (extras: first_placed_face), in the model's order. Faces without triangles have no
//     primitive; the report names them.
//  2. Positions are in millimetres, Z up, relative to the translation of their node. The root node transforms
//     them to glTF's metres, Y up.
//  3. Normals at the nodes are those of the exact surface.
#pragma once

#include <string>
#include <vector>

#include "import/convert.h"
#include "render/base/result.h"

namespace facetless {

struct MeshOptions {
  double deflection_mm = 1;  // largest distance of a facet to the surface; must be above 0
  double angular_deg = 20;   // largest angle between the normals of neighbouring facets; must be above 0
};

struct MeshReport {
  double deflection_mm = 0, angular_deg = 0;
  double mesh_ms = 0;            // time of the mesher alone
  std::uint64_t peak_bytes = 0;  // peak memory of the mesher alone; 0: unknown (memory_gauge.h)
  std::uint64_t triangles = 0;   // triangles of all prototypes
  std::vector<std::string> faces_unmeshed;
};

// Removes earlier meshes, meshes all parts on one thread, and writes `path` completely or not at all. Errors:
// kBadUsage (an option is out of range), kWriteFailed.
Result<MeshReport> WriteMesh(Conversion& conversion, const MeshOptions& options, const std::string& path,
                             const Progress& progress);

}  // namespace facetless
