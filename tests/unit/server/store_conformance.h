// Tests the laws of the store (server/service/store/store.h) for any implementation. A file of tests defines
// a host of its own, and contains
//
//   INSTANTIATE_TEST_SUITE_P(Files, StoreConformance, testing::Values(&MakeFileStoreHost));
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "server/base/sha256.h"
#include "server/service/jobs/job_store.h"
#include "server/service/store/store.h"
#include "tests/unit/server/support.h"

namespace facetless {

// The place where an implementation stores its files. It is empty at first.
class StoreHost {
 public:
  virtual ~StoreHost() = default;
  // Closes the store that the last call returned, and opens the stored data again.
  virtual Store& Open(const StoreLimits& limits) = 0;
  // The jobs that hold files of the open store.
  virtual JobStore& jobs() = 0;
};

class StoreConformance : public testing::TestWithParam<std::unique_ptr<StoreHost> (*)()> {
 protected:
  StoreConformance() { Open(); }
  void Open(const StoreLimits& limits = {}) {
    scratch_.clear();
    store_ = &host_->Open(limits);
  }
  Store& store() { return *store_; }
  JobStore& jobs() { return host_->jobs(); }

  // Returns a file of the store with this text.
  StoredFile Kept(const std::string& text) {
    scratch_.push_back(store().Scratch().value());
    return store().AddFile(WriteText(scratch_.back().File("file"), text), "").value();
  }
  void PutModel(const std::string& source, const std::string& model = "model",
                const std::string& owner = "") {
    const auto put =
        store().PutModel(owner, Sha256Hex(source), "part.step", {{"faces", 3}}, Kept(source), Kept(model));
    ASSERT_TRUE(put.ok()) << put.error().message;
  }
  // Stores an answer with a picture of the given number of bytes.
  void PutAnswer(const std::string& question, std::size_t bytes) {
    const StoredFile picture = Kept(question + std::string(bytes - question.size(), '.'));
    const auto put = store().PutAnswer("", Sha256Hex(question), "{}", {{picture.sha256 + ".png", picture}});
    ASSERT_TRUE(put.ok()) << put.error().message;
  }
  bool HasAnswer(const std::string& question) {
    return store().FindAnswer("", Sha256Hex(question)).has_value();
  }

 private:
  std::unique_ptr<StoreHost> host_ = GetParam()();
  Store* store_ = nullptr;
  std::vector<TempDir> scratch_;
};

}  // namespace facetless
