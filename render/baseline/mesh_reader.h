// What the readers of single mesh formats share. Private to baseline/.
//
//  1. A reader gets the whole file as bytes and trusts none of them: every index, offset, count and number
//     is checked before use.
//  2. FileToModel turns the file's axes and unit into millimetres, Z up. Its entries are 0, ±unit_mm: no
//     rounding of its own.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/baseline/mesh_file.h"
#include "render/model/mesh.h"

namespace facetless {

// What a vertex and a triangle of a MeshPart take.
inline constexpr std::uint64_t kVertexBytes = 24, kTriangleBytes = 16;

using Bytes = std::span<const unsigned char>;

struct FileAxes {
  double unit_mm = 1;
  bool y_up = false;
};
// (x, y, z) ↦ unit_mm · (x, y, z), or unit_mm · (x, −z, y) where Y is up.
Placement FileToModel(FileAxes axes);

// a ∘ b: first b, then a.
Placement Compose(const Placement& a, const Placement& b);

bool LooksLikeGlb(Bytes bytes);
bool LooksLikeStl(Bytes bytes);

// `name` is for messages. Errors as LoadMesh, without kFileUnreadable and kUnitMismatch.
Result<Mesh> ReadGlb(Bytes bytes, const std::string& name, FileAxes axes, const MeshLoadOptions& options);
Result<Mesh> ReadStl(Bytes bytes, const std::string& name, FileAxes axes, const MeshLoadOptions& options);

}  // namespace facetless
