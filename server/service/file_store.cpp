#include "server/service/file_store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "server/files.h"
#include "server/sha256.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;

// Records and results are small; what is larger is not ours.
constexpr std::size_t kMaxRecordBytes = std::size_t{256} << 20;

std::optional<nlohmann::json> ReadJson(const std::string& path) {
  auto text = ReadFile(path, kMaxRecordBytes);
  if (!text) return std::nullopt;
  nlohmann::json json = nlohmann::json::parse(text.value(), nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

bool IsFile(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

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
  // Keep the end, where the extension is, and cut no UTF-8 sequence.
  if (safe.size() > kMaxBytes) safe.erase(0, safe.size() - kMaxBytes);
  while (!safe.empty() && (static_cast<unsigned char>(safe[0]) & 0xc0) == 0x80) safe.erase(0, 1);
  return safe.empty() ? "model" : safe;
}

Result<std::unique_ptr<FileStore>> FileStore::Open(const std::string& directory) {
  for (const char* child : {"models", "results", "artifacts", "tmp"}) {
    if (auto made = MakeDirectories(directory + "/" + child); !made) return made.error();
  }
  const std::string lock_path = directory + "/lock";
  const int lock = open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock < 0)
    return Error{ErrorCode::kWriteFailed, "cannot write " + lock_path + ": " + std::strerror(errno)};
  if (flock(lock, LOCK_EX | LOCK_NB) != 0) {
    close(lock);
    return Error{ErrorCode::kBadUsage,
                 directory + " is in use by another facetless serve; choose another --data"};
  }
  std::error_code ignored;
  for (const auto& leftover : fs::directory_iterator(directory + "/tmp", ignored))
    fs::remove_all(leftover, ignored);
  return std::unique_ptr<FileStore>(new FileStore(directory, lock));
}

FileStore::~FileStore() {
  close(lock_);
}

Result<TempDir> FileStore::Scratch() {
  return TempDir::Create(directory_ + "/tmp");
}

Result<StoredModel> FileStore::PutModel(const std::string& id, const std::string& name,
                                        const nlohmann::json& report, const std::string& source_path,
                                        const std::string& model_path) {
  // Fill a directory beside, then rename it as a whole.
  auto scratch = Scratch();
  if (!scratch) return scratch.error();
  const std::string staged = scratch.value().File("model");
  std::error_code error;
  const std::uint64_t bytes = fs::file_size(source_path, error);
  const nlohmann::json record = {{"id", id}, {"name", name}, {"bytes", bytes}, {"report", report}};
  if (auto made = MakeDirectories(staged + "/source"); !made) return made.error();
  if (auto moved = MoveFile(source_path, staged + "/source/" + name); !moved) return moved.error();
  if (auto moved = MoveFile(model_path, staged + "/model.flm"); !moved) return moved.error();
  if (auto written = WriteFileAtomically(staged + "/record.json", JsonText(record)); !written)
    return written.error();
  // If another writer was first, its directory stays: the content is the same.
  fs::rename(staged, directory_ + "/models/" + id, error);
  auto stored = FindModel(id);
  if (!stored) return Error{ErrorCode::kWriteFailed, "cannot store the model: " + error.message()};
  return *stored;
}

std::optional<StoredModel> FileStore::FindModel(const std::string& id) {
  if (!IsSha256Hex(id)) return std::nullopt;
  const std::string directory = directory_ + "/models/" + id;
  auto record = ReadJson(directory + "/record.json");
  if (!record || !record->is_object() || !record->contains("name") || !record->contains("report"))
    return std::nullopt;
  StoredModel model;
  model.id = id;
  model.name = record->at("name").get<std::string>();
  model.bytes = record->value("bytes", std::uint64_t{0});
  model.report = record->at("report");
  model.source_path = directory + "/source/" + model.name;
  model.model_path = directory + "/model.flm";
  return model;
}

Result<std::string> FileStore::PutMesh(const std::string& id, const std::string& key,
                                       const std::string& path) {
  const std::string kept = directory_ + "/models/" + id + "/mesh-" + key + ".glb";
  if (auto moved = MoveFile(path, kept); !moved) return moved.error();
  return kept;
}

std::optional<std::string> FileStore::FindMesh(const std::string& id, const std::string& key) {
  if (!IsSha256Hex(id) || !IsSha256Hex(key)) return std::nullopt;
  const std::string path = directory_ + "/models/" + id + "/mesh-" + key + ".glb";
  if (!IsFile(path)) return std::nullopt;
  return path;
}

Result<void> FileStore::PutResult(const std::string& key, const nlohmann::json& result) {
  return WriteFileAtomically(directory_ + "/results/" + key + ".json", JsonText(result));
}

std::optional<nlohmann::json> FileStore::FindResult(const std::string& key) {
  if (!IsSha256Hex(key)) return std::nullopt;
  return ReadJson(directory_ + "/results/" + key + ".json");
}

Result<std::string> FileStore::PutArtifact(const std::string& path, const std::string& extension) {
  auto digest = Sha256OfFile(path);
  if (!digest) return digest.error();
  const std::string name = digest.value() + "." + extension;
  const std::string folder = directory_ + "/artifacts/" + name.substr(0, 2);
  if (auto made = MakeDirectories(folder); !made) return made.error();
  if (auto moved = MoveFile(path, folder + "/" + name); !moved) return moved.error();
  return name;
}

std::optional<StoredArtifact> FileStore::FindArtifact(const std::string& name) {
  if (!IsArtifactName(name)) return std::nullopt;
  StoredArtifact artifact;
  artifact.path = directory_ + "/artifacts/" + name.substr(0, 2) + "/" + name;
  std::error_code error;
  artifact.bytes = fs::file_size(artifact.path, error);
  if (error) return std::nullopt;
  return artifact;
}

}  // namespace facetless
