// Texts of a STEP file: one decoder for all of them, whatever tool wrote the file.
//
//  1. A text is UTF-8 if all of its bytes are; else it is in the code page that the file's other texts show
//     (Shift-JIS or GBK, which double-byte characters give away), else in ISO 8859-1. Then the control
//     directives of ISO 10303-21 are decoded: \X2\, \X4\, \X\, \S\ after \PA\ … \PI\, and \\.
//  2. No letter is dropped. A directive that is broken stays as it is written; a control character, and what
//     is no character, becomes U+FFFD. Line ends within a text are none of its characters.
//  3. Every guess, every replacement and every broken directive is reported in a sentence.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace facetless {

// Writes the texts of the file anew, in ASCII with \X2\ and \X4\ directives, wherever another reader could
// take them for something else. OpenCASCADE reads the result, and so do we: names of faces and of occurrences
// come out alike. True if anything changed; sentences about what was guessed are appended to `warnings`.
bool NormaliseStepTexts(std::string& bytes, std::vector<std::string>* warnings);

// The UTF-8 of a STEP text's inside by the laws above, without a code page: bytes that are no UTF-8 are ISO
// 8859-1. Surrounding blanks are removed; a name that says that there is none ("NONE", "$") is empty.
std::string DecodeStepText(std::string_view raw);

}  // namespace facetless
