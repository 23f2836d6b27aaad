// The tile kernel for AVX-512, with eight lanes. The build compiles only this file with the flags of the
// target.

#include "render/kernels/tile_kernel.inl.h"
