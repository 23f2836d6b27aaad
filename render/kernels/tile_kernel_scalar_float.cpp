// The tile kernel in single precision, one lane of plain C++.
#define FACETLESS_SCALAR_KERNEL 1
#define FACETLESS_FLOAT_KERNEL 1
#include "render/kernels/tile_kernel.inl.h"
