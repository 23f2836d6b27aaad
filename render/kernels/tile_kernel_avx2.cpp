// The tile kernel for AVX2 with FMA, with four lanes. The build compiles only this file with the flags of the
// target.

#include "render/kernels/tile_kernel.inl.h"
