#include "server/service/jobs/submission.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <set>
#include <utility>

#include "server/base/files.h"
#include "server/base/json_text.h"
#include "server/base/sha256.h"
#include "server/base/version.h"
#include "server/options/option_values.h"
#include "server/service/protocol/http_terms.h"
#include "server/service/store/store.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

Error Malformed(const std::string& message) {
  return {ErrorCode::kBadUsage, message};
}

Result<Json> ParseObject(const std::string& text, const std::string& what) {
  auto json = ParseJsonText(text, what);
  if (!json) return json.error();
  if (!json.value().is_object()) return Malformed(what + " must be a JSON object");
  return json;
}

std::string BodyDigest(const HttpRequest& request, JobKind kind) {
  Json parts = Json::array({JobKindName(kind)});
  for (const BodyPart& part : request.parts)
    parts.push_back({part.name, part.file_name, part.text, part.sha256});
  return Sha256Hex(JsonText(parts, -1));
}

// Returns whether the options contain the budget of a trade.
bool HasBudget(const Json& options) {
  return options.contains("budget_seconds") || options.contains("budget-seconds");
}

// Refuses two parts with the same name, because one of them would be ignored silently.
Result<void> CheckPartNames(const HttpRequest& request) {
  std::set<std::string> names;
  for (const BodyPart& part : request.parts)
    if (!names.insert(part.name).second)
      return Malformed("there are two parts " + Shortened(part.name) + "; each part is sent once");
  return {};
}

// Checks that the id of a model is a digest: 64 lower-case hexadecimal digits.
Result<void> CheckModelId(const std::string& id) {
  constexpr std::size_t kDigits = 64;
  if (id.size() == kDigits && id.find_first_not_of("0123456789abcdef") == std::string::npos) return {};
  return Malformed("model is " + Shortened(id) +
                   ", but must be the id that POST /v1/models gave: 64 hexadecimal digits");
}

Result<void> TakeParts(const HttpRequest& request, Submission& submission) {
  const bool mesh_allowed = RowOf(submission.kind).compares_mesh;
  std::vector<std::string> names = {"file", "model", "options"};
  if (mesh_allowed) names.push_back("mesh");
  if (auto once = CheckPartNames(request); !once) return once;
  for (const BodyPart& part : request.parts) {
    if (part.name == "file") {
      submission.file = &part;
    } else if (part.name == "mesh" && mesh_allowed) {
      submission.mesh = &part;
    } else if (part.name == "model") {
      if (auto id = CheckModelId(part.text); !id) return id;
      submission.model_id = part.text;
    } else if (part.name == "options") {
      auto json = ParseObject(part.text, "the part \"options\"");
      if (!json) return json.error();
      submission.options = std::move(json).value();
    } else {
      return Malformed("there is no part " + Shortened(part.name) + Suggestion(part.name, names) +
                       "; the parts are file or model, options" + (mesh_allowed ? " and mesh" : ""));
    }
  }
  return {};
}

Result<void> TakeJson(const HttpRequest& request, Submission& submission) {
  auto json = ParseObject(request.parts.empty() ? "" : request.parts.front().text, "the body");
  if (!json) return json.error();
  submission.options = std::move(json).value();
  if (!submission.options.contains("model")) return {};
  if (!submission.options["model"].is_string())
    return Malformed("model must be the id that POST /v1/models gave");
  submission.model_id = submission.options["model"].get<std::string>();
  if (auto id = CheckModelId(submission.model_id); !id) return id;
  submission.options.erase("model");
  return {};
}

// A file alone, as the body or as a part.
Result<void> TakeModelFile(const HttpRequest& request, Submission& submission) {
  if (auto once = CheckPartNames(request); !once) return once;
  for (const BodyPart& part : request.parts) {
    if (part.name == "file" || (request.parts.size() == 1 && part.name.empty())) {
      submission.file = &part;
    } else if (part.name == "options") {
      std::string takers;
      for (const JobKindRow& row : JobKinds())
        if (row.commands != 0) takers += (takers.empty() ? "" : " or ") + row.addresses.front();
      return Malformed("models take no options; send the part \"options\" to " + takers);
    } else {
      return Malformed("there is no part " + Shortened(part.name) + "; the only part is file");
    }
  }
  if (submission.file == nullptr || submission.file->path.empty())
    return Malformed("send the file as the body, or as the part \"file\" of multipart/form-data");
  return {};
}

// Returns the canonical form of the options. It does not depend on how they are written: names with - or _, a
// list or one text, an explicit default or none. Questions differ only if this form differs.
Json CanonicalOptions(const Json& given, const RunOptions& options) {
  Json asked = Json::object();
  for (const OptionRow& row : AllOptions())
    if (row.owner == OptionOwner::kCaller) asked[row.name] = row.binding.read(row, options);
  // The budget of a trade is reduced to fit the service's limits, by a smaller amount if the caller gives
  // one.
  asked["budget_given"] = HasBudget(given);
  return asked;
}

