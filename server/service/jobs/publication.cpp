#include "server/service/jobs/publication.h"

#include <map>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/base/files.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

class Publication {
 public:
  Publication(Store& store, const std::string& directory) : store_(store), directory_(directory) {}

  // The address of a file of the run.
  Result<std::string> Add(const std::string& name) {
    auto kept = store_.AddFile(directory_ + "/" + name, "");
    if (!kept) return kept.error();
    const std::string artifact = kept.value().sha256 + "." + name.substr(name.rfind('.') + 1);
    artifacts_.emplace_back(artifact, std::move(kept).value());
    return "/v1/artifacts/" + artifact;
  }
  const std::vector<std::pair<std::string, StoredFile>>& artifacts() const { return artifacts_; }

 private:
  Store& store_;
  const std::string& directory_;
  std::vector<std::pair<std::string, StoredFile>> artifacts_;
};

}  // namespace

Result<void> PublishRun(Store& store, const std::string& owner, const std::string& key,
                        const std::string& model_id, RunResult result, const std::string& directory) {
  Publication publication(store, directory);
  Json& report = result.report;
  Json run_links = {{"model", "/v1/models/" + model_id}, {"self", "/v1/answers/" + key}};
  std::map<std::string, Json> view_links;
  for (const RunFile& file : result.files.list()) {
    auto address = publication.Add(file.name);
    if (!address) return address.error();
    (file.view.empty() ? run_links : view_links[file.view])[file.role] = std::move(address).value();
  }
  for (Json& view : report["views"]) view["links"] = view_links[view.at("name").get<std::string>()];
  if (!result.files.frames().empty()) {
    Json frames = Json::array();
    for (const std::string& name : result.files.frames()) {
      auto address = publication.Add(name);
      if (!address) return address.error();
      frames.push_back(std::move(address).value());
    }
    report["turntable"]["links"] = std::move(frames);
  }
  report["links"] = std::move(run_links);
  return store.PutAnswer(owner, key, JsonText(report) + "\n", publication.artifacts());
}

}  // namespace facetless
