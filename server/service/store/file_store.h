// A Store in a data directory. Files are named by their SHA-256, and the database records what uses them
// (data_directory.h).
//
//  1. A file is written under a temporary name, synced and renamed, and its directory is synced, before a row
//     refers to it.
//  2. Open removes what a crash left behind: everything in tmp/, and files to which no row refers.
//  3. Times of use are written only periodically. After a crash, the deletion order may therefore be minutes
//     out of date.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/service/store/data_directory.h"
#include "server/service/store/store.h"

namespace facetless {

class FileStore : public Store {
 public:
  // Opens the store. `directory` must outlive it. Errors: kWriteFailed and the errors of the database.
  static Result<std::unique_ptr<FileStore>> Open(DataDirectory& directory, const StoreLimits& limits = {});
  ~FileStore() override;

  Result<TempDir> Scratch() override;
  Result<StoredFile> AddFile(const std::string& path, const std::string& sha256) override;
  std::optional<StoredFile> Pin(const std::string& sha256) override;
  Result<void> MakeRoom(std::uint64_t bytes) override;
  Result<void> MakeRoomFor(const std::string& owner, std::uint64_t quota, std::uint64_t bytes) override;
  Result<void> PutModel(const std::string& owner, const std::string& id, const std::string& name,
                        const nlohmann::json& report, const StoredFile& source,
                        const StoredFile& model) override;
  std::optional<StoredModel> FindModel(const std::string& owner, const std::string& id) override;
  std::vector<ListedModel> ListModels(const std::string& owner, const std::string& after,
                                      std::size_t limit) override;
  Result<Removal> RemoveModel(const std::string& owner, const std::string& id) override;
  Result<void> PutMesh(const std::string& owner, const std::string& id, const std::string& key,
                       const StoredFile& mesh) override;
  std::optional<std::string> FindMesh(const std::string& owner, const std::string& id,
                                      const std::string& key) override;
  Result<void> PutAnswer(const std::string& owner, const std::string& key, const std::string& text,
                         const std::vector<std::pair<std::string, StoredFile>>& artifacts) override;
  std::optional<std::string> FindAnswer(const std::string& owner, const std::string& key) override;
  std::optional<StoredArtifact> FindArtifact(const std::string& owner, const std::string& name) override;
  Result<void> Check() override;
  std::uint64_t StoredBytes() override;
  std::uint64_t FreeBytes() override;
  void Sweep() override;

 private:
  FileStore(DataDirectory& directory, const StoreLimits& limits) : directory_(directory), limits_(limits) {}

  Result<void> PutItem(const std::string& item, const std::string& record,
                       const std::vector<std::pair<std::string, StoredFile>>& files);
  std::optional<std::string> FindRecord(const std::string& item);
  std::optional<std::string> FindUse(const std::string& item, const std::string& role);
  void Touch(const std::string& item);
  void WriteTouches();
  std::shared_ptr<const void> MakePin(const std::string& sha256);
  void Unpin(const std::string& sha256);
  bool HasRow(const std::string& sha256);
  void RemoveLooseFiles();
  void RemoveUnnamedFiles();
  std::uint64_t OwnerBytes(const std::string& owner);
  bool DeleteLeastRecentlyUsed(double unused_since, const std::string& prefix = "");

  DataDirectory& directory_;
  const StoreLimits limits_;
  std::mutex files_mutex_;  // taken before the database, never inside a transaction
  std::map<std::string, int> pins_;
  std::mutex touches_mutex_;
  std::map<std::string, double> touches_;
};

}  // namespace facetless
