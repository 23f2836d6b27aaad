#include "server/service/protocol/http_terms.h"

#include "server/options/option_table.h"

namespace facetless {
namespace {

bool IsOptionCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
}

}  // namespace

std::string TranslateToHttpTerms(const std::string& sentence) {
  std::string text;
  for (std::size_t i = 0; i < sentence.size();) {
    // Find an option: two dashes and a word, at the beginning of a word.
    std::size_t end = i;
    const bool begins = i == 0 || sentence[i - 1] == ' ' || sentence[i - 1] == '(' || sentence[i - 1] == '"';
    if (begins && sentence.compare(i, 2, "--") == 0)
      for (end = i + 2; end < sentence.size() && IsOptionCharacter(sentence[end]);) ++end;
    if (end < i + 3) {
      text += sentence[i++];
      continue;
    }
    const std::string flag = sentence.substr(i, end - i);
    const OptionRow* row = FindOption(flag.substr(2));
    text += row == nullptr                            ? flag
            : row->owner == OptionOwner::kCaller      ? row->name
            : row->owner == OptionOwner::kOperator    ? "the service's own option " + flag
            : row->owner == OptionOwner::kCommandLine ? flag
                                                      : "the part " + row->name;
    i = end;
  }
  return text;
}

}  // namespace facetless
