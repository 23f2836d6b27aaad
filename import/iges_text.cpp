#include "import/iges_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>

namespace facetless {
namespace {

constexpr std::size_t kColumns = 80;
constexpr std::size_t kParameterColumns = 64;

struct Lines {
  std::vector<std::string> start, global, directory, parameter;
};

// Returns the number in columns [first, first + 8) of a directory line.
int Field(const std::string& line, std::size_t first) {
  int value = 0;
  std::size_t begin = first;
  while (begin < first + 8 && line[begin] == ' ') ++begin;
  std::from_chars(line.data() + begin, line.data() + first + 8, value);
  return value;
}

// Sorts the lines by section. A line that is not 80 columns wide still has its section letter eight columns
// before its end. Returns false if a line has no section letter; `lines` then contains the lines before it.
bool Split(std::string_view bytes, Lines& lines) {
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string line(bytes.substr(at, end - at));
    at = end + 1;
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    if (line.empty()) continue;
    if (line.size() < 8) return false;
    const std::size_t letter = line.size() > kColumns ? line.size() - 8 : 72;
    if (line.size() <= letter) return false;
    switch (line[letter]) {
      case 'S':
        lines.start.push_back(line);
        break;
      case 'G':
        lines.global.push_back(line);
        break;
      case 'D':
        if (line.size() != kColumns) return false;
        lines.directory.push_back(line);
        break;
      case 'P':
        lines.parameter.push_back(line);
        break;
      case 'T':
        return true;
      default:
        return false;
    }
  }
  return true;
}

// The delimiters of parameters and of records, as the first two fields of the global section define them.
struct Delimiters {
  char parameter = ',', record = ';';
};
Delimiters DelimitersOf(const Lines& lines) {
  Delimiters result;
  if (lines.global.empty()) return result;
  const std::string& text = lines.global.front();
  std::size_t at = 0;
  if (text.starts_with("1H")) {
    result.parameter = text[2];
    at = 4;
  } else if (!text.empty() && text[0] == ',') {
    at = 1;
  }
  if (text.compare(at, 2, "1H") == 0) result.record = text[at + 2];
  return result;
}

// The text of each entity's parameters, by directory number.
struct ParameterTexts {
  std::map<int, std::string> of;
  std::uint64_t wide_lines = 0;  // lines with data beyond column 64
};

ParameterTexts CollectParameters(const Lines& lines) {
  ParameterTexts texts;
  for (const std::string& line : lines.parameter) {
    // The number of the owning entity ends before the section letter. Data end at column 64, or continue into
    // the space before that number.
    const std::size_t letter = line.size() > kColumns ? line.size() - 8 : 72;
    std::size_t number = letter;
    while (number > letter - 8 && std::isdigit(static_cast<unsigned char>(line[number - 1]))) --number;
    int owner = 0;
    std::from_chars(line.data() + number, line.data() + letter, owner);
    std::size_t end = number;
    while (end > letter - 8 && line[end - 1] == ' ') --end;
    if (end > kParameterColumns) ++texts.wide_lines;
    texts.of[owner] += line.substr(0, end);
  }
  return texts;
}

// Splits the text at delimiters outside Hollerith strings (nH…), up to the end of the record. *ended says
// whether the record has an end.
std::vector<std::string> Tokens(const std::string& text, const Delimiters& delimiters,
                                bool* ended = nullptr) {
  if (ended) *ended = false;
  std::vector<std::string> tokens{""};
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == delimiters.parameter) {
      tokens.emplace_back();
    } else if (c == delimiters.record) {
      if (ended) *ended = true;
      break;
    } else if (c == 'H' && !tokens.back().empty() &&
               std::all_of(tokens.back().begin(), tokens.back().end(),
                           [](unsigned char d) { return std::isdigit(d); })) {
      std::size_t length = 0;
      std::from_chars(tokens.back().data(), tokens.back().data() + tokens.back().size(), length);
      tokens.back() += text.substr(i, 1 + std::min(length, text.size() - i));
      i += std::min(length, text.size() - i);
    } else if (c != ' ') {
      tokens.back() += c;
    }
  }
  return tokens;
}

// Returns the index of the first real parameter of an entity (index 0 is its type); all parameters from there
// on are reals. Returns 0 if the entity has none, or if integers are mixed with the reals.
std::size_t FirstReal(int type) {
  switch (type) {
    case 100:
    case 104:
    case 110:
    case 123:
    case 124:
      return 1;  // arc, conic, line, direction, matrix
    case 106:
      return 3;  // copious data
    case 112:
      return 5;  // parametric spline curve
    case 114:
      return 5;  // parametric spline surface
    case 122:
      return 2;  // tabulated cylinder
    case 126:
      return 7;  // rational B-spline curve
    case 128:
      return 10;  // rational B-spline surface
    default:
      return 0;
  }
}

