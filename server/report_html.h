// report.html: one file that shows a report to a person, with nothing to fetch.
//
//  1. Pictures are embedded as data URIs; so are the report itself (as JSON), the style and the script. It
//     opens from a disk, a mail or an artifact store alike, in light and dark, and prints.
//  2. No text of the report can become markup or script, whatever names a CAD file carries.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/model/result.h"

namespace facetless {

// The page for a report whose pictures (PNG) and plots (SVG) lie in `directory`. Error: kFileUnreadable.
Result<std::string> ReportHtml(const nlohmann::json& report, const std::string& directory);

// RFC 4648, with padding.
std::string Base64(const std::string& bytes);

}  // namespace facetless
