#include "server/service/store/store_check.h"

#include <cstdio>
#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include "server/base/exit_code.h"
#include "server/base/files.h"
#include "server/base/sha256.h"
#include "server/service/store/data_directory.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class StoreCheck {
 public:
  explicit StoreCheck(DataDirectory& directory) : directory_(directory) {}

  Result<Json> Run() {
    for (const auto step : {&StoreCheck::CheckDatabase, &StoreCheck::CheckFiles, &StoreCheck::CheckUses,
                            &StoreCheck::CheckJobs}) {
      if (auto done = (this->*step)(); !done) return done.error();
    }
    CheckLeftovers();
    answer_["directory"] = directory_.path();
    answer_["faults"] = std::move(faults_);
    return std::move(answer_);
  }

 private:
  void Fault(const char* kind, const std::string& what, const std::string& detail) {
    faults_.push_back({{"kind", kind}, {"what", what}, {"detail", detail}});
  }
  Result<void> Ask(const std::string& sql, const std::function<void(const SqlRow&)>& row) {
    return directory_.reader().Query(sql, {}, row);
  }
  // Adds a fault for each row of the result; the row is the name of the fault's object.
  Result<void> FaultForEach(const char* kind, const std::string& detail, const std::string& sql) {
    return Ask(sql, [&](const SqlRow& row) { Fault(kind, row.Text(0), detail); });
  }

  Result<void> CheckDatabase() {
    return Ask("PRAGMA integrity_check", [&](const SqlRow& row) {
      if (row.Text(0) != "ok") Fault("database", "facetless.db", row.Text(0));
    });
  }

  Result<void> CheckFiles() {
    std::vector<std::pair<std::string, std::uint64_t>> rows;
    auto asked = Ask("SELECT sha256, bytes FROM files", [&](const SqlRow& row) {
      rows.emplace_back(row.Text(0), static_cast<std::uint64_t>(row.Integer(1)));
    });
    if (!asked) return asked;
    std::uint64_t total = 0;
    for (const auto& [name, bytes] : rows) {
      named_.insert(name);
      total += bytes;
      std::error_code error;
      const std::string path = directory_.FilePath(name);
      const std::uint64_t size = fs::file_size(path, error);
      if (error) {
        Fault("missing-file", name, "a row names it, but it is not there");
        continue;
      }
      if (size != bytes)
        Fault("wrong-size", name, std::to_string(size) + " bytes instead of " + std::to_string(bytes));
      const auto digest = Sha256OfFile(path);
      if (!digest || digest.value() != name)
        Fault("wrong-content", name, "its SHA-256 is " + (digest ? digest.value() : digest.error().message));
    }
    answer_["files"] = rows.size();
    answer_["bytes"] = total;
    return Ask("SELECT bytes FROM totals", [&](const SqlRow& row) {
      if (static_cast<std::uint64_t>(row.Integer(0)) != total)
        Fault("wrong-total", "totals",
              std::to_string(row.Integer(0)) + " instead of " + std::to_string(total));
    });
  }

  Result<void> CheckUses() {
    if (auto done = FaultForEach(
            "use-without-file", "it uses a file that has no row",
            "SELECT holder || ' ' || role FROM uses WHERE file NOT IN (SELECT sha256 FROM files)");
        !done)
      return done;
    if (auto done = FaultForEach(
            "unused-file", "nothing uses it, and it is not marked to go",
            "SELECT sha256 FROM files WHERE sha256 NOT IN (SELECT file FROM uses) AND sha256 NOT IN "
            "(SELECT file FROM loose)");
        !done)
      return done;
    if (auto done =
            FaultForEach("use-without-holder", "it keeps a file, but is not there",
                         "SELECT DISTINCT holder FROM uses WHERE holder NOT IN (SELECT id FROM items) AND "
                         "holder NOT IN (SELECT 'job/' || id FROM jobs)");
        !done)
      return done;
    if (auto done = FaultForEach(
            "incomplete-model", "a model has a source and a model file",
            "SELECT id FROM items WHERE id LIKE '%/model/%' AND (SELECT count(*) FROM uses WHERE "
            "holder = items.id AND role IN ('source', 'model')) != 2");
        !done)
      return done;
    if (auto done = FaultForEach(
            "incomplete-answer", "an answer has its report and its page",
            "SELECT id FROM items WHERE id LIKE '%/answer/%' AND (SELECT count(*) FROM uses WHERE "
            "holder = items.id) < 2");
        !done)
      return done;
    return Ask("SELECT count(*) FROM items", [&](const SqlRow& row) { answer_["items"] = row.Integer(0); });
  }

  Result<void> CheckJobs() {
    answer_["jobs"] = Json::object();
    if (auto counted = Ask("SELECT state, count(*) FROM jobs GROUP BY state",
                           [&](const SqlRow& row) { answer_["jobs"][row.Text(0)] = row.Integer(1); });
        !counted)
      return counted;
    if (auto done =
            FaultForEach("contradictory-job", "its state contradicts its times, its result or its problem",
                         "SELECT id FROM jobs WHERE NOT CASE state "
                         "WHEN 'queued' THEN finished IS NULL AND result IS NULL AND problem IS NULL "
                         "WHEN 'running' THEN finished IS NULL AND result IS NULL AND problem IS NULL AND "
                         "lease IS NOT NULL "
                         "WHEN 'done' THEN finished IS NOT NULL AND result IS NOT NULL AND problem IS NULL "
                         "WHEN 'failed' THEN finished IS NOT NULL AND result IS NULL AND problem IS NOT NULL "
                         "WHEN 'cancelled' THEN finished IS NOT NULL AND result IS NULL AND problem IS NULL "
                         "ELSE 0 END");
        !done)
      return done;
    const char* ended = "it ended, but still holds files or needs models";
    return FaultForEach(
        "job-holds", ended,
        "SELECT id FROM jobs WHERE state NOT IN ('queued', 'running') AND (id IN (SELECT job FROM needs) "
        "OR 'job/' || id IN (SELECT holder FROM uses))");
  }

  void CheckLeftovers() {
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(directory_.path() + "/files", error)) {
      const std::string name = entry.path().filename();
      if (entry.is_regular_file(error) &&
          (!named_.contains(name) || entry.path() != directory_.FilePath(name)))
        Fault("orphan", name, "no row names this file");
    }
    for (const auto& entry : fs::directory_iterator(directory_.TemporaryPath(), error))
      Fault("leftover", entry.path().filename(), "of a crash, in tmp/");
  }

  DataDirectory& directory_;
  std::set<std::string> named_;
  Json answer_ = Json::object(), faults_ = Json::array();
};

}  // namespace

Result<Json> CheckStore(const std::string& directory) {
  std::error_code error;
  if (!fs::exists(directory + "/facetless.db", error))
    return Error{ErrorCode::kBadUsage, directory + " is not a data directory: it has no facetless.db"};
  auto opened = DataDirectory::Open(directory);
  if (!opened) return opened.error();
  return StoreCheck(*opened.value()).Run();
}

int StoreCheckCommand(const std::string& directory) {
  const auto answer = CheckStore(directory);
  if (!answer) {
    (void)PrintError(answer.error());
    // An unreadable database is a fault that the check is meant to find.
    return answer.error().code == ErrorCode::kFormatBroken ? 1 : ExitCodeForError(answer.error());
  }
  std::printf("%s\n", JsonText(answer.value()).c_str());
  return answer.value().at("faults").empty() ? 0 : 1;
}

}  // namespace facetless
