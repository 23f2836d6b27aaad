// The tile kernel in single precision for AVX2 with FMA: eight lanes.
#define FACETLESS_FLOAT_KERNEL 1
#include "render/kernels/tile_kernel.inl.h"
