// Changes STEP, IGES and glTF files by their own syntax.
#include <cctype>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "tests/verify/mutations/mutate.h"

namespace facetless {
namespace {

// Texts that no exporter should write instead of a number, but that some do.
constexpr const char* kNumbers[] = {
    "1.E308",      "-1.E308", "1.E400", "1.E150",         "1.E-320", "4.9E-324",   "NaN",        "Inf", "-0.",
    "0.",          "-1.",     "1.E-30", "2147483647",     "-1",      "2147483648", "4294967296", "0",   "1e9",
    "99999999999", "1.#IND",  "0x7f",   "9.999999999999", "1E15",    "250"};

struct Token {
  std::size_t begin = 0, end = 0;
  std::size_t length() const { return end - begin; }
};

bool IsDigit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

bool IsWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// The tokens of a STEP text outside of comments.
struct StepTokens {
  std::vector<Token> references, numbers, keywords, strings, enumerations;
  std::vector<Token> entities;  // from the "#" of "#1" to the semicolon
  std::vector<Token> lists;     // from a parenthesis to the one that closes it
};

StepTokens StepTokensOf(const std::string& bytes) {
  StepTokens tokens;
  std::vector<std::size_t> open;
  std::size_t entity = std::string::npos;
  for (std::size_t at = bytes.find("DATA;") == std::string::npos ? bytes.size() : bytes.find("DATA;") + 5;
       at < bytes.size();) {
    const std::size_t begin = at;
    const char c = bytes[at];
    const auto while_true = [&](auto&& is) {
      while (at < bytes.size() && is(bytes[at])) ++at;
    };
    if (c == '#') {
      ++at;
      while_true(IsDigit);
      const std::size_t after = bytes.find_first_not_of(" \r\n", at);
      if (after != std::string::npos && bytes[after] == '=') {
        entity = begin;
      } else {
        tokens.references.push_back({begin, at});
      }
    } else if (c == '\'') {
      at = std::min(bytes.find('\'', at + 1), bytes.size() - 1) + 1;
      tokens.strings.push_back({begin, at});
    } else if (c == '.' && at + 1 < bytes.size() && std::isalpha(static_cast<unsigned char>(bytes[at + 1]))) {
      at = std::min(bytes.find('.', at + 1), bytes.size() - 1) + 1;
      tokens.enumerations.push_back({begin, at});
    } else if (IsDigit(c) || ((c == '-' || c == '+') && at + 1 < bytes.size() && IsDigit(bytes[at + 1]))) {
      ++at;
      while_true(
          [](char d) { return IsDigit(d) || d == '.' || d == 'E' || d == 'e' || d == '-' || d == '+'; });
      tokens.numbers.push_back({begin, at});
    } else if (std::isalpha(static_cast<unsigned char>(c))) {
      while_true(IsWord);
      tokens.keywords.push_back({begin, at});
    } else {
      ++at;
      if (c == '(') open.push_back(begin);
      if (c == ')' && !open.empty()) {
        tokens.lists.push_back({open.back(), at});
        open.pop_back();
      }
      if (c == ';' && entity != std::string::npos) {
        tokens.entities.push_back({entity, at});
        entity = std::string::npos;
      }
    }
  }
  return tokens;
}

std::string Text(const std::string& bytes, const Token& token) {
  return bytes.substr(token.begin, token.length());
}

const Token* Any(const std::vector<Token>& tokens, Dice& dice) {
  return tokens.empty() ? nullptr : &tokens[dice.Below(tokens.size())];
}

// Replaces one of the tokens `of` by another one.
std::string Swap(std::string& bytes, const std::vector<Token>& of, const char* name, Dice& dice) {
  const Token *to = Any(of, dice), *from = Any(of, dice);
  if (to == nullptr) return "";
  const std::string old = Text(bytes, *to), other = Text(bytes, *from);
  bytes.replace(to->begin, to->length(), other);
  return std::string(name) + " " + old.substr(0, 40) + " becomes " + other.substr(0, 40);
}

std::string StrangeText(Dice& dice) {
  switch (dice.Below(5)) {
    case 0:
      return "'" + std::string(std::size_t{1} << (10 + dice.Below(11)), 'x') + "'";
    case 1:
      return "'\\X2\\D83D\\X0\\\\X4\\FFFFFFFF\\X0\\\\S\\'";
    case 2:
      return "'\xff\xc0\x80 ''";
    case 3:
      return "'../../../../etc/passwd'";
    default:
      return "'%s%n%1000000d'";
  }
}

// Changes a reference to the entity that contains it, to another entity, or to none.
std::string Redirect(std::string& bytes, const StepTokens& tokens, Dice& dice) {
  const Token* reference = Any(tokens.references, dice);
  if (reference == nullptr || tokens.entities.empty()) return "";
  std::string target = "#999999999";
  if (dice.OneIn(3)) {
    // Make a cycle of one entity.
    for (const Token& entity : tokens.entities)
      if (entity.begin < reference->begin && reference->begin < entity.end)
        target =
            bytes.substr(entity.begin, bytes.find_first_not_of("#0123456789", entity.begin) - entity.begin);
  } else if (!dice.OneIn(3)) {
    target = Text(bytes, *Any(tokens.references, dice));
  }
  const std::string old = Text(bytes, *reference);
  bytes.replace(reference->begin, reference->length(), target);
  return "reference " + old + " becomes " + target;
}

std::string ChangeList(std::string& bytes, const StepTokens& tokens, Dice& dice) {
  const Token* list = Any(tokens.lists, dice);
  if (list == nullptr) return "";
  const std::string old = Text(bytes, *list);
  switch (dice.Below(4)) {
    case 0:
      bytes.replace(list->begin, list->length(), "()");
      return "a list is emptied";
    case 1: {
      const std::size_t depth = std::size_t{1} << dice.Below(15);
      bytes.replace(list->begin, list->length(), std::string(depth, '(') + old + std::string(depth, ')'));
      return "a list in " + std::to_string(depth) + " others";
    }
    case 2: {
      std::string longer = old.substr(0, old.size() - 1);
      for (std::size_t i = std::size_t{1} << dice.Below(8); i > 0 && longer.size() < (1 << 20); --i)
        longer += "," + old.substr(1, old.size() - 2);
      bytes.replace(list->begin, list->length(), longer + ")");
      return "a list is repeated";
    }
    default: {
      const std::size_t comma = old.rfind(',');
      if (comma == std::string::npos) return "";
      bytes.replace(list->begin, list->length(), old.substr(0, comma) + ")");
      return "a list loses its end";
    }
  }
}

// Fields of eight columns, as in IGES.
std::string Columns(const std::string& text, std::size_t width) {
  return text.size() >= width ? text.substr(0, width) : std::string(width - text.size(), ' ') + text;
}

}  // namespace

std::string MutateStep(std::string& bytes, Dice& dice) {
  const StepTokens tokens = StepTokensOf(bytes);
  switch (dice.Below(12)) {
    case 0:
    case 1:
    case 2: {
      const Token* number = Any(tokens.numbers, dice);
      if (number == nullptr) return "";
      const std::string other = dice.Pick(kNumbers), old = Text(bytes, *number);
      bytes.replace(number->begin, number->length(), other);
      return "number " + old + " becomes " + other;
    }
    case 3:
    case 4:
    case 5:
      return Redirect(bytes, tokens, dice);
    case 6:
      return Swap(bytes, tokens.keywords, "keyword", dice);
    case 7:
      return Swap(bytes, tokens.enumerations, "value", dice);
    case 8: {
      const Token* string = Any(tokens.strings, dice);
      if (string == nullptr) return "";
      bytes.replace(string->begin, string->length(), StrangeText(dice));
      return "a strange text";
    }
    case 9: {
      const Token* entity = Any(tokens.entities, dice);
      if (entity == nullptr) return "";
      const std::string text = Text(bytes, *entity);
      const bool twice = dice.OneIn(2);
      bytes.replace(entity->begin, entity->length(), twice ? text + "\n" + text : "");
      return (twice ? "twice: " : "removed: ") + text.substr(0, 40);
    }
    case 10: {
      // Two entities exchange their contents.
      const Token *a = Any(tokens.entities, dice), *b = Any(tokens.entities, dice);
      if (a == nullptr || a->begin == b->begin) return "";
      const auto body = [&](const Token& token) { return bytes.find('=', token.begin); };
      const std::string other = bytes.substr(body(*b), b->end - body(*b));
      bytes.replace(body(*a), a->end - body(*a), other);
      return "an entity becomes another one";
    }
    default:
      return ChangeList(bytes, tokens, dice);
  }
}

std::string MutateIges(std::string& bytes, Dice& dice) {
  // Lines have 80 columns and a line end.
  std::vector<std::size_t> directory, parameter, others;
  for (std::size_t at = 0; at + 73 <= bytes.size();) {
    (bytes[at + 72] == 'D' ? directory : bytes[at + 72] == 'P' ? parameter : others).push_back(at);
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) break;
    at = end + 1;
  }
  if (directory.empty() || parameter.empty()) return "";
  switch (dice.Below(6)) {
    case 0:
    case 1: {
      // Change a field of the directory: type, pointers, counts, status.
      const std::size_t line = directory[dice.Below(directory.size())];
      const std::size_t field = dice.Below(9) * 8;
      const std::string own = bytes.substr(line + 73, 7);
      const std::string values[] = {own,   "0",   "-1",  "99999999", "100", "102", "124",
                                    "126", "128", "142", "144",      "308", "402", "408",
                                    "510", "514", "186", "3",        "7",   "190"};
      const std::string value = dice.Pick(values);
      bytes.replace(line + field, 8, Columns(value, 8));
      return "directory field " + std::to_string(field / 8 + 1) + " becomes " + value;
    }
    case 2:
    case 3: {
      // Change a number in the parameters, within its columns.
      const std::size_t line = parameter[dice.Below(parameter.size())];
      std::vector<Token> numbers;
      for (std::size_t at = line; at < line + 64;) {
        const std::size_t end = bytes.find_first_of(",;", at);
        if (end == std::string::npos || end > line + 64) break;
        numbers.push_back({at, end});
        at = end + 1;
      }
      const Token* number = Any(numbers, dice);
      if (number == nullptr) return "";
      const std::string other = dice.OneIn(3) ? bytes.substr(line + 65, 7) : dice.Pick(kNumbers);
      bytes.replace(number->begin, number->length(), Columns(other, number->length()));
      return "parameter becomes " + other.substr(0, number->length());
    }
    case 4: {
      // Remove a line, duplicate it, or replace it by another one.
      const std::vector<std::size_t>& lines = dice.OneIn(2) ? directory : parameter;
      const std::size_t line = lines[dice.Below(lines.size())], other = lines[dice.Below(lines.size())];
      const std::size_t length = std::min(bytes.find('\n', line), bytes.size() - 1) + 1 - line;
      const std::string text =
          bytes.substr(other, std::min(bytes.find('\n', other), bytes.size() - 1) + 1 - other);
      const std::size_t how = dice.Below(3);
      bytes.replace(line, length, how == 0 ? "" : how == 1 ? bytes.substr(line, length) + text : text);
      return how == 0 ? "a line is lost" : how == 1 ? "a line is put in" : "a line becomes another one";
    }
    default: {
      // Change the global section: delimiters, unit, scale.
      for (const std::size_t line : others) {
        if (bytes[line + 72] != 'G') continue;
        const std::size_t at = line + dice.Below(72);
        constexpr char kCharacters[] = {',', ';', 'H', '9', '0', ' ', '-', '.', '1'};
        bytes[at] = dice.Pick(kCharacters);
        return "global section, column " + std::to_string(at - line + 1);
      }
      return "";
    }
  }
}

