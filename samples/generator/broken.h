// The broken samples, each made from sound text in one way that occurs in practice.
#pragma once

#include <filesystem>

namespace facetless::samples {

// Writes truncated.step, nan.step, wrong_type.step, empty.step and mesh.stl into `folder`/broken. `folder`
// holds cone.step and bracket.step. Throws std::runtime_error.
void WriteBroken(const std::filesystem::path& folder);

}  // namespace facetless::samples
