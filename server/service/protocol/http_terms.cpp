#include "server/service/protocol/http_terms.h"

#include <algorithm>
#include <array>

#include "server/options/options.h"

namespace facetless {
namespace {

bool IsOptionCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
}

}  // namespace

bool IsRequestOption(std::string_view name) {
  // The mesh is a part of the body; the others concern the machine.
  constexpr std::array<std::string_view, 6> kNot = {"mesh",           "threads",       "timeout",
                                                    "import_timeout", "import_memory", "max_view_memory"};
  const auto& names = OptionNames();
  return std::find(kNot.begin(), kNot.end(), name) == kNot.end() &&
         std::find(names.begin(), names.end(), name) != names.end();
}

std::string InHttpTerms(const std::string& sentence) {
  std::string text;
  for (std::size_t i = 0; i < sentence.size();) {
    // An option: two dashes and a word, at the beginning of a word.
    std::size_t end = i;
    const bool begins = i == 0 || sentence[i - 1] == ' ' || sentence[i - 1] == '(' || sentence[i - 1] == '"';
    if (begins && sentence.compare(i, 2, "--") == 0)
      for (end = i + 2; end < sentence.size() && IsOptionCharacter(sentence[end]);) ++end;
    if (end < i + 3) {
      text += sentence[i++];
      continue;
    }
    const std::string flag = sentence.substr(i, end - i);
    std::string name = flag.substr(2);
    std::replace(name.begin(), name.end(), '-', '_');
    const auto& names = OptionNames();
    const bool known = std::find(names.begin(), names.end(), name) != names.end();
    text += IsRequestOption(name) ? name
            : name == "mesh"      ? "the part mesh"
            : known               ? "the service's own option " + flag
                                  : flag;
    i = end;
  }
  return text;
}

}  // namespace facetless
