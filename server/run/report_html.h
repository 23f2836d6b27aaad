// report.html: one self-contained file that shows a report.
//
//  1. Pictures are embedded as data URIs; the report itself (as JSON), the style and the script are embedded,
//     too. The file opens from a disk, a mail or an artifact store, in light and dark mode, and can be
//     printed.
//  2. Pixel data (render/compare/pixel_data.h) are embedded in reduced form, so that four views of 1024² stay
//     below 3 MB. Plots and the heat map are drawn from numbers.
//  3. No text of the report can become markup or script, whatever names a CAD file contains.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

// The page for the report of a render, compare or trade run, whose PNG pictures are in `directory`. Errors:
// kFileUnreadable, and the errors of ReadPng for pixel data.
Result<std::string> ReportHtml(const nlohmann::json& report, const std::string& directory);

// The page for a result of RunRegress, which names its pictures. Error: kFileUnreadable.
Result<std::string> RegressHtml(const nlohmann::json& verdict);

// Base64 encoding as in RFC 4648, with padding.
std::string Base64(const std::string& bytes);

}  // namespace facetless
