// The model file: a versioned FlatBuffers buffer (schema: model.fbs), the only thing besides the mesh that an
// importer process hands to the renderer.
//
//  1. ReadModel maps the file, runs the FlatBuffers verifier, copies, and runs Validate: whatever bytes it is
//     given, it returns a valid Model or an Error, and never reads outside the file.
//  2. WriteModel refuses a model that is not valid. It writes `path` in full or not at all.
#pragma once

#include <string>

#include "render/model/model.h"

namespace facetless {

// Errors: kFileUnreadable; kFormatUnknown (not a model file, or of another version); kFormatBroken,
// kNotFinite.
Result<Model> ReadModel(const std::string& path);

// Errors: those of Validate; kWriteFailed.
Result<void> WriteModel(const Model& model, const std::string& path);

}  // namespace facetless
