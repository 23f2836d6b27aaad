// The store: the files that the service keeps, which are uploads, models with their meshes, and answers with
// their pictures. The service uses only this interface; the implementation decides where and how files are
// stored. The jobs are in the job store (job_store.h).
//
//     Result<StoredFile> file = store.AddFile(path, /*sha256=*/"");
//     if (!file) return file.error();
//     Result<void> stored = store.PutMesh(owner, model_id, key, file.value());
//
//  1. Everything is addressed by its content, or by a digest of what determines it, so nothing is ever
//     overwritten by something different. Putting the same thing twice keeps the first copy, and concurrent
//     writers do no harm.
//  2. A thing is found completely or not at all, even after a crash. When a Put function returns, its data is
//     on the disk.
//  3. An owner finds only what was put for that owner. "" is an owner like any other.
//  4. If there are limits of size or age, the models and answers that were least recently used are deleted,
//     but never those that a waiting or running job needs.
//  5. Callers may pass any text as an identifier. A malformed identifier is not found.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/base/temp_dir.h"

namespace facetless {

// A file of the store. It stays on the disk at least as long as a copy of this object exists. After that, it
// stays as long as a model or an answer refers to it.
struct StoredFile {
  std::string sha256, path;
  std::uint64_t bytes = 0;
  std::shared_ptr<const void> pin;
};

struct StoredModel {
  std::string id;    // SHA-256 of the uploaded bytes
  std::string name;  // file name of the first upload, sanitized
  std::uint64_t bytes = 0;
  nlohmann::json report;                // "model" of a report
  double import_ms = 0;                 // what the import took, by the report
  std::uint64_t import_peak_bytes = 0;  // 0: not known
  std::string source_path, model_path;  // files to read; never to change
};

// A model in a list.
struct ListedModel {
  std::string id, name;
  std::uint64_t bytes = 0;
  double created = 0;  // WallClock
};

enum class Removal {
  kRemoved,
  kNotThere,
  kNeeded,  // a waiting or running job needs the model
};

struct StoredArtifact {
  std::string path;
  std::uint64_t bytes = 0;
};

// The limits of law 4.
struct StoreLimits {
  std::uint64_t max_bytes = 0;  // total size of all files; 0: no limit
  double max_age_s = 0;         // time since the last use, seconds; 0: no limit
};

class Store {
 public:
  virtual ~Store() = default;

  // Creates an empty directory on the disk of the store, for uploads and results that will be stored.
  virtual Result<TempDir> Scratch() = 0;

  // Moves a file from a Scratch directory to the store. `sha256` is its digest; if it is empty, it is
  // computed from the file. Errors: kWriteFailed.
  virtual Result<StoredFile> AddFile(const std::string& path, const std::string& sha256) = 0;
  // A file that is already in the store; nothing if it is not.
  virtual std::optional<StoredFile> Pin(const std::string& sha256) = 0;
  // Deletes what law 4 allows until `bytes` more bytes are within the limit. Error: kWriteFailed (there is
  // not enough to delete).
  virtual Result<void> MakeRoom(std::uint64_t bytes) = 0;
  // The same for the `quota` of one owner; deletes only what is kept for that owner.
  virtual Result<void> MakeRoomFor(const std::string& owner, std::uint64_t quota, std::uint64_t bytes) = 0;

  // Errors: kWriteFailed.
  virtual Result<void> PutModel(const std::string& owner, const std::string& id, const std::string& name,
                                const nlohmann::json& report, const StoredFile& source,
                                const StoredFile& model) = 0;
  virtual std::optional<StoredModel> FindModel(const std::string& owner, const std::string& id) = 0;

  // At most `limit` models of an owner, ordered by id, starting with the first id after `after` ("" starts at
  // the beginning).
  virtual std::vector<ListedModel> ListModels(const std::string& owner, const std::string& after,
                                              std::size_t limit) = 0;
  // Deletes a model with its meshes. Answers about it stay. Error: kWriteFailed.
  virtual Result<Removal> RemoveModel(const std::string& owner, const std::string& id) = 0;

  // Stores a mesh of a stored model. `key` is a digest of how the mesh was made.
  virtual Result<void> PutMesh(const std::string& owner, const std::string& id, const std::string& key,
                               const StoredFile& mesh) = 0;
  virtual std::optional<std::string> FindMesh(const std::string& owner, const std::string& id,
                                              const std::string& key) = 0;

  // Stores the text of an answer and its files, each under its artifact name. `key` is a digest of the
  // question.
  virtual Result<void> PutAnswer(const std::string& owner, const std::string& key, const std::string& text,
                                 const std::vector<std::pair<std::string, StoredFile>>& artifacts) = 0;
  virtual std::optional<std::string> FindAnswer(const std::string& owner, const std::string& key) = 0;
  virtual std::optional<StoredArtifact> FindArtifact(const std::string& owner, const std::string& name) = 0;

  // Succeeds if the store can accept writes. Error: kWriteFailed.
  virtual Result<void> Check() = 0;
  virtual std::uint64_t StoredBytes() = 0;  // total size of all files
  virtual std::uint64_t FreeBytes() = 0;    // free space on its disk that the service may use

  // Deletes what exceeds the limits, and files to which nothing refers any more. It must be called
  // periodically.
  virtual void Sweep() = 0;
};

// The names of items: "<owner>/model/<id>", "<owner>/answer/<key>". Items refer to files, and jobs need items
// (job_store.h).
std::string ModelItem(const std::string& owner, const std::string& id);
std::string AnswerItem(const std::string& owner, const std::string& key);
// The id or key at the end of an item.
std::string KeyOfItem(const std::string& item);

// Returns whether the name has the form "<64 hexadecimal digits>.<extension of 1 to 8 lower-case letters and
// digits>".
bool IsArtifactName(const std::string& name);

// A sanitized file name: it contains only letters, digits, "._- " and non-ASCII UTF-8 characters, is not
// hidden, and has at most 100 bytes. The result is "model" if nothing remains.
std::string SafeFileName(const std::string& name);

}  // namespace facetless
