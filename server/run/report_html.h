// report.html: one file that shows a report to a person, with nothing to fetch.
//
//  1. Pictures are embedded as data URIs; so are the report itself (as JSON), the style and the script. It
//     opens from a disk, a mail or an artifact store alike, in light and dark, and prints.
//  2. Pixel data (render/compare/pixel_data.h) are embedded reduced, so that four views of 1024² stay below 3
//     MB; plots and the heat map are drawn from numbers.
//  3. No text of the report can become markup or script, whatever names a CAD file carries.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

// The page for the report of a render, a compare or a trade whose pictures (PNG) lie in `directory`. Errors:
// kFileUnreadable, and those of ReadPng for pixel data.
Result<std::string> ReportHtml(const nlohmann::json& report, const std::string& directory);

// The page for what RunRegress returned; its pictures are where it says. Error: kFileUnreadable.
Result<std::string> RegressHtml(const nlohmann::json& verdict);

// RFC 4648, with padding.
std::string Base64(const std::string& bytes);

}  // namespace facetless
