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

Verdict Judge(const RunOptions& options, const std::vector<ViewValues>& values, const Findings& findings) {
  Verdict verdict;
  verdict.strict = options.strict;
  verdict.lost = findings.lost;
  verdict.unmeshed = findings.unmeshed;
  verdict.unit_known = findings.unit_known;
  for (const ViewValues& view : values) {
    const auto check = [&](const char* name, const std::optional<double>& limit, double value) {
      // Written this way, a NaN exceeds the threshold.
      if (!limit || value <= *limit) return;
      verdict.broken.push_back({view.view, name, *limit, value});
    };
    check("fail_deviation_mm", options.fail.deviation_mm, view.deviation_mm);
    check("fail_depth_mm", options.fail.depth_mm, view.depth_mm);
    check("fail_silhouette_px", options.fail.silhouette_px, view.silhouette_px);
    check("fail_flip", options.fail.flip, view.flip);
    check("fail_share", options.fail.share, view.share);
  }
  const bool incomplete = findings.lost > 0 || findings.unmeshed > 0;
  const bool failed = !verdict.broken.empty() || !findings.problems.empty() ||
                      (options.strict && (incomplete || !findings.unit_known));
  verdict.problems = findings.problems;
  if (!findings.no_baseline.empty()) verdict.problems.push_back(findings.no_baseline);
  verdict.passed = !failed && findings.no_baseline.empty();
  verdict.exit_code = failed                          ? kExitFailed
                      : !findings.no_baseline.empty() ? kExitNoBaseline
                      : incomplete                    ? kExitLost
                                                      : kExitDone;
  return verdict;
}

Json VerdictJson(const Verdict& verdict) {
  Json broken = Json::array();
  for (const BrokenThreshold& threshold : verdict.broken)
    broken.push_back({{"view", threshold.view},
                      {"threshold", threshold.threshold},
                      {"limit", threshold.limit},
                      {"value", std::isfinite(threshold.value) ? Json(threshold.value) : Json(nullptr)}});
  return {{"passed", verdict.passed},
          {"strict", verdict.strict},
          {"lost", verdict.lost},
          {"unmeshed", verdict.unmeshed},
          {"unit_known", verdict.unit_known},
          {"problems", verdict.problems},
          {"broken", broken},
          {"exit_code", verdict.exit_code}};
}

std::vector<std::string> VerdictSentences(const Verdict& verdict) {
  std::vector<std::string> sentences;
  if (verdict.passed) return sentences;
  for (const BrokenThreshold& broken : verdict.broken)
    sentences.push_back("view '" + broken.view + "' breaks " + OptionOf(broken.threshold) +
                        ": the value is " +
                        (std::isfinite(broken.value) ? NumberText(broken.value) : "infinite") +
                        ", the limit is " + NumberText(broken.limit));
  sentences.insert(sentences.end(), verdict.problems.begin(), verdict.problems.end());
  if (!verdict.strict) return sentences;
  if (verdict.lost > 0)
    sentences.push_back("--strict: the import lost " + std::to_string(verdict.lost) +
                        " faces, loops or edges; `facetless inspect` names them");
  if (verdict.unmeshed > 0)
    sentences.push_back("--strict: the mesh lacks " + std::to_string(verdict.unmeshed) +
                        " faces of the model");
  if (!verdict.unit_known)
    sentences.push_back("--strict: the file has no length unit that can be read; set the unit with --unit");
  return sentences;
}

}  // namespace facetless
