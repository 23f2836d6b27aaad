// Functions shared by the readers of the mesh formats. Private to render/baseline.
//
//  1. A reader gets the whole file as bytes and trusts none of them: it checks every index, offset, count and
//     number before it uses it.
//  2. FileToModel converts the axes and the unit of the file to millimetres with Z up. Its entries are 0 and
//     ±unit_mm, so it does not round.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "render/base/result.h"
#include "render/base/vec.h"
#include "render/baseline/mesh_file.h"
#include "render/model/mesh.h"

namespace facetless {

// The memory of a vertex and of a triangle of a MeshPart.
inline constexpr std::uint64_t kVertexBytes = 24, kTriangleBytes = 16;

using Bytes = std::span<const unsigned char>;

struct FileAxes {
  double unit_mm = 1;
  bool y_up = false;
};
// The map (x, y, z) ↦ unit_mm · (x, y, z), or unit_mm · (x, −z, y) if Y is up.
Placement FileToModel(FileAxes axes);

// The composition a ∘ b, which applies b first and then a.
Placement Compose(const Placement& a, const Placement& b);

bool LooksLikeGlb(Bytes bytes);
bool LooksLikeStl(Bytes bytes);

// The readers. `name` is used in messages. Errors: those of LoadMesh, except kFileUnreadable and
// kUnitMismatch.
Result<Mesh> ReadGlb(Bytes bytes, const std::string& name, FileAxes axes, const MeshLoadOptions& options);
Result<Mesh> ReadStl(Bytes bytes, const std::string& name, FileAxes axes, const MeshLoadOptions& options);

}  // namespace facetless
