// The importer's report of its work, from its answer on standard output.
//
//  1. The answer comes from a process that is not trusted. A value that is missing, or of another type, is
//     read as 0 or empty. Names are those of the file, and must be made printable before they are shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace facetless {

struct MesherReport {
  double mesh_ms = 0;                       // time of the mesher alone
  std::uint64_t peak_bytes = 0;             // peak resident size of the mesher
  std::vector<std::string> faces_unmeshed;  // names of the faces without a triangle
};

struct ImportSummary {
  std::vector<MesherReport> meshes;  // one for each of ImportRequest::meshes, in their order
  double exact_ms = 0;               // time of the exact intersector for the rays that it answered
};

// Reads the answer to a request with the given number of meshes.
ImportSummary ReadImportSummary(const nlohmann::json& answer, std::size_t meshes);

}  // namespace facetless
