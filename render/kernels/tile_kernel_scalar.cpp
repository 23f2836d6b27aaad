// The tile kernel in double precision with one lane, in plain C++. It is the oracle for the others, and is
// used on machines without fused vector operations.
#define FACETLESS_SCALAR_KERNEL 1
#include "render/kernels/tile_kernel.inl.h"
