// `facetless trade`: measures speed against accuracy for one file. docs/trade.md describes the results.
//
//  1. DIR receives report.json (with "trade"), report.html, for each view NAME.direct.png (the reference),
//     and trade-time and trade-memory as .svg and .png; with several views NAME.trade-time and so on.
//  2. Each tessellation is a separate import, so that the failure of one does not affect the others. Coarse
//     ones are made first; if one exceeds its budget, its refinements are not tried. A point that was not
//     measured is in the report with the reason.
//  3. The budgets apply to each point: the seconds of meshing, of building the tree, and of tracing and
//     shading one view; the memory of the mesher beyond that of reading the file, of the mesh and its tree,
//     and of the leaves. The reference has no budget except options.timeout_s.
//  4. Parts that the file hides are not measured, unless the options show them. The time of the mesher is for
//     the whole file.
#pragma once

#include <string>

#include "server/run/run.h"

namespace facetless {

struct TradeResult {
  RunResult run;
  std::string text;  // tables and answers, for a terminal
};

// Runs the measurements. `request` is the import of the file without meshes, and `imported` its result.
// Errors: kBadUsage (cameras, or nothing is shown), kLimitExceeded, kCancelled, kWriteFailed, and the errors
// of RenderView.
Result<TradeResult> RunTrade(const ImportRequest& request, const ImportedModel& imported,
                             const RunOptions& options, const std::string& directory,
                             const RunContext& context);

}  // namespace facetless
