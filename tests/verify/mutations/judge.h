// Judges what happens to a hostile file in the importer, the mesh reader or a running service.
//
//  1. Every file must get an answer: files that can be read back, or one error with a code and a sentence
//     that is no internal defect. Anything else is an offence.
//  2. A crash that stays within the importer's process, and a limit that it reaches, are answers. They are
//     counted by name.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace facetless {

struct Verdict {
  std::string status;   // "ok", or the error's code; for answers of a service, after the HTTP status
  std::string message;  // of the error
  std::string offence;  // empty: none
  double wall_ms = 0;
};

struct JudgeLimits {
  double timeout_s = 60;
  unsigned memory_mb = 4096;
};

// Imports the CAD file with RunImporter, with a tessellation, and reads both results back.
Verdict JudgeImport(const std::string& path, const JudgeLimits& limits);

// Reads the mesh file with LoadMesh, in this process.
Verdict JudgeMesh(const std::string& path);

// Chooses by the file's name: a mesh for .glb and .stl, otherwise a CAD file.
Verdict JudgeFile(const std::string& path, const JudgeLimits& limits);

// Posts the file to a service as a model or, with `options` (JSON), as a comparison. The answer must be 2xx,
// or a problem document with that status.
Verdict JudgePost(const std::string& host, int port, const std::string& file_name, const std::string& bytes,
                  const std::string& options, const JudgeLimits& limits);

// A run over files with a seed and a count, and the results of all mutants: {"mutants", "statuses",
// "offences", …}.
struct MutationRun {
  std::vector<std::string> files;
  std::uint64_t seed = 1, first = 0, count = 0;  // for each file, indices first … first + count − 1
  JudgeLimits limits;
  std::string host;  // empty: no service
  int port = 0;
  std::string options;    // options of the comparison; empty: the service only stores the model
  int server_pid = 0;     // 0: unknown
  std::string offenders;  // folder for mutants that offend or crash the importer; empty: none
};
nlohmann::json RunMutations(const MutationRun& run);

}  // namespace facetless
