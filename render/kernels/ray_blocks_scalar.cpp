// The visit of ray blocks in plain C++. It is the oracle for the other build, and is used on machines without AVX2.
#define FACETLESS_SCALAR_KERNEL 1
#include "render/kernels/ray_blocks.inl.h"
