#include "server/service/store/file_store.h"

#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "server/base/files.h"
#include "server/base/sha256.h"
#include "server/service/store/durable_file.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<std::pair<std::string, StoredFile>>;

std::uint64_t FileBytes(const std::string& path) {
  std::error_code error;
  const std::uint64_t bytes = fs::file_size(path, error);
  return error ? 0 : bytes;
}

// Inserts the rows of a file and of its use. Requires a transaction.
Result<void> InsertUse(Database& database, const std::string& holder, const std::string& role,
                       const StoredFile& file) {
  if (auto put = database.Run("INSERT OR IGNORE INTO files VALUES(?, ?)",
                              {file.sha256, static_cast<std::int64_t>(file.bytes)});
      !put)
    return put.error();
  if (auto put = database.Run("INSERT OR IGNORE INTO uses VALUES(?, ?, ?)", {holder, role, file.sha256});
      !put)
    return put.error();
  return {};
}

}  // namespace

std::string ModelItem(const std::string& owner, const std::string& id) {
  return owner + "/model/" + id;
}
std::string AnswerItem(const std::string& owner, const std::string& key) {
  return owner + "/answer/" + key;
}

std::string KeyOfItem(const std::string& item) {
  return item.substr(item.rfind('/') + 1);
}

bool IsArtifactName(const std::string& name) {
  if (name.size() < 66 || name.size() > 73 || name[64] != '.' || !IsSha256Hex(name.substr(0, 64)))
    return false;
  return std::all_of(name.begin() + 65, name.end(),
                     [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); });
}

std::string SafeFileName(const std::string& name) {
  constexpr std::size_t kMaxBytes = 100;
  const std::size_t slash = name.find_last_of("/\\");
  std::string safe;
  for (const char c : slash == std::string::npos ? name : name.substr(slash + 1)) {
    const auto byte = static_cast<unsigned char>(c);
    safe += byte >= 0x80 || std::isalnum(byte) != 0 || std::strchr("._- ", c) != nullptr ? c : '_';
  }
  safe.erase(0, safe.find_first_not_of(". "));
  // AddFile the end, which has the extension, and do not split a UTF-8 sequence.
  if (safe.size() > kMaxBytes) safe.erase(0, safe.size() - kMaxBytes);
  while (!safe.empty() && (static_cast<unsigned char>(safe[0]) & 0xc0) == 0x80) safe.erase(0, 1);
  return safe.empty() ? "model" : safe;
}

Result<std::unique_ptr<FileStore>> FileStore::Open(DataDirectory& directory, const StoreLimits& limits) {
  std::unique_ptr<FileStore> store(new FileStore(directory, limits));
  std::error_code ignored;
  for (const auto& leftover : fs::directory_iterator(directory.TemporaryPath(), ignored))
    fs::remove_all(leftover, ignored);
  store->RemoveLooseFiles();
  store->RemoveUnnamedFiles();
  return store;
}

FileStore::~FileStore() {
  WriteTouches();
  RemoveLooseFiles();
}

Result<TempDir> FileStore::Scratch() {
  return TempDir::Create(directory_.TemporaryPath());
}

// ---- Files ----

Result<StoredFile> FileStore::AddFile(const std::string& path, const std::string& sha256) {
  StoredFile kept;
  kept.sha256 = sha256;
  if (sha256.empty()) {
    auto digest = Sha256OfFile(path);
    if (!digest) return digest.error();
    kept.sha256 = std::move(digest).value();
  }
  kept.path = directory_.FilePath(kept.sha256);
  kept.bytes = FileBytes(path);
  // Sync before the lock is taken, because it takes long.
  if (auto synced = SyncFile(path); !synced) return synced.error();
  if (auto made = MakeDirectories(fs::path(kept.path).parent_path()); !made) return made.error();
  {
    const std::lock_guard lock(files_mutex_);
    std::error_code error;
    if (fs::exists(kept.path, error)) {
      fs::remove(path, error);
    } else if (auto renamed = RenameReadOnly(path, kept.path); !renamed) {
      return renamed.error();
    }
    kept.pin = MakePin(kept.sha256);
  }
  // Sync the name without the lock, so that files that are added at the same time share one write of the disk. A
  // file that exists may have been added by another thread, which has not synced its name yet.
  if (auto synced = SyncDirectory(fs::path(kept.path).parent_path()); !synced) return synced.error();
  return kept;
}

std::optional<StoredFile> FileStore::Pin(const std::string& sha256) {
  if (!IsSha256Hex(sha256)) return std::nullopt;
  const std::lock_guard lock(files_mutex_);
  StoredFile kept;
  kept.sha256 = sha256;
  kept.path = directory_.FilePath(sha256);
  std::error_code error;
  kept.bytes = fs::file_size(kept.path, error);
  if (error) return std::nullopt;
  kept.pin = MakePin(sha256);
  return kept;
}

