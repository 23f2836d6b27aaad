// Blends that OpenCASCADE makes: fillets, chamfers, sweeps, lofts and offsets of random solids, whose faces
// have degrees that no hand-made sample has. They are rendered, audited and judged.
//
//  1. A blend depends only on its seed. Each dimension is drawn independently over its whole range.
//  2. A shape that OpenCASCADE cannot make, or that it calls invalid, is no blend. The kinds of failure are
//     counted.
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

// Returns nothing if OpenCASCADE fails, or makes a shape that its own checker rejects.
std::optional<Blend> MakeBlend(std::uint64_t seed);

// Errors: those of the importer's conversion.
Result<Model> ModelOfBlend(const Blend& blend);

// The findings about one blend.
struct BlendReport {
  std::uint32_t faces = 0;
  int highest_degree = 0;                           // of all faces, in either direction
  std::uint64_t rays = 0, odd = 0, mismatched = 0;  // audited rays, forwards and backwards
  std::uint64_t certified = 0, contradicted = 0;    // samples; those that the independent check contradicts
  std::uint64_t limited = 0;                        // samples in doubt because a patch was given up
  std::uint64_t judged = 0, wrong = 0;              // certified samples that the oracle judged
  bool closed = false;  // the blend is a closed solid, so its crossings are counted
};

// Renders two views, which the seed determines, in certified precision with an audit, and lets the oracle
// judge samples. Errors: those of the renderer.
Result<BlendReport> JudgeBlend(const Model& model, std::uint64_t seed, int size);

}  // namespace facetless
