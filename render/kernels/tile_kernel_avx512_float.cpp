// The tile kernel in single precision for AVX-512: eight lanes, a packet.
#define FACETLESS_FLOAT_KERNEL 1
#include "render/kernels/tile_kernel.inl.h"