// Returns the range [first, last) of parameters that are reals.
std::pair<std::size_t, std::size_t> Reals(int type, const std::vector<std::string>& tokens) {
  const std::size_t first = FirstReal(type);
  if (first == 0) return {0, 0};
  std::size_t last = tokens.size();
  if (type == 126 || type == 128) {
    // Properties and pointers may follow the numbers, so count the numbers.
    const auto value = [&](std::size_t i) {
      long long number = 0;
      if (i < tokens.size()) std::from_chars(tokens[i].data(), tokens[i].data() + tokens[i].size(), number);
      // The products of two values must not overflow.
      return std::clamp(number, -1LL, 1'000'000'000LL);
    };
    if (type == 126) {
      const long long k = value(1), m = value(2);
      last = std::min<std::size_t>(
          last, first + static_cast<std::size_t>(std::max(0LL, (k + m + 2) + 4 * (k + 1) + 5)));
    } else {
      const long long k1 = value(1), k2 = value(2), m1 = value(3), m2 = value(4);
      const long long points = (k1 + 1) * (k2 + 1);
      last = std::min<std::size_t>(last, first + static_cast<std::size_t>(std::max(
                                                     0LL, (k1 + m1 + 2) + (k2 + m2 + 2) + 4 * points + 4)));
    }
  } else if (type == 100 || type == 110 || type == 123 || type == 104 || type == 124 || type == 122) {
    constexpr std::array<std::pair<int, std::size_t>, 6> kCounts{
        {{100, 7}, {104, 11}, {110, 6}, {122, 3}, {123, 3}, {124, 12}}};
    for (const auto& [known, count] : kCounts) {
      if (known == type) last = std::min(last, first + count);
    }
  }
  return {first, last};
}

bool IsInteger(const std::string& token) {
  const std::size_t begin = !token.empty() && (token[0] == '-' || token[0] == '+') ? 1 : 0;
  return token.size() > begin && std::all_of(token.begin() + static_cast<std::ptrdiff_t>(begin), token.end(),
                                             [](unsigned char c) { return std::isdigit(c); });
}

// Returns the number at the beginning of a token; 0 if there is none, or if the text is NaN or infinity
// ("nano", "infix").
double NumberIn(const std::vector<std::string>& tokens, std::size_t i) {
  double number = 0;
  if (i < tokens.size()) std::from_chars(tokens[i].data(), tokens[i].data() + tokens[i].size(), number);
  return std::isfinite(number) ? number : 0;
}

// Describes the length that an entity claims: the number of values (numbers or pointers) per item, and the
// tokens whose product is the number of items.
struct Claim {
  int type;
  double values;
  std::size_t count, other;  // indices of tokens; other = 0: only `count`
};
constexpr std::array<Claim, 12> kClaims{{{102, 1, 1, 0},
                                         {106, 1, 2, 0},
                                         {112, 13, 4, 0},
                                         {114, 48, 3, 4},
                                         {141, 3, 4, 0},
                                         {143, 1, 3, 0},
                                         {502, 3, 1, 0},
                                         {504, 5, 1, 0},
                                         {508, 5, 1, 0},
                                         {510, 1, 2, 0},
                                         {514, 2, 1, 0},
                                         {402, 1, 1, 0}}};

// Returns whether an entity claims more values than its text can contain, since each value takes at least its
// delimiter.
bool ClaimsMoreThan(std::size_t available, int type, const std::vector<std::string>& tokens) {
  const double room = static_cast<double>(available);
  if (type == 126) return (NumberIn(tokens, 1) + 1) * 3 > room;
  if (type == 128) return std::fabs((NumberIn(tokens, 1) + 1) * (NumberIn(tokens, 2) + 1)) * 3 > room;
  for (const Claim& claim : kClaims) {
    if (claim.type != type) continue;
    const double items =
        NumberIn(tokens, claim.count) * (claim.other > 0 ? NumberIn(tokens, claim.other) : 1.0);
    // The last value's delimiter may be missing together with the record's end.
    if (items * claim.values > room + 2 || NumberIn(tokens, claim.count) < 0) return true;
  }
  return false;
}

// Finds the first token that writes NaN, an infinite number, or an exponent beyond kGreatestExponent; nullptr
// if there is none. Texts (nH…) are ignored.
constexpr int kGreatestExponent = 150;  // as in STEP files; the square of a larger number overflows
const std::string* NotFinite(const std::vector<std::string>& tokens) {
  for (const std::string& token : tokens) {
    if (token.size() > 64) continue;
    std::string upper;
    for (const char c : token) upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const std::size_t sign = upper.find_first_not_of("+-");
    const std::string word = sign == std::string::npos ? "" : upper.substr(sign);
    if (word == "NAN" || word == "INF" || word == "INFINITY") return &token;
    const std::size_t exponent = upper.find_first_of("ED");
    if (exponent == std::string::npos || upper.find_first_not_of("0123456789.+-ED") != std::string::npos)
      continue;
    int power = 0;
    const char* begin = upper.data() + exponent + 1;
    if (begin < upper.data() + upper.size() && *begin == '+') ++begin;
    const auto parsed = std::from_chars(begin, upper.data() + upper.size(), power);
    if ((parsed.ec == std::errc::result_out_of_range && *begin != '-') || power > kGreatestExponent)
      return &token;
  }
  return nullptr;
}

// Ranges of tokens [first, last) that refer to the entities of which an entity consists.
using TokenRange = std::pair<std::size_t, std::size_t>;
std::vector<TokenRange> MadeOf(int type, const std::vector<std::string>& tokens) {
  const auto counted = [&](std::size_t count, std::size_t first) {
    return TokenRange{first, first + static_cast<std::size_t>(std::clamp(NumberIn(tokens, count), 0.0, 1e7))};
  };
  switch (type) {
    case 102:
    case 180:
    case 184:
    case 402:
      return {counted(1, 2)};
    case 118:
    case 120:
      return {{1, 3}};
    case 122:
    case 130:
    case 186:
    case 408:
      return {{1, 2}};
    case 140:
      return {{5, 6}};
    case 142:
      return {{2, 5}};
    case 143:
      return {{2, 3}, counted(3, 4)};
    case 144:
      return {{1, 2}, {4, 5}, counted(3, 5)};
    case 308:
      return {counted(3, 4)};
    case 510:
      return {{1, 2}, counted(2, 4)};
    default:
      return {};
  }
}

// Returns the pointers of a directory entry: structure, line font, level, view, matrix and label display. In
// some of these fields a positive number is a value and a negative one a pointer.
std::vector<int> DirectoryPointers(const std::string& line) {
  std::vector<int> pointers;
  for (const std::size_t column : {16, 24, 32}) {
    if (const int value = Field(line, column); value < 0) pointers.push_back(-value);
  }
  for (const std::size_t column : {40, 48, 56}) {
    if (const int value = Field(line, column); value > 0) pointers.push_back(value);
  }
  return pointers;
}

// Returns the directory number of an entity that contains itself, directly or indirectly; 0 if there is none.
// OpenCASCADE would follow such a cycle until its stack overflows.
int MadeOfItself(const std::map<int, std::vector<int>>& made_of) {
  enum class State : std::uint8_t { kNew, kOpen, kDone };
  std::map<int, State> states;
  for (const auto& [start, unused] : made_of) {
    std::vector<std::pair<int, std::size_t>> path;
    if (states[start] == State::kNew) path.emplace_back(start, 0);
    while (!path.empty()) {
      auto& [at, next] = path.back();
      states[at] = State::kOpen;
      const auto parts = made_of.find(at);
      if (parts == made_of.end() || next == parts->second.size()) {
        states[at] = State::kDone;
        path.pop_back();
        continue;
      }
      const int part = parts->second[next++];
      if (states[part] == State::kOpen) return part;
      if (states[part] == State::kNew) path.emplace_back(part, 0);
    }
  }
  return 0;
}

std::string Padded(std::size_t number, std::size_t width) {
  std::string text = std::to_string(number);
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

// Lays tokens out in 64 columns. A token is broken only if it is longer than a line.
std::vector<std::string> Wrapped(const std::vector<std::string>& tokens, const Delimiters& delimiters) {
  std::vector<std::string> lines{""};
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string token = tokens[i] + (i + 1 == tokens.size() ? delimiters.record : delimiters.parameter);
    if (lines.back().size() + token.size() > kParameterColumns && !lines.back().empty()) lines.emplace_back();
    std::size_t at = 0;
    for (; token.size() - at > kParameterColumns; at += kParameterColumns) {
      lines.back() = token.substr(at, kParameterColumns);
      lines.emplace_back();
    }
    lines.back() += token.substr(at);
  }
  return lines;
}

}  // namespace

