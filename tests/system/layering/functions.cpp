#include "tests/system/layering/functions.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <utility>

namespace facetless {
namespace {

bool IsWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

bool IsSpace(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

// Copies a source without its comments and with empty texts. Line ends and directives stay.
class CommentStripper {
 public:
  CommentStripper(std::string_view source, SourceLanguage language) : source_(source), language_(language) {}

  std::string Strip() {
    while (at_ < source_.size()) {
      if (StartsWith("//")) {
        SkipTo(source_.find('\n', at_));
      } else if (StartsWith("/*")) {
        SkipPast("*/", at_ + 2);
      } else if (language_ == SourceLanguage::kCpp && StartsWith("R\"")) {
        const std::size_t parenthesis = source_.find('(', at_);
        SkipPast(")" + std::string(source_.substr(at_ + 2, parenthesis - at_ - 2)) + "\"", parenthesis);
      } else if (StartsText()) {
        SkipText();
      } else {
        out_ += source_[at_++];
      }
    }
    return std::move(out_);
  }

 private:
  bool StartsWith(std::string_view text) const { return source_.substr(at_, text.size()) == text; }

  bool StartsText() const {
    const char c = source_[at_];
    if (c == '"') return true;
    if (language_ == SourceLanguage::kJavaScript) return c == '\'' || c == '`';
    return c == '\'' && !IsInNumber();
  }

  // Returns whether the quote at this place separates the digits of a number.
  bool IsInNumber() const {
    std::size_t first = at_;
    while (first > 0 && (IsWord(source_[first - 1]) || source_[first - 1] == '\'')) --first;
    return first < at_ && std::isdigit(static_cast<unsigned char>(source_[first])) != 0;
  }

  void SkipText() {
    const char quote = source_[at_];
    std::size_t end = at_ + 1;
    while (end < source_.size() && source_[end] != quote) end += source_[end] == '\\' ? 2 : 1;
    out_ += "\"\"";
    SkipTo(end + 1);
  }

  void SkipPast(std::string_view end, std::size_t from) {
    const std::size_t found = source_.find(end, from);
    SkipTo(found == std::string_view::npos ? found : found + end.size());
  }

  void SkipTo(std::size_t end) {
    end = std::min(end, source_.size());
    for (; at_ < end; ++at_)
      if (source_[at_] == '\n') out_ += '\n';
  }

  std::string_view source_;
  SourceLanguage language_;
  std::size_t at_ = 0;
  std::string out_;
};

class FunctionFinder {
 public:
  FunctionList Find(std::string_view stripped) {
    int line = 1;
    std::size_t at = 0;
    while (at < stripped.size()) {
      const std::size_t end = std::min(stripped.find('\n', at), stripped.size());
      const std::string_view text = stripped.substr(at, end - at);
      const std::size_t first = text.find_first_not_of(" \t");
      if (continued_ || (first != std::string_view::npos && text[first] == '#')) {
        if (!continued_) ReadDirective(text.substr(first));
        continued_ = text.ends_with('\\');
      } else {
        for (const char c : text) Read(c, line);
        Read('\n', line);
      }
      ++line;
      at = end + 1;
    }
    if (!state_.open.empty()) list_.balanced = false;
    return std::move(list_);
  }

 private:
  enum class Kind {
    kScope,       // a namespace or a class, which may contain functions
    kFunction,    // the body of a function
    kMemberInit,  // a member that a constructor initialises with braces
    kOther        // anything inside of these, or a table
  };
  struct Opened {
    Kind kind;
    std::string head;
    int first_line;
  };
  struct State {
    std::vector<Opened> open;
    std::string head;  // the part of a declaration that has been read
    int head_line = 0;
    int parentheses = 0;
  };

  void ReadDirective(std::string_view text) {
    static const std::regex kIf(R"(#\s*if.*)"), kElse(R"(#\s*(else|elif).*)"), kEndIf(R"(#\s*endif.*)");
    const std::string directive(text);
    if (std::regex_match(directive, kIf)) {
      at_if_.push_back(state_);
    } else if (at_if_.empty()) {
      return;
    } else if (std::regex_match(directive, kElse)) {
      state_ = at_if_.back();
    } else if (std::regex_match(directive, kEndIf)) {
      at_if_.pop_back();
    }
  }

  void Read(char c, int line) {
    if (c == '{') {
      Open(line);
    } else if (c == '}') {
      Close(line);
    } else if (InScope()) {
      ReadHead(c, line);
    }
  }

  bool InScope() const { return state_.open.empty() || state_.open.back().kind == Kind::kScope; }

  void Open(int line) {
    // Between parentheses, a function can only be an argument.
    const bool may_be_function = InScope() && (state_.parentheses == 0 || EndsLikeLambda(state_.head));
    const Kind kind = may_be_function ? KindOf(state_.head) : Kind::kOther;
    state_.open.push_back({kind, state_.head, state_.head.empty() ? line : state_.head_line});
    if (kind == Kind::kScope) state_.head.clear();
  }

  void Close(int line) {
    if (state_.open.empty()) {
      list_.balanced = false;
      return;
    }
    const Opened closed = std::move(state_.open.back());
    state_.open.pop_back();
    if (closed.kind == Kind::kFunction) list_.functions.push_back({closed.head, closed.first_line, line});
    if (closed.kind != Kind::kMemberInit && InScope() && state_.parentheses == 0) state_.head.clear();
  }

  void ReadHead(char c, int line) {
    if (c == '(') ++state_.parentheses;
    if (c == ')') --state_.parentheses;
    static const std::regex kAccess(R"((public|private|protected)\s*:)");
    if ((c == ';' && state_.parentheses == 0) || (c == ':' && std::regex_match(state_.head + c, kAccess))) {
      state_.head.clear();
      return;
    }
    if (IsSpace(c)) {
      if (!state_.head.empty() && state_.head.back() != ' ') state_.head += ' ';
      return;
    }
    if (state_.head.empty()) state_.head_line = line;
    state_.head += c;
  }

  // Returns what the braces after `head` contain.
  static Kind KindOf(const std::string& head) {
    static const std::regex kNamespace(R"(((inline )?namespace\b|extern "").*)");
    static const std::regex kClass(
        R"((template ?<.*> ?)?((static|constexpr|inline|const|export|default) )*(class|struct|union|enum)\b.*)");
    static const std::regex kReturnsClass(R"(.*\) ?(const)? ?)");
    static const std::regex kMember(R"(.*\) ?(noexcept ?)?:[^:].*[\w>] ?)");
    static const std::regex kQualifier(R"(.*\b(const|override|final|noexcept|try) ?)");
    if (std::regex_match(head, kNamespace)) return Kind::kScope;
    if (std::regex_match(head, kClass) && !std::regex_match(head, kReturnsClass)) return Kind::kScope;
    if (std::regex_match(head, kMember) && !std::regex_match(head, kQualifier)) return Kind::kMemberInit;
    if (EndsLikeLambda(head)) return Kind::kFunction;
    static const std::regex kInitialised(R"(.*= ?)");
    return head.find('(') != std::string::npos && !std::regex_match(head, kInitialised) ? Kind::kFunction
                                                                                        : Kind::kOther;
  }

  // Returns whether braces after `head` are the body of a function without a name: [] { … } or … => { … }.
  static bool EndsLikeLambda(const std::string& head) {
    static const std::regex kLambda(R"(.*(\]|=>) ?)");
    return std::regex_match(head, kLambda);
  }

  State state_;
  std::vector<State> at_if_;  // the state at each #if that is open
  bool continued_ = false;    // the directive continues in the next line
  FunctionList list_;
};

}  // namespace

FunctionList FindFunctions(std::string_view source, SourceLanguage language) {
  return FunctionFinder().Find(CommentStripper(source, language).Strip());
}

}  // namespace facetless
