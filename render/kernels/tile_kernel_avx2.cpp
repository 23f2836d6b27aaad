// The tile kernel for AVX2 with FMA: four lanes. The build gives this file, and no other, the target's flags.

#include "render/kernels/tile_kernel.inl.h"
