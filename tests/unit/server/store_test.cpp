#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "server/base/files.h"
#include "server/base/sha256.h"
#include "server/service/jobs/sql_job_store.h"
#include "server/service/store/file_store.h"
#include "server/service/store/store_check.h"
#include "tests/unit/server/store_conformance.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

class FileStoreHost : public StoreHost {
 public:
  Store& Open(const StoreLimits& limits) override {
    jobs_.reset();
    store_.reset();
    directory_.reset();
    directory_ = DataDirectory::Open(folder_.File("data")).value();
    store_ = FileStore::Open(*directory_, limits).value();
    jobs_ = std::make_unique<SqlJobStore>(*directory_, QueueLimits{});
    return *store_;
  }
  JobStore& jobs() override { return *jobs_; }

 private:
  TempDir folder_ = TempDir::Create().value();
  std::unique_ptr<DataDirectory> directory_;
  std::unique_ptr<FileStore> store_;
  std::unique_ptr<SqlJobStore> jobs_;
};

std::unique_ptr<StoreHost> MakeFileStoreHost() {
  return std::make_unique<FileStoreHost>();
}

INSTANTIATE_TEST_SUITE_P(Files, StoreConformance, testing::Values(&MakeFileStoreHost));

// Tests properties of the files: their places, the state after a crash, the owner of the directory.
class Stored : public testing::Test {
 protected:
  Stored() { Open(); }
  ~Stored() override { Close(); }
  void Open(const StoreLimits& limits = {}) {
    data_directory_ = DataDirectory::Open(data_).value();
    store_ = FileStore::Open(*data_directory_, limits).value();
  }
  void Close() {
    store_.reset();
    data_directory_.reset();
  }
  // Returns a file of the store with this text.
  StoredFile Kept(const std::string& text) {
    scratch_.push_back(store_->Scratch().value());
    return store_->AddFile(WriteText(scratch_.back().File("file"), text), "").value();
  }
  void PutModel(const std::string& source, const std::string& model = "model",
                const std::string& owner = "") {
    const auto put =
        store_->PutModel(owner, Sha256Hex(source), "part.step", {{"faces", 3}}, Kept(source), Kept(model));
    ASSERT_TRUE(put.ok()) << put.error().message;
  }
  // Stores an answer with a picture of the given number of bytes.
  void PutAnswer(const std::string& question, std::size_t bytes) {
    const StoredFile picture = Kept(question + std::string(bytes - question.size(), '.'));
    const auto put = store_->PutAnswer("", Sha256Hex(question), "{}", {{picture.sha256 + ".png", picture}});
    ASSERT_TRUE(put.ok()) << put.error().message;
  }
  bool HasAnswer(const std::string& question) {
    return store_->FindAnswer("", Sha256Hex(question)).has_value();
  }
  bool OnDisk(const std::string& sha256) const {
    return std::filesystem::exists(data_directory_->FilePath(sha256));
  }
  int FilesOnDisk() const {
    int count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(data_ + "/files"))
      count += entry.is_regular_file();
    return count;
  }

  TempDir directory_ = TempDir::Create().value();
  std::string data_ = directory_.File("data");
  std::unique_ptr<DataDirectory> data_directory_;
  std::unique_ptr<FileStore> store_;
  std::vector<TempDir> scratch_;
};

TEST_F(Stored, EverythingOutlivesTheProcessButWhatACrashLeft) {
  PutAnswer("question", 10);
  PutModel("source");
  const int files = FilesOnDisk();
  Close();
  WriteText(data_ + "/tmp/leftover", "of a crash");
  std::filesystem::create_directories(data_ + "/files/ab");
  WriteText(data_ + "/files/ab/" + std::string(64, 'a'), "named by no row");
  Open();
  EXPECT_TRUE(HasAnswer("question"));
  EXPECT_TRUE(store_->FindModel("", Sha256Hex("source")).has_value());
  EXPECT_TRUE(std::filesystem::is_empty(data_ + "/tmp"));
  EXPECT_EQ(FilesOnDisk(), files);
}

TEST_F(Stored, OneProcessOwnsTheDirectory) {
  const auto second = DataDirectory::Open(data_);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("in use by another facetless serve"));
}

