// A Store in a directory.
//
//   DIR/models/<id>/{source/<name>, model.flm, record.json, mesh-<key>.glb}     DIR/results/<key>.json
//   DIR/artifacts/<first two digits>/<sha256>.<extension>                       DIR/tmp/
//
//  1. One process owns a directory at a time: Open takes a lock, and empties tmp/ of what a crash left
//     behind.
//  2. Nothing is removed by itself; delete the directory, or its models/ and results/, to make room.
#pragma once

#include <memory>
#include <string>

#include "server/service/store.h"

namespace facetless {

class FileStore : public Store {
 public:
  // Makes the directory if it is absent. Errors: kWriteFailed; kBadUsage (another process owns it).
  static Result<std::unique_ptr<FileStore>> Open(const std::string& directory);
  ~FileStore() override;

  Result<TempDir> Scratch() override;
  Result<StoredModel> PutModel(const std::string& id, const std::string& name, const nlohmann::json& report,
                               const std::string& source_path, const std::string& model_path) override;
  std::optional<StoredModel> FindModel(const std::string& id) override;
  Result<std::string> PutMesh(const std::string& id, const std::string& key,
                              const std::string& path) override;
  std::optional<std::string> FindMesh(const std::string& id, const std::string& key) override;
  Result<void> PutResult(const std::string& key, const nlohmann::json& result) override;
  std::optional<nlohmann::json> FindResult(const std::string& key) override;
  Result<std::string> PutArtifact(const std::string& path, const std::string& extension) override;
  std::optional<StoredArtifact> FindArtifact(const std::string& name) override;

 private:
  FileStore(std::string directory, int lock) : directory_(std::move(directory)), lock_(lock) {}

  const std::string directory_;
  const int lock_;  // a file descriptor
};

}  // namespace facetless
