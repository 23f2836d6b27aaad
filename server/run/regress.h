// `facetless regress`: compares renderings with references, for CI. docs/regression.md describes the
// manifest.
//
//  1. Paths in a manifest are relative to the manifest's directory.
//  2. A reference is NAME.VIEW.png and, if depth_mm or silhouette_px is limited, NAME.VIEW.depth.tif.
//  3. A view passes if no tolerance is exceeded. The default tolerance is 0 for "max" (the direct image has
//     the same bytes everywhere); the others have no default. A missing reference fails. An error in one file
//     does not prevent the other files from running.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/image/film.h"
#include "render/image/io.h"
#include "server/options/options.h"
#include "server/run/run.h"

namespace facetless {

struct RegressRequest {
  std::string manifest;
  std::string out;      // directory of report.html and of the pictures of failed views; empty: not written
  bool update = false;  // write the references
  ImportLimits import_limits;
  double unit_mm = 0;  // if above 0: the unit of files for which the manifest gives none
  RunContext context;
};

struct RegressResult {
  // {"facetless", "command", "manifest", "updated", "passed", "exit_code", "files": [{"file", "name", "passed",
  // "error"?, "lost", "views": [{"name", "passed", "status", "values", "broken", "files"?}]}]}.
  nlohmann::json verdict;
  // 0; 2 a tolerance is broken or a reference is missing; 3 sizes differ; 4 nothing usable in one of the files.
  int exit_code = 0;
  // One for each tolerance that is broken, each reference that is missing, and each file with an error.
  std::vector<std::string> failures;
};

// Errors: kFileUnreadable, kBadUsage (the manifest); kCancelled; kWriteFailed.
Result<RegressResult> RunRegress(const RegressRequest& request);

// The three pictures next to each other, with a gap. All must have the same size. Transparent pixels are
// shown on white.
Image8 SideBySide(const Image8& a, const Image8& b, const Image8& c);

// The FLIP error as a picture: from black, where nothing differs, through red and yellow to white.
Image8 ErrorPicture(const std::vector<float>& errors, int width, int height);

struct DepthDifference {
  double max_mm = 0;                    // where both hit
  std::uint64_t silhouette_pixels = 0;  // hit by exactly one
};
// Compares two depth images. Errors: kSizeMismatch, kNotFinite (NaN).
Result<DepthDifference> CompareDepths(const DepthImage& a, const DepthImage& b);

}  // namespace facetless
