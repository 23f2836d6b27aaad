// The one place that chooses the instruction set.
//
//  1. The widest set that the processor has, unless FACETLESS_ISA=scalar|avx2|avx512 forces one. Asked once
//     per process.
//  2. Forcing a set that the processor lacks, or an unknown word, is an error that names the valid words.
#pragma once

#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/kernels/tile_kernel.h"
#include "render/nurbs/net_operations.h"

namespace facetless {

struct Kernels {
  std::string isa;
  TileKernel trace_tile = nullptr;        // in double
  TileKernel trace_tile_float = nullptr;  // in single precision, for leaves with coefficients32
  const NetOperations* nets = nullptr;
};

// Errors: kBadUsage.
const Result<Kernels>& ActiveKernels();

// All that this processor can run, narrowest first; never empty.
std::vector<Kernels> AvailableKernels();

}  // namespace facetless