std::shared_ptr<const void> FileStore::MakePin(const std::string& sha256) {
  ++pins_[sha256];
  return {&pins_, [this, sha256](const void*) { Unpin(sha256); }};
}

void FileStore::Unpin(const std::string& sha256) {
  const std::lock_guard lock(files_mutex_);
  if (--pins_[sha256] > 0) return;
  pins_.erase(sha256);
  // A file that has no row now belongs to nothing.
  if (!HasRow(sha256)) unlink(directory_.FilePath(sha256).c_str());
}

bool FileStore::HasRow(const std::string& sha256) {
  // If the query fails, keep the file. The next start removes it if no row refers to it.
  bool found = false;
  const auto asked = directory_.writer().Query("SELECT 1 FROM files WHERE sha256 = ?", {sha256},
                                               [&](const SqlRow&) { found = true; });
  return found || !asked;
}

void FileStore::RemoveLooseFiles() {
  const std::lock_guard lock(files_mutex_);
  Database& database = directory_.writer();
  std::vector<std::string> loose, gone;
  (void)database.Query("SELECT file FROM loose", {},
                       [&](const SqlRow& row) { loose.push_back(row.Text(0)); });
  if (loose.empty()) return;
  {
    Transaction transaction(database);
    if (!transaction.begun()) return;
    for (const std::string& file : loose) {
      if (pins_.contains(file)) continue;
      auto removed = database.Run(
          "DELETE FROM files WHERE sha256 = ?1 AND NOT EXISTS (SELECT 1 FROM uses WHERE file = ?1)", {file});
      if (!removed || !database.Run("DELETE FROM loose WHERE file = ?", {file})) return;
      if (removed.value() > 0) gone.push_back(file);
    }
    if (!transaction.Commit()) return;
  }
  for (const std::string& file : gone) unlink(directory_.FilePath(file).c_str());
}

void FileStore::RemoveUnnamedFiles() {
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(directory_.path() + "/files", error)) {
    if (entry.is_regular_file(error) && !HasRow(entry.path().filename())) fs::remove(entry.path(), error);
  }
}

// ---- Items ----

Result<void> FileStore::PutItem(const std::string& item, const std::string& record, const Files& files) {
  std::uint64_t bytes = 0;
  for (const auto& [role, file] : files) {
    if (!HasRow(file.sha256)) bytes += file.bytes;
  }
  if (auto room = MakeRoom(bytes); !room) return room;
  Database& database = directory_.writer();
  Transaction transaction(database);
  if (!transaction.begun()) return transaction.begun();
  const double now = WallClock();
  auto put = database.Run("INSERT OR IGNORE INTO items VALUES(?, ?, ?, ?)", {item, record, now, now});
  if (!put) return put.error();
  // If the item exists already, its files are equivalent.
  if (put.value() == 0) return {};
  for (const auto& [role, file] : files) {
    if (auto used = InsertUse(database, item, role, file); !used) return used;
  }
  return transaction.Commit();
}

std::optional<std::string> FileStore::FindRecord(const std::string& item) {
  std::optional<std::string> record;
  (void)directory_.reader().Query("SELECT record FROM items WHERE id = ?", {item},
                                  [&](const SqlRow& row) { record = row.Text(0); });
  if (record) Touch(item);
  return record;
}

std::optional<std::string> FileStore::FindUse(const std::string& item, const std::string& role) {
  std::optional<std::string> file;
  (void)directory_.reader().Query("SELECT file FROM uses WHERE holder = ? AND role = ?", {item, role},
                                  [&](const SqlRow& row) { file = row.Text(0); });
  return file;
}

Result<void> FileStore::PutModel(const std::string& owner, const std::string& id, const std::string& name,
                                 const nlohmann::json& report, const StoredFile& source,
                                 const StoredFile& model) {
  const nlohmann::json record = {{"name", name}, {"bytes", source.bytes}, {"report", report}};
  return PutItem(ModelItem(owner, id), JsonText(record, -1), {{"source", source}, {"model", model}});
}

