// The model file: a versioned FlatBuffers buffer (schema: model.fbs). The importer process passes this file
// and the mesh to the renderer, and nothing else.
//
//  1. ReadModel maps the file, runs the FlatBuffers verifier, copies the content and runs Validate. For any
//     bytes it returns a valid Model or an Error, and it never reads outside the file.
//  2. WriteModel refuses an invalid model. It writes `path` completely or not at all.
#pragma once

#include <string>

#include "render/model/model.h"

namespace facetless {

// Errors: kFileUnreadable; kFormatUnknown (not a model file, or a file of another version); kFormatBroken;
// kNotFinite.
Result<Model> ReadModel(const std::string& path);

// Errors: the errors of Validate; kWriteFailed.
Result<void> WriteModel(const Model& model, const std::string& path);

}  // namespace facetless
