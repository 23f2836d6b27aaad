// What the importer says of its work, in its answer on standard output.
//
//  1. The answer comes from a process that is not trusted. What is missing in it, or is of another kind, is as if it
//     were 0 or empty; names are as the file has them, and must be made printable where they are shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace facetless {

struct MesherReport {
  double mesh_ms = 0;                       // of the mesher alone
  std::uint64_t peak_bytes = 0;             // resident size while it worked
  std::vector<std::string> faces_unmeshed;  // names of the faces of which it made no triangle
};

struct ImportSummary {
  std::vector<MesherReport> meshes;  // in the order of ImportRequest::meshes, and as many
  double exact_ms = 0;               // of the exact intersector, for the rays that it answered
};

// Reads an answer to a request of so many meshes.
ImportSummary ReadImportSummary(const nlohmann::json& answer, std::size_t meshes);

}  // namespace facetless