TEST_F(Stored, RefusesADirectoryOfANewerVersionAndLeavesItAlone) {
  PutAnswer("question", 10);
  const auto set_version = [&](int version) {
    ASSERT_TRUE(data_directory_->writer().RunScript("PRAGMA user_version = " + std::to_string(version)).ok());
  };
  set_version(kSchemaVersion + 1);
  Close();
  const auto refused = DataDirectory::Open(data_);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kBadUsage);
  EXPECT_THAT(refused.error().message, HasSubstr("written by a newer facetless"));
  ASSERT_TRUE(Database::Open(data_ + "/facetless.db")
                  .value()
                  ->RunScript("PRAGMA user_version = " + std::to_string(kSchemaVersion))
                  .ok());
  Open();
  EXPECT_TRUE(HasAnswer("question"));
}

TEST_F(Stored, SaysSoWhenTheDatabaseIsNone) {
  Close();
  WriteText(data_ + "/facetless.db", std::string(4096, 'x'));
  const auto opened = DataDirectory::Open(data_);
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().code, ErrorCode::kFormatBroken);
}

TEST_F(Stored, ForgetsWhatWasNotUsedForLong) {
  PutAnswer("old", 10);
  PutAnswer("new", 10);
  ASSERT_TRUE(data_directory_->writer()
                  .Run("UPDATE items SET used = used - 1000 WHERE id = ?", {AnswerItem("", Sha256Hex("old"))})
                  .ok());
  Close();
  Open({.max_age_s = 500});
  store_->Sweep();
  EXPECT_FALSE(HasAnswer("old"));
  EXPECT_TRUE(HasAnswer("new"));
}

// ---- store check ----

class Checked : public Stored {
 protected:
  Checked() {
    PutModel("source");
    PutAnswer("question", 10);
    scratch_.clear();
    const StoredFile report = Kept("{}"), page = Kept("<html>");
    const auto put = store_->PutAnswer("", Sha256Hex("asked"), "{}",
                                       {{report.sha256 + ".json", report}, {page.sha256 + ".html", page}});
    EXPECT_TRUE(put.ok());
    (void)data_directory_->writer().Run("DELETE FROM items WHERE id = ?",
                                        {AnswerItem("", Sha256Hex("question"))});
    (void)data_directory_->writer().Run("DELETE FROM uses WHERE holder = ?",
                                        {AnswerItem("", Sha256Hex("question"))});
    source_ = data_directory_->FilePath(Sha256Hex("source"));
    std::filesystem::permissions(source_, std::filesystem::perms::owner_write,
                                 std::filesystem::perm_options::add);
  }
  // Returns the kinds of faults that the check finds.
  std::vector<std::string> Faults() {
    scratch_.clear();
    Close();
    const auto answer = CheckStore(data_);
    EXPECT_TRUE(answer.ok()) << answer.error().message;
    std::vector<std::string> kinds;
    for (const auto& fault : answer.value().at("faults")) kinds.push_back(fault.at("kind"));
    return kinds;
  }
  void Sql(const std::string& text) { ASSERT_TRUE(data_directory_->writer().RunScript(text).ok()); }

  std::string source_;
};

TEST_F(Checked, FindsNothingInASoundStore) {
  EXPECT_THAT(Faults(), IsEmpty());
}

TEST_F(Checked, FindsWhatHappenedToFiles) {
  WriteText(source_, "sourcf");
  WriteText(data_ + "/files/" + Sha256Hex("orphan"), "orphan");
  std::filesystem::remove(data_directory_->FilePath(Sha256Hex("model")));
  WriteText(data_ + "/tmp/torn", "half of it");
  EXPECT_THAT(Faults(), UnorderedElementsAre("wrong-content", "orphan", "missing-file", "leftover"));
}

TEST_F(Checked, FindsATornFile) {
  WriteText(source_, "sou");
  EXPECT_THAT(Faults(), UnorderedElementsAre("wrong-size", "wrong-content"));
}

