#include "server/service/jobs/job_runs.h"

#include <algorithm>
#include <utility>

#include "server/run/run.h"
#include "server/run/trade.h"
#include "server/service/protocol/http_terms.h"

namespace facetless {
namespace {

// The number of points of a trade that fit into the job's time at least, if the caller gives no budget.
constexpr double kTradePoints = 20;

// Translates the reason of a result without a baseline to the terms of HTTP.
Result<RunResult> TranslateReportToHttp(JobInputs& inputs, Result<RunResult> result,
                                        const std::string& directory) {
  if (!result || !result.value().no_baseline) return result;
  NoBaseline why = *result.value().no_baseline;
  why.message = TranslateToHttpTerms(why.message);
  inputs.Say(why.message);
  return WithReason(std::move(result).value(), why, directory);
}

}  // namespace

Result<RunResult> RunRenderJob(JobInputs& inputs, const std::string& directory) {
  const auto model = inputs.Model();
  if (!model) return model.error();
  return RunRender(*model.value(), inputs.Options(), directory, inputs.Context());
}

Result<RunResult> RunComparisonJob(JobInputs& inputs, const std::string& directory) {
  const auto mesh = inputs.MakeMesh();
  if (!mesh) return mesh.error();
  const auto model = inputs.Model();
  if (!model) return model.error();
  const RunOptions options = inputs.Options();
  const RunContext context = inputs.Context();
  auto result = mesh.value().mesh
                    ? RunCompare(*model.value(), *mesh.value().mesh, options, directory, context)
                    : RunWithoutBaseline(*model.value(), mesh.value().none, options, directory, context);
  return TranslateReportToHttp(inputs, std::move(result), directory);
}

Result<RunResult> RunTradeJob(JobInputs& inputs, const std::string& directory) {
  const auto model = inputs.Model();
  if (!model) return model.error();
  const RunLimits& limits = inputs.limits();
  RunOptions options = inputs.Options();
  const double budget_s = limits.timeout_s / (inputs.request().budget_given ? 1 : kTradePoints);
  options.trade.budget_s = std::min(options.trade.budget_s, budget_s);
  options.trade.budget_mb =
      std::min({options.trade.budget_mb, limits.import_memory_mb, limits.max_view_bytes >> 20});
  auto request = inputs.AnotherImport();
  if (!request) return request.error();
  request.value().progress = nullptr;
  auto result = RunTrade(request.value(), *model.value(), options, directory, inputs.Context());
  if (!result) return result.error();
  return std::move(result).value().run;
}

}  // namespace facetless
