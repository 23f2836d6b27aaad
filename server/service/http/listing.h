// Paginated lists: GET /v1/models and GET /v1/jobs.
//
//  1. `limit` is 1 … 1000 (default: 100). `after` is the id of the last entry of the previous page.
//  2. The answer has the list under its name, and "next", the address of the next page, which is null on the
//     last page.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

struct PageRequest {
  std::size_t limit = 100;
  std::string after;  // "" for the first page
};

// Parses the query of a list. Error: kBadUsage (the limit is out of range, `after` does not have the form of
// an id, or the query has another name).
Result<PageRequest> ParsePageRequest(const std::map<std::string, std::string>& query, std::size_t id_digits);

// Makes the answer of law 2. `entries` has page.limit + 1 entries if there is a next page. Each entry has an
// "id".
nlohmann::json PageJson(const std::string& path, const std::string& name, const PageRequest& page,
                        nlohmann::json entries);

}  // namespace facetless
