// The tile kernel in double, one lane of plain C++: the oracle, and the choice of machines without fused
// vector operations.
#define FACETLESS_SCALAR_KERNEL 1
#include "render/kernels/tile_kernel.inl.h"