std::optional<StoredModel> FileStore::FindModel(const std::string& owner, const std::string& id) {
  if (!IsSha256Hex(id)) return std::nullopt;
  const std::string item = ModelItem(owner, id);
  const auto text = FindRecord(item);
  const auto source = FindUse(item, "source"), model_file = FindUse(item, "model");
  if (!text || !source || !model_file) return std::nullopt;
  const nlohmann::json record = nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (!record.is_object() || !record.contains("report")) return std::nullopt;
  StoredModel model;
  model.id = id;
  model.name = record.value("name", "");
  model.bytes = record.value("bytes", std::uint64_t{0});
  model.report = record["report"];
  if (!model.report.is_object()) return std::nullopt;
  model.import_ms = model.report.value("import_ms", 0.0);
  model.import_peak_bytes = model.report.value("import_peak_bytes", std::uint64_t{0});
  model.source_path = directory_.FilePath(*source);
  model.model_path = directory_.FilePath(*model_file);
  return model;
}

std::vector<ListedModel> FileStore::ListModels(const std::string& owner, const std::string& after,
                                               std::size_t limit) {
  const std::string prefix = ModelItem(owner, "");
  // The prefix ends with '/', and '0' is the next character.
  const std::string end = prefix.substr(0, prefix.size() - 1) + "0";
  std::vector<ListedModel> models;
  (void)directory_.reader().Query(
      "SELECT id, record, created FROM items WHERE id > ? AND id < ? ORDER BY id LIMIT ?",
      {prefix + after, end, static_cast<std::int64_t>(limit)}, [&](const SqlRow& row) {
        const nlohmann::json record = nlohmann::json::parse(row.Text(1), nullptr, /*allow_exceptions=*/false);
        if (!record.is_object()) return;
        models.push_back({row.Text(0).substr(prefix.size()), record.value("name", ""),
                          record.value("bytes", std::uint64_t{0}), row.Real(2)});
      });
  return models;
}

Result<Removal> FileStore::RemoveModel(const std::string& owner, const std::string& id) {
  if (!IsSha256Hex(id)) return Removal::kNotThere;
  const std::string item = ModelItem(owner, id);
  {
    Database& database = directory_.writer();
    Transaction transaction(database);
    if (!transaction.begun()) return transaction.begun().error();
    bool needed = false;
    if (auto asked = database.Query("SELECT 1 FROM needs WHERE item = ? LIMIT 1", {item},
                                    [&](const SqlRow&) { needed = true; });
        !asked)
      return asked.error();
    if (needed) return Removal::kNeeded;
    const auto removed = database.Run("DELETE FROM items WHERE id = ?", {item});
    if (!removed) return removed.error();
    if (removed.value() == 0) return Removal::kNotThere;
    if (auto unused = database.Run("DELETE FROM uses WHERE holder = ?", {item}); !unused)
      return unused.error();
    if (auto committed = transaction.Commit(); !committed) return committed.error();
  }
  RemoveLooseFiles();
  return Removal::kRemoved;
}

Result<void> FileStore::PutMesh(const std::string& owner, const std::string& id, const std::string& key,
                                const StoredFile& mesh) {
  if (auto room = MakeRoom(mesh.bytes); !room) return room;
  Database& database = directory_.writer();
  Transaction transaction(database);
  if (!transaction.begun()) return transaction.begun();
  const std::string item = ModelItem(owner, id);
  // A mesh is deleted with its model.
  bool known = false;
  auto asked =
      database.Query("SELECT 1 FROM items WHERE id = ?", {item}, [&](const SqlRow&) { known = true; });
  if (!asked) return asked;
  if (!known) return Error{ErrorCode::kInternal, "the model " + id + " no longer exists"};
  if (auto used = InsertUse(database, item, "mesh-" + key, mesh); !used) return used;
  return transaction.Commit();
}

std::optional<std::string> FileStore::FindMesh(const std::string& owner, const std::string& id,
                                               const std::string& key) {
  if (!IsSha256Hex(id) || !IsSha256Hex(key)) return std::nullopt;
  const auto file = FindUse(ModelItem(owner, id), "mesh-" + key);
  if (!file) return std::nullopt;
  return directory_.FilePath(*file);
}

Result<void> FileStore::PutAnswer(const std::string& owner, const std::string& key, const std::string& text,
                                  const Files& artifacts) {
  return PutItem(AnswerItem(owner, key), text, artifacts);
}

std::optional<std::string> FileStore::FindAnswer(const std::string& owner, const std::string& key) {
  if (!IsSha256Hex(key)) return std::nullopt;
  return FindRecord(AnswerItem(owner, key));
}

std::optional<StoredArtifact> FileStore::FindArtifact(const std::string& owner, const std::string& name) {
  if (!IsArtifactName(name)) return std::nullopt;
  const std::string file = name.substr(0, 64), answers = AnswerItem(owner, "");
  std::string holder;
  (void)directory_.reader().Query(
      "SELECT holder FROM uses WHERE file = ? AND role = ? AND substr(holder, 1, ?) = ? LIMIT 1",
      {file, name, static_cast<std::int64_t>(answers.size()), answers},
      [&](const SqlRow& row) { holder = row.Text(0); });
  if (holder.empty()) return std::nullopt;
  Touch(holder);
  StoredArtifact artifact;
  artifact.path = directory_.FilePath(file);
  artifact.bytes = FileBytes(artifact.path);
  return artifact;
}

