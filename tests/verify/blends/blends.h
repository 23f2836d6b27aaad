// Blends as OpenCASCADE makes them: fillets, chamfers, sweeps, lofts and offsets of random solids, whose
// faces have degrees that no hand-made sample has; rendered, audited and judged.
//
//  1. A blend depends on its seed alone. Each dimension is drawn on its own over its whole range.
//  2. What OpenCASCADE cannot make, or calls invalid itself, is no blend: kinds of failure are counted, not
//     hidden.
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstdint>
#include <optional>
#include <string>

#include "render/model/model.h"

namespace facetless {

struct Blend {
  std::string what;  // "fillet of a box, 3 edges, rational, radius 2.1"
  TopoDS_Shape shape;
};

// None where OpenCASCADE fails, or makes what its own checker refuses.
std::optional<Blend> MakeBlend(std::uint64_t seed);

// Errors: those of the importer's conversion.
Result<Model> ModelOfBlend(const Blend& blend);

// What was found out about one blend.
struct BlendReport {
  std::uint32_t faces = 0;
  int highest_degree = 0;                           // of either direction of any face
  std::uint64_t rays = 0, odd = 0, mismatched = 0;  // audited, there and back
  std::uint64_t certified = 0, contradicted = 0;    // samples; those that the independent check refuses
  std::uint64_t limited = 0;                        // samples in doubt because a patch was given up
  std::uint64_t judged = 0, wrong = 0;              // certified samples before the oracle
  bool closed = false;                              // a closed solid: rays are counted
};

// Renders two views that the seed says, in certified precision with an audit, and lets the oracle judge
// samples. Errors: those of the renderer.
Result<BlendReport> JudgeBlend(const Model& model, std::uint64_t seed, int size);

}  // namespace facetless
