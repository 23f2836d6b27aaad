#include "server/service/http/listing.h"

#include <charconv>
#include <utility>

#include "server/options/option_values.h"

namespace facetless {
namespace {

constexpr std::size_t kMostEntries = 1000;

Result<std::size_t> ParseLimit(const std::string& text) {
  std::size_t limit = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), limit);
  if (parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size() && limit >= 1 &&
      limit <= kMostEntries)
    return limit;
  return BadUsage("limit is " + Shortened(text) + ", but must be a whole number from 1 to " +
                  std::to_string(kMostEntries));
}

}  // namespace

Result<PageRequest> ParsePageRequest(const std::map<std::string, std::string>& query, std::size_t id_digits) {
  PageRequest page;
  for (const auto& [name, value] : query) {
    if (name == "limit") {
      const auto limit = ParseLimit(value);
      if (!limit) return limit.error();
      page.limit = limit.value();
    } else if (name == "after") {
      if (value.size() != id_digits || value.find_first_not_of("0123456789abcdef") != std::string::npos)
        return BadUsage("after is " + Shortened(value) + ", but must be an id: " + std::to_string(id_digits) +
                        " hexadecimal digits");
      page.after = value;
    } else {
      return BadUsage("there is no parameter " + Shortened(name) + Suggestion(name, {"limit", "after"}) +
                      "; the parameters are limit and after");
    }
  }
  return page;
}

nlohmann::json PageJson(const std::string& path, const std::string& name, const PageRequest& page,
                        nlohmann::json entries) {
  nlohmann::json next;
  if (entries.size() > page.limit) {
    entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(page.limit), entries.end());
    next = path + "?limit=" + std::to_string(page.limit) +
           "&after=" + entries.back().at("id").get<std::string>();
  }
  return {{name, std::move(entries)}, {"next", std::move(next)}};
}

}  // namespace facetless
