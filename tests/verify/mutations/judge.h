// What becomes of a hostile file: through the importer, the mesh reader or a running service.
//
//  1. Every file must get an answer: files that can be read back, or one error with a code, a sentence and no
//     internal defect. What is neither is an offence.
//  2. A crash that the importer's process contained, and a limit that it met, are answers; they are counted
//     under their names.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace facetless {

struct Verdict {
  std::string status;   // "ok", or the error's code; of a service's answers with the HTTP status in front
  std::string message;  // of the error
  std::string offence;  // empty: none
  double wall_ms = 0;
};

struct JudgeLimits {
  double timeout_s = 60;
  unsigned memory_mb = 4096;
};

// The CAD file through RunImporter, its tessellation too, and both read back.
Verdict JudgeImport(const std::string& path, const JudgeLimits& limits);

// The mesh file through LoadMesh, in this process.
Verdict JudgeMesh(const std::string& path);

// By the file's name: a mesh for .glb and .stl, else CAD.
Verdict JudgeFile(const std::string& path, const JudgeLimits& limits);

// Posted to a service as a model or, with `options` (JSON), to be compared with them: 2xx, or a problem
// document with that status.
Verdict JudgePost(const std::string& host, int port, const std::string& file_name, const std::string& bytes,
                  const std::string& options, const JudgeLimits& limits);

// Files, a seed and a number, and what became of all mutants: {"mutants", "statuses", "offences", …}.
struct MutationRun {
  std::vector<std::string> files;
  std::uint64_t seed = 1, first = 0, count = 0;  // per file: indices first … first + count − 1
  JudgeLimits limits;
  std::string host;  // empty: no service
  int port = 0;
  std::string options;    // of a comparison that the service is to make; empty: it only stores the model
  int server_pid = 0;     // 0: unknown
  std::string offenders;  // where mutants go that offend or crash the importer; empty: nowhere
};
nlohmann::json RunMutations(const MutationRun& run);

}  // namespace facetless