Result<IgesFacts> ScanIges(const std::string& name, std::string_view bytes) {
  Lines lines;
  const bool whole = Split(bytes, lines);
  if (lines.directory.empty() || lines.parameter.empty())
    return Error{ErrorCode::kFormatBroken,
                 name + " is an IGES file whose records are damaged or cut off; export the model again."};
  IgesFacts facts;
  facts.cut_off = !whole;
  const Delimiters delimiters = DelimitersOf(lines);
  const ParameterTexts texts = CollectParameters(lines);
  std::map<int, std::vector<int>> made_of;
  for (std::size_t i = 0; i + 1 < lines.directory.size(); i += 2) {
    IgesEntity entity;
    entity.type = Field(lines.directory[i], 0);
    entity.directory = static_cast<int>(i) + 1;
    entity.dependent =
        lines.directory[i][67] != '0' && std::isdigit(static_cast<unsigned char>(lines.directory[i][67]));
    facts.entities.push_back(entity);
    if (std::vector<int> pointers = DirectoryPointers(lines.directory[i]); !pointers.empty())
      made_of[entity.directory] = std::move(pointers);
    const auto text = texts.of.find(entity.directory);
    bool ended = false;
    std::vector<std::string> tokens;
    if (text != texts.of.end()) tokens = Tokens(text->second, delimiters, &ended);
    if (!ended && entity.type != 0) facts.without_data.push_back(entity);
    if (text == texts.of.end()) continue;
    const auto entity_name = [&] {
      return name + ": entity D" + std::to_string(entity.directory) + " (type " +
             std::to_string(entity.type) + ")";
    };
    if (ClaimsMoreThan(text->second.size(), entity.type, tokens))
      return Error{ErrorCode::kFormatBroken,
                   entity_name() + " claims more values than the file contains; export the model again."};
    if (const std::string* bad = NotFinite(tokens))
      return Error{ErrorCode::kNotFinite,
                   entity_name() + " holds \"" + *bad +
                       "\", which is no finite number or too large to compute with; export the model again."};
    for (const auto& [first, last] : MadeOf(entity.type, tokens)) {
      for (std::size_t t = first; t < std::min(last, tokens.size()); ++t)
        made_of[entity.directory].push_back(static_cast<int>(std::clamp(NumberIn(tokens, t), -1.0, 1e7)));
    }
  }
  if (const int cycle = MadeOfItself(made_of); cycle != 0)
    return Error{ErrorCode::kFormatBroken,
                 name + ": entity D" + std::to_string(cycle) + " contains itself; export the model again."};
  return facts;
}

