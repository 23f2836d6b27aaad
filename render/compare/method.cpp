#include "render/compare/method.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "render/compare/exact_methods.h"
#include "render/compare/solved_surfaces.h"
#include "render/compare/voxel_method.h"

namespace facetless {
namespace {

std::vector<Method> BuiltIn() {
  return {ExactMethod(), FastMethod(), VoxelMethod()};
}

bool IsName(const std::string& name) {
  constexpr const char* kTaken[] = {"direct", "baseline", "difference", "legend", "depth", "lines"};
  if (name.empty() || std::find(std::begin(kTaken), std::end(kTaken), name) != std::end(kTaken)) return false;
  return std::all_of(name.begin(), name.end(),
                     [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
}

// Pointers to the elements stay valid: methods are never removed, and each is allocated on the heap.
std::vector<std::unique_ptr<const Method>>& Registry() {
  static std::vector<std::unique_ptr<const Method>> methods = [] {
    std::vector<std::unique_ptr<const Method>> built_in;
    for (Method& method : BuiltIn()) built_in.push_back(std::make_unique<const Method>(std::move(method)));
    return built_in;
  }();
  return methods;
}

// The methods of law 4. The first call must come after the start of the program, when all solvers are registered.
const std::vector<std::unique_ptr<const Method>>& SolverMethods() {
  static const std::vector<std::unique_ptr<const Method>> methods = [] {
    std::vector<std::unique_ptr<const Method>> of_solvers;
    for (const SolverInfo* info : Solvers())
      of_solvers.push_back(std::make_unique<const Method>(MethodOfSolver(*info)));
    return of_solvers;
  }();
  return methods;
}

const Method* FindMethod(std::string_view name) {
  for (const Method* method : Methods())
    if (method->name == name) return method;
  return nullptr;
}

// Returns the shortest decimal text that reads back as the same number.
std::string NumberText(double number) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, number);
  return {text, end.ptr};
}

}  // namespace

std::string MethodChoice::Name() const {
  if (method->setting.empty()) return method->name;
  std::string name = method->name + "-" + NumberText(setting);
  // Points and plus signs are replaced, because they are not wanted in the names of files and roles.
  std::replace(name.begin(), name.end(), '.', '_');
  std::erase(name, '+');
  return name;
}

std::string MethodChoice::Title() const {
  return method->setting.empty() ? method->title : method->title + " " + NumberText(setting);
}

std::vector<const Method*> Methods() {
  std::vector<const Method*> methods;
  for (const auto& method : Registry()) methods.push_back(method.get());
  for (const auto& method : SolverMethods()) methods.push_back(method.get());
  std::sort(methods.begin(), methods.end(),
            [](const Method* a, const Method* b) { return a->name < b->name; });
  return methods;
}

std::string MethodNames() {
  std::string names;
  for (const Method* method : Methods())
    names += (names.empty() ? "" : ", ") + method->name + (method->setting.empty() ? "" : ":NUMBER");
  return names;
}

const Method& CertifiedMethod() {
  static const Method& method = *FindMethod("certified");
  return method;
}

Result<MethodChoice> ParseMethod(const std::string& text, const std::string& option) {
  const std::size_t colon = text.find(':');
  MethodChoice choice{FindMethod(std::string_view(text).substr(0, colon))};
  if (choice.method == nullptr) {
    return Error{ErrorCode::kBadUsage, option + ": there is no method '" + text.substr(0, colon) +
                                           "'; there are: " + MethodNames()};
  }
  const Method& method = *choice.method;
  if (!method.usual.empty()) choice.setting = method.usual.front();
  if (colon == std::string::npos) return choice;
  if (method.setting.empty())
    return Error{ErrorCode::kBadUsage, option + ": the method '" + method.name +
                                           "' takes no number; write '" + method.name + "' instead of '" +
                                           text + "'"};
  const char* begin = text.c_str() + colon + 1;
  char* end = nullptr;
  choice.setting = std::strtod(begin, &end);
  choice.given = true;
  if (end == begin || *end != 0 || !std::isfinite(choice.setting))
    return Error{ErrorCode::kBadUsage, option + ": '" + text + "' names no number of " + method.setting +
                                           "; write for example '" + method.name + ":" +
                                           NumberText(method.usual.front()) + "'"};
  return choice;
}

std::string FormatMethod(const MethodChoice& choice) {
  return choice.method->setting.empty() ? choice.method->name
                                        : choice.method->name + ":" + NumberText(choice.setting);
}

Result<std::unique_ptr<const Representation>> MakeRepresentation(const MethodChoice& choice,
                                                                 MethodInput input) {
  input.name = choice.Name();
  input.title = choice.Title();
  return choice.method->make(input, choice.setting);
}

RegisterMethod::RegisterMethod(Method method) {
  const bool taken = FindSolver(method.name) != nullptr ||
                     std::any_of(Registry().begin(), Registry().end(),
                                 [&](const auto& other) { return other->name == method.name; });
  const bool sound = IsName(method.name) && !taken && method.make != nullptr &&
                     method.setting.empty() == method.usual.empty();
  if (!sound)
    throw std::invalid_argument("the method '" + method.name +
                                "' cannot be registered: its name is taken or malformed, it lacks a "
                                "function, or it has a setting without usual values");
  Registry().push_back(std::make_unique<const Method>(std::move(method)));
}

}  // namespace facetless
