// What the service keeps in files: uploads, models with their meshes, answers with their pictures.
// The service knows this interface only; where and how things are kept is the implementation's business.
// What is to be done, and for whom, is the other half: job_store.h.
//
//  1. Everything is content-addressed or keyed by a digest of what made it, so nothing is ever overwritten by
//     something else: putting the same thing twice keeps the first, and two writers at once do no harm.
//  2. A thing is found whole or not at all, also after a crash. What a Put returned for is on the disk.
//  3. An owner finds what was put for that owner, and nothing else. "" is an owner like any other.
//  4. Where there are limits of size or age, models and answers that were not used for longest are given up,
//     but never what a waiting or running job needs.
//  5. Callers may pass anything as an identifier: what is not well-formed is not found.
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

// A file of the store. It stays on the disk at least as long as one copy of this lives; after that, what was
// put together with it keeps it.
struct KeptFile {
  std::string sha256, path;
  std::uint64_t bytes = 0;
  std::shared_ptr<const void> pin;
};

struct StoredModel {
  std::string id;    // SHA-256 of the uploaded bytes
  std::string name;  // file name as first uploaded, made safe
  std::uint64_t bytes = 0;
  nlohmann::json report;                // "model" of a report
  double import_ms = 0;                 // what the import took, by the report
  std::uint64_t import_peak_bytes = 0;  // 0: not known
  std::string source_path, model_path;  // files to read; never to change
};

// A model of a list.
struct ListedModel {
  std::string id, name;
  std::uint64_t bytes = 0;
  double created = 0;  // WallClock
};

enum class Removal {
  kRemoved,
  kNotThere,
  kNeeded,  // a job that waits or runs needs it
};

struct StoredArtifact {
  std::string path;
  std::uint64_t bytes = 0;
};

// What law 4 goes by.
struct StoreLimits {
  std::uint64_t max_bytes = 0;  // of all files together; 0: none
  double max_age_s = 0;         // since the last use; 0: none
};

class Store {
 public:
  virtual ~Store() = default;

  // An empty directory on the store's own disk, for uploads and results on their way in.
  virtual Result<TempDir> Scratch() = 0;

  // Moves a file from a Scratch in. `sha256` spares reading it; empty: it is computed. Errors: kWriteFailed.
  virtual Result<KeptFile> Keep(const std::string& path, const std::string& sha256) = 0;
  // A file that is in already; nothing if it is not.
  virtual std::optional<KeptFile> Pin(const std::string& sha256) = 0;
  // Gives up what law 4 allows until so many bytes more are within the limit. Error: kWriteFailed, if that is
  // not enough.
  virtual Result<void> MakeRoom(std::uint64_t bytes) = 0;
  // The same within the `quota` of one owner, from what is kept for that one.
  virtual Result<void> MakeRoomFor(const std::string& owner, std::uint64_t quota, std::uint64_t bytes) = 0;

  // Errors: kWriteFailed.
  virtual Result<void> PutModel(const std::string& owner, const std::string& id, const std::string& name,
                                const nlohmann::json& report, const KeptFile& source,
                                const KeptFile& model) = 0;
  virtual std::optional<StoredModel> FindModel(const std::string& owner, const std::string& id) = 0;

  // An owner's models by id, from the first one behind `after` on ("" is before all): at most `limit`.
  virtual std::vector<ListedModel> ListModels(const std::string& owner, const std::string& after,
                                              std::size_t limit) = 0;
  // Gives a model up with its meshes; answers about it stay. Error: kWriteFailed.
  virtual Result<Removal> RemoveModel(const std::string& owner, const std::string& id) = 0;

  // A mesh of a model that is there; `key` is a digest of how it was made.
  virtual Result<void> PutMesh(const std::string& owner, const std::string& id, const std::string& key,
                               const KeptFile& mesh) = 0;
  virtual std::optional<std::string> FindMesh(const std::string& owner, const std::string& id,
                                              const std::string& key) = 0;

  // The text of an answer and its files, each under its ArtifactName; `key` is a digest of the question.
  virtual Result<void> PutAnswer(const std::string& owner, const std::string& key, const std::string& text,
                                 const std::vector<std::pair<std::string, KeptFile>>& artifacts) = 0;
  virtual std::optional<std::string> FindAnswer(const std::string& owner, const std::string& key) = 0;
  virtual std::optional<StoredArtifact> FindArtifact(const std::string& owner, const std::string& name) = 0;

  // Returns OK if the store can accept writes. Error: kWriteFailed.
  virtual Result<void> Check() = 0;
  virtual std::uint64_t KeptBytes() = 0;  // of all files
  virtual std::uint64_t FreeBytes() = 0;  // of its disk, for us

  // Gives up what is over the limits, and files that nothing keeps any more. To be called now and then.
  virtual void Sweep() = 0;
};

// What a job needs (job_store.h) and what holds files: "<owner>/model/<id>", "<owner>/answer/<key>".
std::string ModelItem(const std::string& owner, const std::string& id);
std::string AnswerItem(const std::string& owner, const std::string& key);
// The id or key at the end of an item.
std::string KeyOfItem(const std::string& item);

// "<64 hexadecimal digits>.<extension of 1 to 8 lower-case letters and digits>".
bool IsArtifactName(const std::string& name);

// A file name with nothing in it but letters, digits and "._- ", not hidden, at most 100 bytes; "model" if
// nothing is left. UTF-8 outside ASCII is kept.
std::string SafeFileName(const std::string& name);

}  // namespace facetless