IgesRepair RepairIges(std::string& bytes) {
  Lines lines;
  if (!Split(bytes, lines)) return {};
  const Delimiters delimiters = DelimitersOf(lines);
  const ParameterTexts texts = CollectParameters(lines);
  // Find integers where reals are required.
  IgesRepair repair{0, texts.wide_lines};
  std::vector<std::vector<std::string>> tokens_of(lines.directory.size());
  for (std::size_t i = 0; i + 1 < lines.directory.size(); i += 2) {
    const auto text = texts.of.find(static_cast<int>(i) + 1);
    if (text == texts.of.end()) continue;
    tokens_of[i] = Tokens(text->second, delimiters);
    const auto [first, last] = Reals(Field(lines.directory[i], 0), tokens_of[i]);
    for (std::size_t t = first; t < last; ++t) {
      if (!IsInteger(tokens_of[i][t])) continue;
      tokens_of[i][t] += '.';
      ++repair.reals;
    }
  }
  if (repair.reals == 0 && repair.wide_lines == 0) return repair;
  // Write all sections again. The parameters move to other lines, so the directory must change, too.
  std::vector<std::string> parameter;
  for (std::size_t i = 0; i + 1 < lines.directory.size(); i += 2) {
    const std::vector<std::string> wrapped = Wrapped(tokens_of[i], delimiters);
    lines.directory[i].replace(8, 8, Padded(parameter.size() + 1, 8));
    lines.directory[i + 1].replace(24, 8, Padded(wrapped.size(), 8));
    for (std::string line : wrapped) {
      line.resize(kParameterColumns, ' ');
      parameter.push_back(line + Padded(i + 1, 8) + 'P' + Padded(parameter.size() + 1, 7));
    }
  }
  // Parameters of entities that the directory does not list are dropped.
  if (parameter.empty()) return {};
  std::string out;
  for (const auto* section : {&lines.start, &lines.global, &lines.directory, &parameter}) {
    for (const std::string& line : *section) out += line + '\n';
  }
  std::string terminate = "S" + Padded(lines.start.size(), 7) + "G" + Padded(lines.global.size(), 7) + "D" +
                          Padded(lines.directory.size(), 7) + "P" + Padded(parameter.size(), 7);
  terminate.resize(72, ' ');
  out += terminate + "T      1\n";
  bytes = std::move(out);
  return repair;
}

}  // namespace facetless
