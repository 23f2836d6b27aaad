#include "server/service/jobs/publication.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <map>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/base/files.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The number of files that are added at the same time. Each waits for the disk most of the time.
constexpr std::size_t kAtOnce = 8;

// Adds the files of the run to the store, and returns them in the same order. Error: the first one.
Result<std::vector<StoredFile>> AddFiles(Store& store, const std::vector<std::string>& paths) {
  std::vector<StoredFile> added(paths.size());
  std::vector<Result<void>> results(paths.size());
  std::atomic<std::size_t> next{0};
  const auto add = [&] {
    for (std::size_t i = next++; i < paths.size(); i = next++) {
      try {
        auto one = store.AddFile(paths[i], "");
        if (one)
          added[i] = std::move(one).value();
        else
          results[i] = one.error();
      } catch (const std::exception& exception) {
        results[i] = Error{ErrorCode::kWriteFailed, exception.what()};
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    try {
      while (helpers.size() + 1 < std::min(kAtOnce, paths.size())) helpers.emplace_back(add);
    } catch (const std::system_error&) {
      // There are no more threads to be had: fewer do it, too.
    }
    add();
  }
  for (const Result<void>& result : results)
    if (!result) return result.error();
  return added;
}

}  // namespace

Result<void> PublishRun(Store& store, const std::string& owner, const std::string& key,
                        const std::string& model_id, RunResult result, const std::string& directory) {
  std::vector<std::string> names;
  for (const RunFile& file : result.files.list()) names.push_back(file.name);
  for (const std::string& name : result.files.frames()) names.push_back(name);
  std::vector<std::string> paths;
  for (const std::string& name : names) paths.push_back(directory + "/" + name);
  auto added = AddFiles(store, paths);
  if (!added) return added.error();
  std::vector<std::pair<std::string, StoredFile>> artifacts;
  std::vector<std::string> addresses;
  for (std::size_t i = 0; i < names.size(); ++i) {
    StoredFile& file = added.value()[i];
    const std::string artifact = file.sha256 + "." + names[i].substr(names[i].rfind('.') + 1);
    addresses.push_back("/v1/artifacts/" + artifact);
    artifacts.emplace_back(artifact, std::move(file));
  }

  // Link each view, the run and the turntable to their files.
  Json& report = result.report;
  Json run_links = {{"model", "/v1/models/" + model_id}, {"self", "/v1/answers/" + key}};
  std::map<std::string, Json> view_links;
  std::size_t next = 0;
  for (const RunFile& file : result.files.list())
    (file.view.empty() ? run_links : view_links[file.view])[file.role] = addresses[next++];
  for (Json& view : report["views"]) view["links"] = view_links[view.at("name").get<std::string>()];
  if (!result.files.frames().empty())
    report["turntable"]["links"] =
        std::vector<std::string>(addresses.begin() + static_cast<std::ptrdiff_t>(next), addresses.end());
  report["links"] = std::move(run_links);
  return store.PutAnswer(owner, key, JsonText(report) + "\n", artifacts);
}

}  // namespace facetless