// ---- Deleting ----

void FileStore::Touch(const std::string& item) {
  const std::lock_guard lock(touches_mutex_);
  touches_[item] = WallClock();
}

void FileStore::WriteTouches() {
  std::map<std::string, double> touches;
  {
    const std::lock_guard lock(touches_mutex_);
    touches.swap(touches_);
  }
  if (touches.empty()) return;
  Transaction transaction(directory_.writer());
  if (!transaction.begun()) return;
  for (const auto& [item, used] : touches)
    (void)directory_.writer().Run("UPDATE items SET used = ? WHERE id = ?", {used, item});
  (void)transaction.Commit();
}

std::uint64_t FileStore::StoredBytes() {
  std::int64_t total = 0;
  (void)directory_.writer().Query("SELECT bytes FROM totals", {},
                                  [&](const SqlRow& row) { total = row.Integer(0); });
  return static_cast<std::uint64_t>(std::max<std::int64_t>(total, 0));
}

std::uint64_t FileStore::FreeBytes() {
  struct statvfs disk = {};
  if (statvfs(directory_.path().c_str(), &disk) != 0) return 0;
  return std::uint64_t{disk.f_bavail} * disk.f_frsize;
}

// Checks by making a directory, as each upload does. This needs a disk that is writable and has free entries.
Result<void> FileStore::Check() {
  auto scratch = Scratch();
  if (!scratch) return scratch.error();
  return {};
}

// The size of the files of an owner. A file that the owner uses twice is counted once.
std::uint64_t FileStore::OwnerBytes(const std::string& owner) {
  std::int64_t total = 0;
  const std::string first = owner + "/", last = owner + "0";
  (void)directory_.writer().Query(
      "SELECT coalesce(sum(bytes), 0) FROM files WHERE sha256 IN (SELECT file FROM uses WHERE holder >= ? "
      "AND holder < ?)",
      {first, last}, [&](const SqlRow& row) { total = row.Integer(0); });
  return static_cast<std::uint64_t>(std::max<std::int64_t>(total, 0));
}

bool FileStore::DeleteLeastRecentlyUsed(double unused_since, const std::string& prefix) {
  Database& database = directory_.writer();
  Transaction transaction(database);
  if (!transaction.begun()) return false;
  std::string item;
  (void)database.Query(
      "SELECT id FROM items WHERE used < ? AND substr(id, 1, ?) = ? AND NOT EXISTS (SELECT 1 FROM needs "
      "WHERE item = items.id) "
      "ORDER BY used LIMIT 1",
      {unused_since, static_cast<std::int64_t>(prefix.size()), prefix},
      [&](const SqlRow& row) { item = row.Text(0); });
  if (item.empty()) return false;
  if (!database.Run("DELETE FROM items WHERE id = ?", {item}) ||
      !database.Run("DELETE FROM uses WHERE holder = ?", {item}))
    return false;
  return transaction.Commit().ok();
}

Result<void> FileStore::MakeRoom(std::uint64_t bytes) {
  if (limits_.max_bytes == 0 || StoredBytes() + bytes <= limits_.max_bytes) return {};
  WriteTouches();
  RemoveLooseFiles();
  while (StoredBytes() + bytes > limits_.max_bytes) {
    if (bytes > limits_.max_bytes || !DeleteLeastRecentlyUsed(std::numeric_limits<double>::infinity()))
      return Error{ErrorCode::kWriteFailed, "the store is full: --max-store allows " +
                                                std::to_string(limits_.max_bytes >> 20) + " MB"};
    RemoveLooseFiles();
  }
  return {};
}

Result<void> FileStore::MakeRoomFor(const std::string& owner, std::uint64_t quota, std::uint64_t bytes) {
  if (quota == 0) return {};
  WriteTouches();
  while (OwnerBytes(owner) + bytes > quota) {
    if (bytes > quota || !DeleteLeastRecentlyUsed(std::numeric_limits<double>::infinity(), owner + "/"))
      return Error{ErrorCode::kWriteFailed,
                   "the key's quota is exhausted: it allows " + std::to_string(quota >> 20) + " MB"};
    RemoveLooseFiles();
  }
  return {};
}

void FileStore::Sweep() {
  WriteTouches();
  if (limits_.max_age_s > 0) {
    while (DeleteLeastRecentlyUsed(WallClock() - limits_.max_age_s)) {
    }
  }
  RemoveLooseFiles();
}

}  // namespace facetless
