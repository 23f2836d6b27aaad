#include "server/service/jobs/publication.h"

#include "server/base/files.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

class Publication {
 public:
  Publication(Store& store, const std::string& directory) : store_(store), directory_(directory) {}

  // The address of a file of the run.
  Result<std::string> Add(const std::string& name) {
    auto kept = store_.Keep(directory_ + "/" + name, "");
    if (!kept) return kept.error();
    const std::string artifact = kept.value().sha256 + "." + name.substr(name.rfind('.') + 1);
    artifacts_.emplace_back(artifact, std::move(kept).value());
    return "/v1/artifacts/" + artifact;
  }
  // Adds `links[role]`.
  Result<void> Link(Json& links, const std::string& role, const std::string& name) {
    auto address = Add(name);
    if (!address) return address.error();
    links[role] = std::move(address).value();
    return {};
  }
  const std::vector<std::pair<std::string, KeptFile>>& artifacts() const { return artifacts_; }

 private:
  Store& store_;
  const std::string& directory_;
  std::vector<std::pair<std::string, KeptFile>> artifacts_;
};

}  // namespace

Result<void> PublishRun(Store& store, const std::string& owner, const std::string& question,
                        const std::string& model_id, Json report, const std::string& directory) {
  Publication publication(store, directory);
  for (Json& view : report["views"]) {
    Json links = Json::object();
    for (const auto& [role, file] : view["files"].items()) {
      if (auto linked = publication.Link(links, role, file.get<std::string>()); !linked) return linked;
    }
    const Json plots = view.value("plots", Json::object());
    for (const auto& [cost, files] : plots.items()) {
      for (const auto& [type, file] : files.items()) {
        const std::string role = "trade-" + cost + "." + type;
        if (auto linked = publication.Link(links, role, file.get<std::string>()); !linked) return linked;
      }
    }
    view["links"] = std::move(links);
  }
  if (report.contains("turntable")) {
    Json& turntable = report["turntable"];
    turntable["links"] = Json::array();
    for (const Json& frame : turntable["frames"]) {
      auto address = publication.Add(frame.get<std::string>());
      if (!address) return address.error();
      turntable["links"].push_back(std::move(address).value());
    }
  }
  Json links = {{"model", "/v1/models/" + model_id}, {"self", "/v1/answers/" + question}};
  const Json files = report.value("files", Json::object());
  for (const auto& [role, file] : files.items()) {
    if (auto linked = publication.Link(links, role, file.get<std::string>()); !linked) return linked;
  }
  for (const auto& [role, name] : {std::pair{"report", "report.json"}, {"page", "report.html"}}) {
    if (auto linked = publication.Link(links, role, name); !linked) return linked;
  }
  report["links"] = std::move(links);
  return store.PutAnswer(owner, question, JsonText(report) + "\n", publication.artifacts());
}

}  // namespace facetless
