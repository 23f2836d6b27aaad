// Dispatch: the only place that selects the instruction set of the kernels.
//
//     const Result<Kernels>& kernels = ActiveKernels();
//     if (!kernels) return kernels.error();
//     kernels.value().trace_tile(job);
//
//  1. The widest instruction set of the processor is selected, unless FACETLESS_ISA=scalar|avx2|avx512 forces
//     one. The selection is made once per process.
//  2. It is an error to force a set that the processor lacks or a word that is unknown. The message lists the
//     valid words.
#pragma once

#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/kernels/ray_blocks.h"
#include "render/kernels/tile_kernel.h"
#include "render/nurbs/net_operations.h"

namespace facetless {

struct Kernels {
  std::string isa;
  TileKernel trace_tile = nullptr;        // the kernel in double precision
  TileKernel trace_tile_float = nullptr;  // the kernel in single precision, for leaves with coefficients32
  const NetOperations* nets = nullptr;
  VisitBlocks visit_blocks = nullptr;
};

// The kernels of the selected instruction set. Errors: kBadUsage (law 2).
const Result<Kernels>& ActiveKernels();

// The kernels of all instruction sets that this processor supports, narrowest first. The list is never empty.
std::vector<Kernels> AvailableKernels();

}  // namespace facetless
