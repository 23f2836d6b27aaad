#include "tests/unit/server/store_conformance.h"

#include <filesystem>

#include "tests/unit/server/support.h"

namespace facetless {
namespace {

TEST_P(StoreConformance, FilesAreNamedAfterTheirContentAndStayAsLongAsSomebodyHoldsThem) {
  std::optional<StoredFile> file = Kept("abc");
  // This is the example of FIPS 180-2, appendix B.1.
  EXPECT_EQ(file->sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(file->bytes, 3u);
  EXPECT_EQ(ReadText(file->path), "abc");
  std::optional<StoredFile> same = Kept("abc");
  EXPECT_EQ(same->path, file->path);
  const std::string path = file->path;
  file.reset();
  EXPECT_EQ(ReadText(path), "abc") << "the file is still held";
  same.reset();
  EXPECT_FALSE(std::filesystem::exists(path)) << "no entry refers to the file";
}

TEST_P(StoreConformance, NothingIsFoundUnderANameThatIsNone) {
  const std::string digest = Sha256Hex("x");
  for (const std::string& name :
       {digest, digest + ".", digest + ".PNG", digest + ".p/g", digest + ".toolongext",
        "../" + digest.substr(3) + ".png", std::string(64, 'g') + ".png", std::string()}) {
    EXPECT_FALSE(IsArtifactName(name)) << name;
    EXPECT_FALSE(store().FindArtifact("", name).has_value()) << name;
  }
  EXPECT_FALSE(store().FindModel("", "../../etc").has_value());
  EXPECT_FALSE(store().FindModel("", digest).has_value());
  EXPECT_FALSE(store().FindMesh("", digest, "../x").has_value());
  EXPECT_FALSE(store().FindAnswer("", "../x").has_value());
  EXPECT_FALSE(store().Pin("../x").has_value());
}

TEST_P(StoreConformance, ModelsComeBackWholeAndTwiceIsOnce) {
  const std::string id = Sha256Hex("source");
  EXPECT_FALSE(store().FindModel("", id).has_value());
  for (int i = 0; i < 2; ++i) PutModel("source");
  const auto model = store().FindModel("", id);
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->name, "part.step");
  EXPECT_EQ(model->bytes, 6u);
  EXPECT_EQ(model->report.at("faces"), 3);
  EXPECT_EQ(ReadText(model->source_path), "source");
  EXPECT_EQ(ReadText(model->model_path), "model");

  const std::string key = Sha256Hex("how");
  EXPECT_FALSE(store().FindMesh("", id, key).has_value());
  ASSERT_TRUE(store().PutMesh("", id, key, Kept("mesh")).ok());
  EXPECT_EQ(ReadText(store().FindMesh("", id, key).value()), "mesh");
}

TEST_P(StoreConformance, ArtifactsAreServedUnderTheirNameAndNothingElseIs) {
  PutAnswer("question", 10);
  PutModel("source");
  const std::string picture = Sha256Hex("question..");
  EXPECT_EQ(store().FindArtifact("", picture + ".png").value().bytes, 10u);
  EXPECT_FALSE(store().FindArtifact("", picture + ".html").has_value()) << "the browser would execute it";
  EXPECT_FALSE(store().FindArtifact("", Sha256Hex("source") + ".png").has_value())
      << "this is an uploaded CAD file";
}

TEST_P(StoreConformance, AnOwnerFindsOnlyWhatIsTheirs) {
  PutModel("source", "model", "anna");
  EXPECT_TRUE(store().FindModel("anna", Sha256Hex("source")).has_value());
  EXPECT_FALSE(store().FindModel("bert", Sha256Hex("source")).has_value());
  EXPECT_FALSE(store().FindModel("", Sha256Hex("source")).has_value());
}

TEST_P(StoreConformance, GivesUpWhatWasUsedLongestAgo) {
  Open({.max_bytes = 1000});
  PutAnswer("one", 300);
  PutAnswer("two", 300);
  PutAnswer("three", 300);
  EXPECT_TRUE(HasAnswer("one")) << "after this use, two is the oldest";
  PutAnswer("four", 300);
  EXPECT_TRUE(HasAnswer("one"));
  EXPECT_FALSE(HasAnswer("two"));
  EXPECT_TRUE(HasAnswer("three"));
  EXPECT_TRUE(HasAnswer("four"));
  EXPECT_EQ(store().StoredBytes(), 900u);
  const auto too_large = store().MakeRoom(1001);
  ASSERT_FALSE(too_large.ok());
  EXPECT_EQ(too_large.error().code, ErrorCode::kWriteFailed);
  EXPECT_TRUE(HasAnswer("four")) << "nothing may be deleted without need";
}

TEST_P(StoreConformance, NeverGivesUpWhatAJobNeeds) {
  Open({.max_bytes = 1000});
  PutModel(std::string(300, 's'), std::string(300, 'm'));
  const std::string id = Sha256Hex(std::string(300, 's'));
  NewJob job;
  job.kind = JobKind::kRender;
  job.question = "question";
  job.needs = {ModelItem("", id)};
  ASSERT_TRUE(jobs().Submit(job).ok());
  EXPECT_FALSE(store().MakeRoom(500).ok()) << "only the model could be deleted";
  ASSERT_TRUE(store().FindModel("", id).has_value());

  // After the job's end, the model is no longer needed.
  Job claimed = jobs().Claim("worker", 60).value().value();
  EXPECT_FALSE(store().MakeRoom(500).ok());
  claimed.state = JobState::kCancelled;
  ASSERT_TRUE(jobs().Finish(claimed).value());
  EXPECT_TRUE(store().MakeRoom(500).ok());
  EXPECT_FALSE(store().FindModel("", id).has_value());
  EXPECT_EQ(store().StoredBytes(), 0u);
}

TEST_P(StoreConformance, EverythingOutlivesTheProcess) {
  PutAnswer("question", 10);
  PutModel("source");
  Open();
  EXPECT_TRUE(HasAnswer("question"));
  EXPECT_TRUE(store().FindModel("", Sha256Hex("source")).has_value());
}

}  // namespace
}  // namespace facetless
