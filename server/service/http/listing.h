// Lists that are read page by page: GET /v1/models and GET /v1/jobs.
//
//  1. `limit` is 1 … 1000, 100 without one; `after` is the id of the last entry of the page before.
//  2. The answer has the list under its name, and "next": the address of the next page, null on the last one.
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

// Error: kBadUsage: a limit out of range, an `after` of other characters or length than an id, and any other
// name.
Result<PageRequest> ParsePageRequest(const std::map<std::string, std::string>& query, std::size_t id_digits);

// Law 2. `entries` has one more than `page.limit` where there is a next page; each has an "id".
nlohmann::json PageJson(const std::string& path, const std::string& name, const PageRequest& page,
                        nlohmann::json entries);

}  // namespace facetless