TEST_F(Checked, FindsRowsThatContradictEachOther) {
  Sql("DELETE FROM uses WHERE role = 'source'; DELETE FROM loose WHERE file = '" + Sha256Hex("source") +
      "';");
  EXPECT_THAT(Faults(), UnorderedElementsAre("unused-file", "incomplete-model"));
}

TEST_F(Checked, FindsRowsWithoutFilesAndHolders) {
  Sql("INSERT INTO uses VALUES('/answer/nowhere', 'x', 'nothing');");
  EXPECT_THAT(Faults(), UnorderedElementsAre("use-without-file", "use-without-holder"));
}

TEST_F(Checked, FindsAJobThatIsBothDoneAndQueued) {
  SqlJobStore jobs(*data_directory_, {});
  NewJob job;
  job.question = "question";
  const std::string id = jobs.Submit(job).value().job.id;
  Sql("UPDATE jobs SET result = '/answer/x', finished = 1;");
  EXPECT_THAT(Faults(), UnorderedElementsAre("contradictory-job"));
}

TEST_F(Checked, FindsAJobThatHoldsOnToThings) {
  SqlJobStore jobs(*data_directory_, {});
  NewJob job;
  job.question = "question";
  job.needs = {"/model/x"};
  ASSERT_TRUE(jobs.Submit(job).ok());
  Sql("UPDATE jobs SET state = 'cancelled', finished = 1;");
  EXPECT_THAT(Faults(), UnorderedElementsAre("job-holds"));
}

TEST_F(Checked, NeedsADirectoryThatIsOneAndNotInUse) {
  EXPECT_FALSE(CheckStore(data_).ok());
  EXPECT_EQ(CheckStore(directory_.path()).error().code, ErrorCode::kBadUsage);
}

TEST(SafeFileName, KeepsWhatIsHarmless) {
  EXPECT_EQ(SafeFileName("part-1_a.step"), "part-1_a.step");
  EXPECT_EQ(SafeFileName("Gehäuse 2.stp"), "Gehäuse 2.stp");
  EXPECT_EQ(SafeFileName("../../etc/passwd"), "passwd");
  EXPECT_EQ(SafeFileName("C:\\parts\\a.igs"), "a.igs");
  EXPECT_EQ(SafeFileName("..hidden"), "hidden");
  EXPECT_EQ(SafeFileName("a\nb<c>.step"), "a_b_c_.step");
  EXPECT_EQ(SafeFileName(""), "model");
  EXPECT_EQ(SafeFileName("/"), "model");
  const std::string kept = SafeFileName(std::string(300, 'x') + ".step");
  EXPECT_EQ(kept.size(), 100u);
  EXPECT_TRUE(kept.ends_with(".step"));
}

TEST(Files, AreWrittenInFullOrNotAtAll) {
  const TempDir directory = TempDir::Create().value();
  const std::string path = directory.File("file");
  ASSERT_TRUE(WriteFileAtomically(path, "one").ok());
  ASSERT_TRUE(WriteFileAtomically(path, "two").ok());
  EXPECT_EQ(ReadText(path), "two");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1);
  auto failed = WriteFileAtomically(directory.File("absent/file"), "x");
  ASSERT_FALSE(failed.ok());
  EXPECT_EQ(failed.error().code, ErrorCode::kWriteFailed);
  EXPECT_EQ(ReadFile(path, 2).error().code, ErrorCode::kLimitExceeded);
  EXPECT_EQ(ReadFile(directory.path(), 2).error().code, ErrorCode::kFileUnreadable);
}

TEST(Files, JsonWithBytesThatAreNoUtf8IsStillJson) {
  const std::string text = JsonText({{"name",
                                      "fl\xe4"
                                      "che"}},
                                    -1);
  EXPECT_EQ(text,
            "{\"name\":\"fl\xef\xbf\xbd"
            "che\"}");
}

TEST(Sha256, OfFilesAndPieces) {
  EXPECT_EQ(Sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  Sha256 pieces;
  pieces.Add("a", 1);
  pieces.Add("bc", 2);
  EXPECT_EQ(pieces.Hex(), Sha256Hex("abc"));
  EXPECT_EQ(Sha256OfFile("/no/such/file").error().code, ErrorCode::kFileUnreadable);
}

}  // namespace
}  // namespace facetless
