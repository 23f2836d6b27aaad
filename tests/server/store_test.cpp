#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/files.h"
#include "server/service/file_store.h"
#include "server/sha256.h"
#include "tests/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;

class Stored : public testing::Test {
 protected:
  std::string File(const std::string& text) {
    return WriteText(directory_.File("file" + std::to_string(++files_)), text);
  }
  TempDir directory_ = TempDir::Create().value();
  std::string data_ = directory_.File("data");
  std::unique_ptr<FileStore> store_ = FileStore::Open(data_).value();
  int files_ = 0;
};

TEST_F(Stored, ArtifactsAreNamedAfterTheirContent) {
  const std::string name = store_->PutArtifact(File("abc"), "png").value();
  // FIPS 180-2, appendix B.1.
  EXPECT_EQ(name, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad.png");
  const auto artifact = store_->FindArtifact(name);
  ASSERT_TRUE(artifact.has_value());
  EXPECT_EQ(artifact->bytes, 3u);
  EXPECT_EQ(ReadText(artifact->path), "abc");
  EXPECT_EQ(store_->PutArtifact(File("abc"), "png").value(), name);
}

TEST_F(Stored, NothingIsFoundUnderANameThatIsNone) {
  const std::string digest = Sha256Hex("x");
  for (const std::string& name :
       {digest, digest + ".", digest + ".PNG", digest + ".p/g", digest + ".toolongext",
        "../" + digest.substr(3) + ".png", std::string(64, 'g') + ".png", std::string()}) {
    EXPECT_FALSE(IsArtifactName(name)) << name;
    EXPECT_FALSE(store_->FindArtifact(name).has_value()) << name;
  }
  EXPECT_FALSE(store_->FindModel("../../etc").has_value());
  EXPECT_FALSE(store_->FindModel(digest).has_value());
  EXPECT_FALSE(store_->FindMesh(digest, "../x").has_value());
  EXPECT_FALSE(store_->FindResult("../x").has_value());
}

TEST_F(Stored, ModelsComeBackWholeAndTwiceIsOnce) {
  const std::string id = Sha256Hex("source");
  EXPECT_FALSE(store_->FindModel(id).has_value());
  for (int i = 0; i < 2; ++i) {
    auto put = store_->PutModel(id, "part.step", {{"faces", 3}}, File("source"), File("model"));
    ASSERT_TRUE(put.ok()) << put.error().message;
  }
  const auto model = store_->FindModel(id);
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->name, "part.step");
  EXPECT_EQ(model->bytes, 6u);
  EXPECT_EQ(model->report.at("faces"), 3);
  EXPECT_EQ(ReadText(model->source_path), "source");
  EXPECT_EQ(ReadText(model->model_path), "model");

  const std::string key = Sha256Hex("how");
  EXPECT_FALSE(store_->FindMesh(id, key).has_value());
  ASSERT_TRUE(store_->PutMesh(id, key, File("mesh")).ok());
  EXPECT_EQ(ReadText(store_->FindMesh(id, key).value()), "mesh");
}

TEST_F(Stored, ResultsOutliveTheProcessAndHalfAModelDoesNotCount) {
  const std::string key = Sha256Hex("request"), id = Sha256Hex("half");
  ASSERT_TRUE(store_->PutResult(key, {{"views", 1}}).ok());
  std::filesystem::create_directories(data_ + "/models/" + id);
  WriteText(data_ + "/tmp/leftover", "of a crash");
  store_.reset();
  store_ = FileStore::Open(data_).value();
  EXPECT_EQ(store_->FindResult(key).value().at("views"), 1);
  EXPECT_FALSE(store_->FindModel(id).has_value());
  EXPECT_TRUE(std::filesystem::is_empty(data_ + "/tmp"));
}

TEST_F(Stored, OneProcessOwnsTheDirectory) {
  auto second = FileStore::Open(data_);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("in use by another facetless serve"));
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
