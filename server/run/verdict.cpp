#include "server/run/verdict.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "server/base/exit_code.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

std::string NumberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

// Returns the option of a threshold: "fail_depth_mm" is --fail-depth-mm on the command line.
std::string OptionOf(std::string threshold) {
  for (char& c : threshold) c = c == '_' ? '-' : c;
  return "--" + threshold;
}

}  // namespace

Json VerdictJson(const RunOptions& options, const std::vector<ViewValues>& values, const Findings& findings) {
  Json broken = Json::array();
  for (const ViewValues& view : values) {
    const auto check = [&](const char* name, const std::optional<double>& limit, double value) {
      // Written this way, a NaN exceeds the threshold.
      if (!limit || value <= *limit) return;
      broken.push_back({{"view", view.view},
                        {"threshold", name},
                        {"limit", *limit},
                        {"value", std::isfinite(value) ? Json(value) : Json(nullptr)}});
    };
    check("fail_deviation_mm", options.fail.deviation_mm, view.deviation_mm);
    check("fail_depth_mm", options.fail.depth_mm, view.depth_mm);
    check("fail_silhouette_px", options.fail.silhouette_px, view.silhouette_px);
    check("fail_flip", options.fail.flip, view.flip);
    check("fail_share", options.fail.share, view.share);
  }
  const bool incomplete = findings.lost > 0 || findings.unmeshed > 0;
  const bool failed = !broken.empty() || !findings.problems.empty() ||
                      (options.strict && (incomplete || !findings.unit_known));
  std::vector<std::string> problems = findings.problems;
  if (!findings.no_baseline.empty()) problems.push_back(findings.no_baseline);
  return {{"passed", !failed && findings.no_baseline.empty()},
          {"strict", options.strict},
          {"lost", findings.lost},
          {"unmeshed", findings.unmeshed},
          {"unit_known", findings.unit_known},
          {"problems", problems},
          {"broken", broken},
          {"exit_code", failed                          ? kExitFailed
                        : !findings.no_baseline.empty() ? kExitNoBaseline
                        : incomplete                    ? kExitLost
                                                        : kExitDone}};
}

std::vector<std::string> VerdictSentences(const Json& verdict) {
  std::vector<std::string> sentences;
  if (verdict.at("passed").get<bool>()) return sentences;
  for (const Json& broken : verdict.at("broken")) {
    const Json& value = broken.at("value");
    sentences.push_back("view '" + broken.at("view").get<std::string>() + "' breaks " +
                        OptionOf(broken.at("threshold").get<std::string>()) + ": the value is " +
                        (value.is_null() ? "infinite" : NumberText(value.get<double>())) + ", the limit is " +
                        NumberText(broken.at("limit").get<double>()));
  }
  for (const Json& problem : verdict.at("problems")) sentences.push_back(problem.get<std::string>());
  if (!verdict.at("strict").get<bool>()) return sentences;
  const auto count = [&](const char* key) { return verdict.at(key).get<std::size_t>(); };
  if (count("lost") > 0)
    sentences.push_back("--strict: the import lost " + std::to_string(count("lost")) +
                        " faces, loops or edges; `facetless inspect` names them");
  if (count("unmeshed") > 0)
    sentences.push_back("--strict: the mesh lacks " + std::to_string(count("unmeshed")) +
                        " faces of the model");
  if (!verdict.at("unit_known").get<bool>())
    sentences.push_back("--strict: the file has no length unit that can be read; set the unit with --unit");
  return sentences;
}

}  // namespace facetless
