// What the service keeps: uploaded files with their models, meshes made from them, results, and artifacts.
// The service knows this interface only; where and how things are kept is the implementation's business.
//
//  1. Everything is content-addressed or keyed by a digest of what made it, so nothing is ever overwritten by
//     something else: putting the same thing twice is free, and two writers at once do no harm.
//  2. A thing is found whole or not at all, also after a crash.
//  3. Callers must pass identifiers that are well-formed: IsSha256Hex, IsArtifactName. Others are not found.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "render/model/result.h"
#include "server/temp_dir.h"

namespace facetless {

struct StoredModel {
  std::string id;    // SHA-256 of the uploaded bytes
  std::string name;  // file name as first uploaded, made safe
  std::uint64_t bytes = 0;
  nlohmann::json report;                // "model" of a report
  std::string source_path, model_path;  // files to read; never to change
};

struct StoredArtifact {
  std::string path;
  std::uint64_t bytes = 0;
};

class Store {
 public:
  virtual ~Store() = default;

  // An empty directory on the store's own disk, for uploads and results on their way in.
  virtual Result<TempDir> Scratch() = 0;

  // Takes the two files over (they are moved). Errors: kWriteFailed.
  virtual Result<StoredModel> PutModel(const std::string& id, const std::string& name,
                                       const nlohmann::json& report, const std::string& source_path,
                                       const std::string& model_path) = 0;
  virtual std::optional<StoredModel> FindModel(const std::string& id) = 0;

  // A mesh of a model; `key` is a digest of how it was made. The file is moved.
  virtual Result<std::string> PutMesh(const std::string& id, const std::string& key,
                                      const std::string& path) = 0;
  virtual std::optional<std::string> FindMesh(const std::string& id, const std::string& key) = 0;

  // A request's answer; `key` is a digest of the request.
  virtual Result<void> PutResult(const std::string& key, const nlohmann::json& result) = 0;
  virtual std::optional<nlohmann::json> FindResult(const std::string& key) = 0;

  // Moves the file in and returns its name: "<sha256>.<extension>".
  virtual Result<std::string> PutArtifact(const std::string& path, const std::string& extension) = 0;
  virtual std::optional<StoredArtifact> FindArtifact(const std::string& name) = 0;
};

// "<64 hexadecimal digits>.<extension of 1 to 8 lower-case letters and digits>".
bool IsArtifactName(const std::string& name);

// A file name with nothing in it but letters, digits and "._- ", not hidden, at most 100 bytes; "model" if
// nothing is left. UTF-8 outside ASCII is kept.
std::string SafeFileName(const std::string& name);

}  // namespace facetless
