// Decodes the texts of a STEP file. All texts go through this one decoder, whatever program wrote the file.
//
//  1. A text is UTF-8 if all of its bytes are valid UTF-8. Otherwise it is in the code page that the
//     double-byte characters of the file's other texts indicate (Shift-JIS or GBK), or else in ISO 8859-1.
//     Then the control directives of ISO 10303-21 are decoded: \X2\, \X4\, \X\, \S\ after \PA\ … \PI\, and
//     \\.
//  2. No letter is dropped. A broken directive stays as it is written; a control character or an invalid
//     character becomes U+FFFD. Line ends within a text are not part of it.
//  3. Every guess, every replacement and every broken directive is reported in a sentence.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace facetless {

// Rewrites the texts of the file in ASCII, with \X2\ and \X4\ directives, wherever another reader could
// misinterpret them. OpenCASCADE and this importer both read the result, so that names of faces and of
// occurrences agree. Returns whether anything changed. Sentences about guesses are appended to `warnings`.
bool NormaliseStepTexts(std::string& bytes, std::vector<std::string>* warnings);

// Converts the inside of a STEP text to UTF-8 by the laws above, without a code page: bytes that are not
// UTF-8 are ISO 8859-1. Surrounding blanks are removed. A name that means "no name" ("NONE", "$") becomes
// empty.
std::string DecodeStepText(std::string_view raw);

}  // namespace facetless