// Checks the options, and stores their canonical form in submission.asked.
Result<void> CheckOptions(Submission& submission, std::uint64_t max_samples) {
  const JobKindRow& row = RowOf(submission.kind);
  if (auto named = CheckOptionNames(row, submission.options); !named) return named;
  // The part "mesh" corresponds to the option --mesh on the command line.
  Json all = submission.options;
  if (submission.mesh != nullptr) all["mesh"] = submission.mesh->file_name;
  auto options = ParseOptions(all);
  if (!options) return options.error();
  submission.asked = CanonicalOptions(submission.options, options.value());
  if (submission.mesh == nullptr && !(options.value().mesh_unit + options.value().mesh_up).empty())
    return Malformed("mesh_unit and mesh_up are about the part \"mesh\", and there is none");
  if (auto small = CheckSamples(options.value(), max_samples); !small) return small;
  return row.check == nullptr ? Result<void>() : row.check(options.value());
}

}  // namespace

Result<void> CheckSamples(const RunOptions& options, std::uint64_t most) {
  const auto samples = CountSamples(options);
  if (!samples) return samples.error();
  if (samples.value() <= most) return {};
  return Error{ErrorCode::kLimitExceeded,
               "the request asks for " + std::to_string(samples.value()) +
                   " samples (pixels × samples per pixel × views and frames), and " + std::to_string(most) +
                   " are allowed"};
}

Result<Submission> ParseSubmission(const HttpRequest& request, JobKind kind, std::uint64_t max_samples) {
  Submission submission;
  submission.kind = kind;
  if (RowOf(kind).run == nullptr) {
    if (auto taken = TakeModelFile(request, submission); !taken) return taken.error();
  } else {
    const bool multipart = request.Header("content-type").starts_with("multipart/");
    auto taken = multipart ? TakeParts(request, submission) : TakeJson(request, submission);
    if (!taken) return taken.error();
    if ((submission.file != nullptr) == !submission.model_id.empty())
      return Malformed(
          "give either a file (multipart part \"file\") or a model (the id that POST /v1/models gave)");
    if (auto checked = CheckOptions(submission, max_samples); !checked) return checked.error();
  }
  if (submission.file != nullptr) submission.model_id = submission.file->sha256;
  const Json identity = {{"version", Version()},
                         {"kind", JobKindName(kind)},
                         {"model", submission.model_id},
                         {"mesh", submission.mesh != nullptr ? submission.mesh->sha256 : ""},
                         {"options", submission.asked}};
  submission.question = Sha256Hex(JsonText(identity, -1));
  submission.body = BodyDigest(request, kind);
  return submission;
}

Json JobRequestJson(const Submission& submission) {
  Json json = {{"model", submission.model_id}, {"options", submission.options}};
  if (submission.file != nullptr) json["name"] = SafeFileName(submission.file->file_name);
  if (submission.mesh != nullptr) {
    json["mesh"] = submission.mesh->sha256;
    json["mesh_name"] = SafeFileName(submission.mesh->file_name);
  }
  return json;
}

Result<JobRequest> ParseJobRequest(const Json& json) {
  JobRequest request;
  if (!json.is_object() || !json.contains("options"))
    return Error{ErrorCode::kInternal, "the job's request is not well-formed"};
  request.model_id = json.value("model", "");
  request.file_name = json.value("name", "");
  request.mesh = json.value("mesh", "");
  request.mesh_name = json.value("mesh_name", "");
  request.budget_given = HasBudget(json["options"]);
  auto options = ParseOptions(json["options"]);
  if (!options) return options.error();
  request.options = std::move(options).value();
  return request;
}

double WaitSeconds(const std::string& prefer, double usual, double most) {
  double seconds = usual;
  for (std::size_t begin = 0; begin < prefer.size();) {
    const std::size_t end = std::min(prefer.find_first_of(",;", begin), prefer.size());
    std::string word = prefer.substr(begin, end - begin);
    word.erase(std::remove_if(word.begin(), word.end(), [](unsigned char c) { return std::isspace(c) != 0; }),
               word.end());
    if (word == "respond-async" && prefer.find("wait") == std::string::npos) seconds = 0;
    if (word.starts_with("wait=")) seconds = std::strtod(word.c_str() + 5, nullptr);
    begin = end + 1;
  }
  // Written in this form, the condition treats NaN as no wait.
  return seconds > 0 ? std::min(seconds, most) : 0;
}

}  // namespace facetless
