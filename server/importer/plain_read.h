// OpenCASCADE's own reader, which the bench compares the importer with.
//
//  1. The program facetless-plain-read beside the running binary reads the file, as a process under the restrictions
//     and the limits of the importer. Nothing of what it reads is kept.
#pragma once

#include "server/importer/import_process.h"

namespace facetless {

// Whether shapes are healed after they are read: as OpenCASCADE does by default, or not at all.
enum class PlainHealing : std::uint8_t { kDefault, kNone };

// Reads the file of `request` once. Errors: kFileUnreadable; kInternal (the program is absent); kCancelled;
// kNothingUsable (the reader has ended without a shape, at a limit or by a signal).
Result<void> ReadPlainly(const ImportRequest& request, PlainHealing healing);

}  // namespace facetless