std::string MutateGltf(std::string& bytes, Dice& dice) {
  constexpr std::size_t kHeader = 20;
  if (bytes.size() < kHeader) return "";
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  if (length > bytes.size() - kHeader) return "";
  std::string json = bytes.substr(kHeader, length);
  std::vector<Token> numbers, strings;
  for (std::size_t at = 0; at < json.size();) {
    const std::size_t begin = at;
    if (json[at] == '"') {
      at = std::min(json.find('"', at + 1), json.size() - 1) + 1;
      strings.push_back({begin, at});
    } else if (IsDigit(json[at]) || json[at] == '-') {
      at = std::min(json.find_first_not_of("0123456789.eE+-", at), json.size());
      numbers.push_back({begin, at});
    } else {
      ++at;
    }
  }
  std::string what;
  if (!dice.OneIn(4)) {
    const Token* number = Any(numbers, dice);
    if (number == nullptr) return "";
    constexpr const char* kJsonNumbers[] = {"0",
                                            "-1",
                                            "1",
                                            "4294967295",
                                            "4294967296",
                                            "2147483648",
                                            "1e400",
                                            "1e38",
                                            "-1e38",
                                            "0.5",
                                            "9007199254740993",
                                            "5120",
                                            "5121",
                                            "5125",
                                            "5126",
                                            "18446744073709551615",
                                            "[]",
                                            "null",
                                            "\"text\"",
                                            "{}"};
    const std::string other = dice.Pick(kJsonNumbers);
    what = "number " + Text(json, *number) + " becomes " + other;
    json.replace(number->begin, number->length(), other);
  } else {
    what = Swap(json, strings, "name", dice);
  }
  while (json.size() % 4 != 0) json += ' ';
  bytes.replace(kHeader, length, json);
  length = static_cast<std::uint32_t>(json.size());
  std::memcpy(bytes.data() + 12, &length, 4);
  length = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(bytes.data() + 8, &length, 4);
  return what;
}

}  // namespace facetless
