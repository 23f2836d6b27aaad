// Finds the functions of a source file of ours, C++ or JavaScript, from its braces alone.
//
//     for (const FunctionExtent& function : FindFunctions(text, SourceLanguage::kCpp).functions) ...
//
//  1. A function has parameters and a body in braces, and is in a file, a namespace or a class: a function, a
//     member, a test, or a lambda that initialises a global variable. Functions inside of it are parts of it.
//  2. A list in braces (a table) outside of functions is no function.
//  3. Comments, texts and directives are not code. Each branch of an #if is read as if it followed the code
//     before the #if.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace facetless {

enum class SourceLanguage { kCpp, kJavaScript };

struct FunctionExtent {
  std::string head;  // everything before the body, on one line
  int first_line = 0, last_line = 0;

  int lines() const { return last_line - first_line + 1; }
};

struct FunctionList {
  std::vector<FunctionExtent> functions;
  bool balanced = true;  // false: the braces could not be paired, and the list is unreliable
};

FunctionList FindFunctions(std::string_view source, SourceLanguage language);

}  // namespace facetless
