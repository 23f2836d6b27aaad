// `facetless trade`: speed against accuracy, measured for one file. docs/trade.md describes what it gives.
//
//  1. DIR receives report.json (with "trade"), report.html, for each view NAME.direct.png (the reference),
//     and trade-time and trade-memory as .svg and .png; with several views NAME.trade-time and so on.
//  2. Each tessellation is an import of its own, so that one that explodes takes none of the others with it.
//     They are made coarse first; what refines one that exceeded its budget is not tried. A point that was
//     not measured is in the report with its reason.
//  3. The budgets are of a point: seconds of meshing, of building the tree, of one view traced and shaded;
//     bytes of the mesher beyond what reading the file takes, of the mesh and its tree, of the leaves. The
//     reference has no budget but options.timeout_s.
//  4. What the file hides is measured by neither tracer, unless the options show it. The mesher is timed on
//     all that the file holds.
#pragma once

#include <string>

#include "server/run/run.h"

namespace facetless {

struct TradeResult {
  RunResult run;
  std::string text;  // tables and answers, for a terminal
};

// `request` is of the file, without meshes; `imported` is what it gave. Errors: kBadUsage (cameras, nothing
// is shown), kLimitExceeded, kCancelled, kWriteFailed, and those of RenderView.
Result<TradeResult> RunTrade(const ImportRequest& request, const ImportedModel& imported,
                             const RunOptions& options, const std::string& directory,
                             const RunContext& context);

}  // namespace facetless
